// renderer.frag - colour of the terrain: ramp by height, light from normals, haze.
//
// The surface's part before it defines
//     float surface_height()              metres above z_base; called first
//     bool  surface_void()                whether there is a hole; HOLES
//     float surface_level()               that is seen, from 0 on; LIT, LEVEL_COLOURS
//     vec3  surface_normal(out vec3 up)   unit normal, and which way is up, in the eye's axes; LIT
//     float surface_unknown()             1 where there is no terrain, else 0; SPHERE
//     float surface_snow()                height where snow stays, metres above the sea; SPHERE
//     float surface_haze()                squared optical depth of the air before the terrain; HAZE
//
// Colours are squares of what is shown, so that light adds up; the root is taken at the end.
layout(binding = 1) uniform sampler1D ramp_map; // sea (first half, deep to shallow), then land
layout(location = 0) out vec4 colour;

void main()
{
#ifdef HOLES
    if (surface_void())
        discard;
#endif
    // The shore lies a little above the sea, so that filtered heights around sea level do not flicker.
    float h = surface_height() - heights.x, at = 0.5 + clamp(h * heights.z, 0.001, 0.999) * 0.5;
#ifdef WATER
    bool sea = h <= heights.w;
    at = sea ? 0.5 - clamp(-h * heights.y, 0.001, 0.999) * 0.5 : at;
#endif
    vec3 c = textureLod(ramp_map, at, 0.0).rgb;
#ifdef SPHERE
    float unknown = surface_unknown();
    c = mix(c, vec3(0.16, 0.165, 0.17), unknown);
#endif
#ifdef LIT
    vec3 up, n = surface_normal(up);
    float upright = dot(n, up);
#ifdef NATURAL_LAND
    // Bare rock where it is steep, and snow that does not lie there.
    float steep = clamp((0.92 - upright) * 2.2, 0.0, 0.65);
#ifdef WATER
    steep = sea ? 0.0 : steep;
#endif
    c = mix(c, vec3(0.135, 0.115, 0.095), steep);
#ifdef SPHERE
    float snow = smoothstep(-250.0, 450.0, h - surface_snow()) * clamp((upright - 0.6) * 4.0, 0.0, 1.0);
#ifdef WATER
    snow = sea ? 0.0 : snow;
#endif
    c = mix(c, vec3(0.58, 0.61, 0.65), snow * (1.0 - unknown));
#endif
#endif
#ifdef WATER
    n = sea ? up + 0.2 * (n - upright * up) : n; // the bottom just shows through
#endif
    // The sun, light of the sky from above and of the ground around from the side (softer than Lambert's law alone).
    float facing = dot(n, sun.xyz), direct = max(facing, 0.0) * sun.w;
    float ambient = 0.34 + 0.14 * dot(n, up) + 0.12 * facing;
#ifdef SPHERE
    // On a globe the sun sets, and the sky's light with it.
    float day = smoothstep(-0.22, 0.3, dot(up, sun.xyz));
    direct *= day;
    ambient *= 0.06 + 0.94 * day;
#endif
#ifndef NATURAL_LAND
    // Without air there is no light from the sky.
    direct *= 1.5;
    ambient *= 0.18;
#endif
    c *= direct * vec3(1.0, 0.96, 0.88) + ambient * vec3(0.82, 0.91, 1.0);
#endif
#ifdef LEVEL_COLOURS
    const vec3 hues[6] = vec3[](vec3(1.0, 0.25, 0.2), vec3(1.0, 0.75, 0.2), vec3(0.35, 0.9, 0.3), vec3(0.2, 0.85, 0.9),
                                vec3(0.3, 0.45, 1.0), vec3(0.85, 0.35, 0.9));
    c = mix(c, dot(c, vec3(0.4, 0.5, 0.1)) * 2.2 * hues[int(surface_level()) % 6], 0.7);
#endif
#ifdef HAZE
    // A share d^2 / (1 + d^2) of optical depth d, which has no end where a sample's depth is extrapolated to 0.
    float r2 = min(surface_haze(), 1e30);
#ifdef LIT
#ifdef SPHERE
    vec3 air = haze.rgb * day;
#else
    vec3 air = haze.rgb;
#endif
#else
    vec3 air = haze.rgb;
#endif
    c += (air - c) * (r2 / (1.0 + r2));
#endif
    colour = encoded(sqrt(c));
}
