// encode.glsl - what a target holds of a colour as it is shown.
vec4 encoded(vec3 shown)
{
#ifdef LINEAR_LIGHT
    shown = mix(shown / 12.92, pow((shown + 0.055) / 1.055, vec3(2.4)), greaterThan(shown, vec3(0.04045)));
#endif
    return vec4(shown, 1.0);
}
