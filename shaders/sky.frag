// sky.frag - a clear sky that pales towards the horizon; below it the haze.
in vec3 v_ray;
layout(location = 0) out vec4 colour;

void main()
{
    vec3 d = v_ray * inversesqrt(dot(v_ray, v_ray));
    float up = max(d.z, 0.0), s = max(dot(d, sun.xyz), 0.0);
    vec3 c = mix(haze.rgb, zenith.rgb, up * (up + 1.2) / (up * up + 1.2 * up + 0.25));
    s *= s, s *= s, s *= s;
    c += vec3(0.32, 0.26, 0.18) * s * s * s;
    colour = vec4(sqrt(c * (1.0 + 0.25 * min(d.z, 0.0))), 1.0);
}
