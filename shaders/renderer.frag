// renderer.frag - colour of the ground (ground.glsl): ramp by height, light from normals, haze.
//
// Colours are squares of what is shown, so that light adds up; the root is taken at the end.
layout(binding = 1) uniform sampler1D ramp_map; // sea (first half, deep to shallow), then land; or all heights, given
layout(location = 0) out vec4 colour;

void main()
{
    Ground ground = surface_ground();
#ifdef GIVEN_COLOURS
#if defined(SHADE_SLOPE) || defined(SHADE_ASPECT)
    float h = shade_degrees(ground);
#else
    float h = ground.height - heights.x;
#endif
    float last = float(textureSize(ramp_map, 0) - 1);
    float at = (clamp((h - heights.w) * heights.z, 0.0, 1.0) * last + 0.5) / (last + 1.0);
#else
    // The shore lies a little above the sea, so that filtered heights around sea level do not flicker.
    float h = ground.height - heights.x, at = 0.5 + clamp(h * heights.z, 0.001, 0.999) * 0.5;
#ifdef WATER
    bool sea = h <= heights.w;
    at = sea ? 0.5 - clamp(-h * heights.y, 0.001, 0.999) * 0.5 : at;
#endif
#ifdef ZONES
    at = min(at, 0.62); // the ramp's greens
#endif
#endif
    vec3 c = textureLod(ramp_map, at, 0.0).rgb;
#ifdef ZONES
#ifdef WATER
    if (!sea)
#endif
        c = zoned(c, h / beyond.y + around[4].z, ground.sine);
#endif
#ifdef SHADE_ASPECT
    c = shade_flat(c, ground);
#endif
    c = mix(c, ground.colour.rgb, ground.colour.a);
#ifdef FLOOD
    bool sea = ground.above_sea <= beyond.w;
#endif
#ifdef WALLS
#if defined(WATER) || defined(FLOOD)
    sea = sea && ground.colour.a < 1.0; // else it is the wall
#endif
#endif
#ifdef FLOOD
    // Over whatever else the ground is coloured by: nothing is seen of what lies below it.
    c = sea ? vec3(0.0246, 0.1085, 0.2289) : c;
#endif
#ifdef LIT
    vec3 up = ground.up, n = ground.normal;
    float upright = dot(n, up);
#if defined(NATURAL_LAND) && !defined(GIVEN_COLOURS)
    // Bare rock where it is steep, and snow that does not lie there; by true heights, as all colours.
    float lying = upright, true_height = h;
#ifdef EXAGGERATED
    lying = inversesqrt(1.0 + dot(ground.fall, ground.fall) / (beyond.y * beyond.y));
    true_height = h / beyond.y;
#endif
    float steep = clamp((0.92 - lying) * 2.2, 0.0, 0.65);
#if defined(WATER) || defined(FLOOD)
    steep = sea ? 0.0 : steep;
#endif
    c = mix(c, vec3(0.135, 0.115, 0.095), steep * (1.0 - ground.colour.a));
#if defined(CLIMATE) || defined(ZONES)
#ifdef ZONES
    float line = snow_line(ground.sine) - around[4].z;
#else
    float line = ground.snow_line;
#endif
    float snow = smoothstep(-250.0, 450.0, true_height - line) * clamp((lying - 0.6) * 4.0, 0.0, 1.0);
#if defined(WATER) || defined(FLOOD)
    snow = sea ? 0.0 : snow;
#endif
    c = mix(c, vec3(0.58, 0.61, 0.65), snow * (1.0 - ground.colour.a));
#endif
#endif
#ifdef WATER
    n = sea ? up + 0.2 * (n - upright * up) : n; // the bottom just shows through
#endif
#ifdef FLOOD
    n = sea ? up : n;
#endif
#ifdef CLIMATE
    vec3 light = daylight(dot(n, sun.xyz), dot(n, up), ground.day, dusk.y);
#else
    vec3 light = daylight(dot(n, sun.xyz), dot(n, up), dusk.x, dusk.y);
#endif
#ifdef WALLS
    light = max(light, vec3(0.33 * max(dusk.x, dusk.y))); // a model's, not a cliff's
#endif
    c *= light;
#endif
#ifdef HILLSHADE
    c *= hillshade(ground);
#endif
#ifdef LEVEL_COLOURS
    const vec3 hues[6] = vec3[](vec3(1.0, 0.25, 0.2), vec3(1.0, 0.75, 0.2), vec3(0.35, 0.9, 0.3), vec3(0.2, 0.85, 0.9),
                                vec3(0.3, 0.45, 1.0), vec3(0.85, 0.35, 0.9));
    c = mix(c, dot(c, vec3(0.4, 0.5, 0.1)) * 2.2 * hues[int(ground.level) % 6], 0.7);
#endif
#ifdef CONTOURS
    vec3 lined = contoured(c, ground); // by derivatives, which all take
#ifdef FLOOD
    lined = sea ? c : lined; // nor at its edge, where a level that is a line's has one
#endif
    c = lined;
#endif
#ifdef HAZE
    // A share d^2 / (1 + d^2) of optical depth d, which has no end where a sample's depth is extrapolated to 0.
    float r2 = min(surface_haze(), 1e30);
    vec3 air = haze.rgb;
#if defined(LIT) && defined(CLIMATE)
    air *= ground.day;
#endif
    c += (air - c) * (r2 / (1.0 + r2));
#endif
#ifdef HOLES
    bool hole = ground.hole;
#ifdef FLOOD
    hole = hole && !sea; // the sea lies over what is not known, too
#endif
    if (hole) // at the end: what is beside it is told by derivatives, which are anything afterwards
        discard;
#endif
    colour = encoded(sqrt(c));
}
