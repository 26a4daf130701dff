// globe_sky.frag - the sky around a planet: air by the height at which a ray passes, space behind it.
in vec3 v_ray;
layout(location = 0) out vec4 colour;

void main()
{
    vec3 d = v_ray * inversesqrt(dot(v_ray, v_ray));
    // Lowest point of the ray: the eye, or where it passes the planet.
    vec3 up;
    float lowest = body_lowest(d, up), thickness = AIR_THICKNESS * body_radius();
    float depth = 3.5 * exp(-max(lowest, 0.0) / thickness) / (max(d.z, 0.0) + 0.035);
    float thick = 1.0 - exp(-0.035 * depth), rising = max(d.z, 0.0);
    vec3 inside = mix(haze.rgb, zenith.rgb, rising * (rising + 1.2) / (rising * rising + 1.2 * rising + 0.25));
    vec3 c = mix(2.2 * zenith.rgb, inside, thick) * (1.0 - exp(-depth));
    float s = max(dot(d, sun.xyz), 0.0), day = smoothstep(-0.22, 0.3, dot(up, sun.xyz));
    s *= s, s *= s, s *= s;
    c += thick * haze.rgb * vec3(0.57, 0.39, 0.23) * s * s * s;
    c *= day * AIR;
#ifdef STARS
    // Where the sky is black.
    c += stars_at(d) * exp(-dusk.w * depth * AIR) * (1.0 - smoothstep(0.002, 0.03, max(c.r, max(c.g, c.b))));
#endif
    c += vec3(0.00015, 0.00018, 0.00025);
    colour = encoded(sqrt(c) + step_noise());
}
