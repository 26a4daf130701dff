// encode.glsl - what a target holds of a colour as it is shown.

// Noise of one step of colour, so that a gradient shows no bands (interleaved gradient noise, Jimenez 2014).
float step_noise()
{
    return (fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

vec4 encoded(vec3 shown)
{
#ifdef LINEAR_LIGHT
    shown = mix(shown / 12.92, pow((shown + 0.055) / 1.055, vec3(2.4)), greaterThan(shown, vec3(0.04045)));
#endif
    return vec4(shown, 1.0);
}
