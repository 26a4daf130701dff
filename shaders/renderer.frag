// renderer.frag - colour of the terrain: ramp by height, light from a normal map at twice the resolution, haze.
//
// Colours are squares of what is shown, so that light adds up; the root is taken at the end.
#if defined(LIT) || defined(LEVEL_COLOURS)
INTERPOLATED in vec4 v_terrain; // renderer.vert
#else
INTERPOLATED in float v_height;
#endif
#if defined(MULTISAMPLED) && (defined(LIT) || defined(LEVEL_COLOURS))
flat in int v_level;
#endif
#ifdef LIT
layout(binding = 2) uniform sampler2DArray normals_map;
#endif
#ifdef HOLES
in float v_void;
#endif
layout(binding = 1) uniform sampler1D ramp_map; // sea (first half, deep to shallow), then land
layout(location = 0) out vec4 colour;

#ifdef LIT
// The level's normal and the coarser one's, by the same alpha as the heights.
vec3 map_normal(float level, float alpha)
{
#ifdef MULTISAMPLED
    // A pixel's middle may lie outside the triangle that covers some of its samples, far outside a thin one: no further
    // than the window, beyond which the map holds what was there before.
    vec4 w = window[int(level)];
    vec2 place = (2.0 * (w.xy + clamp(v_terrain.yz, vec2(0.0), w.zw)) + 0.5) * (0.5 / float(WINDOW_MASK + 1));
#else
    vec2 place = v_terrain.yz;
#endif
    vec4 n = textureLod(normals_map, vec3(place, level), 0.0);
    vec2 xy = mix(n.xy, n.zw, alpha);
    return vec3(xy, sqrt(1.0 - min(dot(xy, xy), 1.0)));
}
#endif

void main()
{
#ifdef HOLES
    if (v_void > 0.0)
        discard;
#endif
#if defined(LIT) || defined(LEVEL_COLOURS)
#ifdef MULTISAMPLED
    float level = float(v_level);
#else
    float level = floor(0.5 * v_terrain.w);
#endif
    float v_height = v_terrain.x;
#endif
    // The shore lies a little above the sea, so that filtered heights around sea level do not flicker.
    float h = v_height - heights.x, at = 0.5 + clamp(h * heights.z, 0.001, 0.999) * 0.5;
#ifdef WATER
    bool sea = h <= heights.w;
    at = sea ? 0.5 - clamp(-h * heights.y, 0.001, 0.999) * 0.5 : at;
#endif
    vec3 c = textureLod(ramp_map, at, 0.0).rgb;
#ifdef LIT
    vec3 n = map_normal(level, clamp(v_terrain.w - 2.0 * level - 0.5, 0.0, 1.0));
#ifdef NATURAL_LAND
    // Bare rock where it is steep, and snow that does not lie there.
    float steep = clamp((0.92 - n.z) * 2.2, 0.0, 0.65);
#ifdef WATER
    steep = sea ? 0.0 : steep;
#endif
    c = mix(c, vec3(0.135, 0.115, 0.095), steep);
#endif
#ifdef WATER
    n = sea ? vec3(0.2 * n.xy, 1.0) : n; // the bottom just shows through
#endif
    // The sun, light of the sky from above and of the ground around from the side (softer than Lambert's law alone).
    float facing = dot(n, sun.xyz), direct = max(facing, 0.0) * sun.w, ambient = 0.34 + 0.14 * n.z + 0.12 * facing;
    c *= direct * vec3(1.0, 0.96, 0.88) + ambient * vec3(0.82, 0.91, 1.0);
#endif
#ifdef LEVEL_COLOURS
    const vec3 hues[6] = vec3[](vec3(1.0, 0.25, 0.2), vec3(1.0, 0.75, 0.2), vec3(0.35, 0.9, 0.3), vec3(0.2, 0.85, 0.9),
                                vec3(0.3, 0.45, 1.0), vec3(0.85, 0.35, 0.9));
    c = mix(c, dot(c, vec3(0.4, 0.5, 0.1)) * 2.2 * hues[int(level) % 6], 0.7);
#endif
#ifdef HAZE
    // Distance d from the depth that is there anyway: share (d / L)^2 / (1 + (d / L)^2).
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    float r = haze.w / gl_FragCoord.z, r2 = r * r * (1.0 + dot(across, across));
    c += (haze.rgb - c) * (r2 / (1.0 + r2));
#endif
    colour = vec4(sqrt(c), 1.0);
}
