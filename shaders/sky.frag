// sky.frag - a clear sky that pales towards the horizon; below it the haze.
in vec3 v_ray;
layout(location = 0) out vec4 colour;

void main()
{
    vec3 d = v_ray * inversesqrt(dot(v_ray, v_ray));
    float up = max(d.z, 0.0), s = max(dot(d, sun.xyz), 0.0);
    vec3 c = mix(haze.rgb, zenith.rgb, up * (up + 1.2) / (up * up + 1.2 * up + 0.25));
    s *= s, s *= s, s *= s;
    c += haze.rgb * vec3(0.57, 0.39, 0.23) * s * s * s;
    c *= 1.0 + 0.25 * min(d.z, 0.0);
#ifdef STARS
    c += stars_at(d) * (dusk.z * mix(1.0, smoothstep(0.0, 0.25, d.z), AIR));
#endif
    colour = encoded(sqrt(c) + step_noise());
}
