// square.frag - the ground at a fragment, for planar/square.c (ground.glsl).
#if defined(NORMALS) || defined(LEVEL_COLOURS)
INTERPOLATED in vec4 v_terrain; // square.glsl
#else
INTERPOLATED in float v_height;
#endif
#if defined(MULTISAMPLED) && (defined(NORMALS) || defined(LEVEL_COLOURS))
flat in int v_level;
#endif
#ifdef IMAGERY
INTERPOLATED in vec2 v_plane;
#endif
#ifdef NORMALS
layout(binding = 2) uniform sampler2DArray normals_map;
#endif
#ifdef HOLES
in float v_void;
#endif

#if defined(NORMALS) || defined(LEVEL_COLOURS)
// The layer that the vertices read.
float level()
{
#ifdef MULTISAMPLED
    return float(v_level);
#else
    return floor(0.5 * v_terrain.w);
#endif
}
#endif

#ifdef NORMALS
// The layer's normal and the coarser one's, by the same alpha as the heights.
vec3 normal(float level)
{
    float alpha = clamp(v_terrain.w - 2.0 * level - 0.5, 0.0, 1.0);
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

#ifdef CONTOURS
// At the pixel's middle, also where samples are shaded: lines are that of a triangle's plane, which goes on beside it.
float rise()
{
#if defined(NORMALS) || defined(LEVEL_COLOURS)
    return interpolateAtOffset(v_terrain, vec2(0.0)).x;
#else
    return interpolateAtOffset(v_height, vec2(0.0));
#endif
}
#endif

Ground surface_ground()
{
    Ground g;
#if defined(NORMALS) || defined(LEVEL_COLOURS)
    g.height = v_terrain.x;
#else
    g.height = v_height;
#endif
#ifdef CONTOURS
    g.rise = rise();
    g.height = (g.rise + eye.y) + eye.x;
#endif
    g.colour = vec4(0.0);
#ifdef NORMALS
    g.normal = normal(level());
    g.up = vec3(0.0, 0.0, 1.0);
    g.fall = g.normal.xy / max(g.normal.z, 1e-3);
#endif
#ifdef IMAGERY
#ifdef NORMALS
    Footprint f = footprint_of(vec3(v_plane, g.height - eye.x - eye.y), g.normal);
#else
    Footprint f = footprint_of(vec3(v_plane, g.height - eye.x - eye.y), vec3(0.0, 0.0, 1.0));
#endif
    g.colour = image_colour(image_at(0, v_plane, f.longer.xy, f.shorter.xy));
#endif
#ifdef LEVEL_COLOURS
    g.level = level();
#endif
#ifdef HOLES
    g.hole = v_void > 0.0;
#endif
    return g;
}

#ifdef CONTOURS
float surface_datum()
{
    return 0.0;
}
#endif

#ifdef HAZE
// Distance d from the depth that is there anyway: (d / L)^2. Of a triangle without area, which is not shaded where its
// samples are, it is that of a corner.
#if defined(MULTISAMPLED) && defined(CLOSERS)
flat in float v_depth;
#endif
float surface_haze()
{
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
#if defined(MULTISAMPLED) && defined(CLOSERS)
    float r = haze.w / v_depth;
#else
    float r = haze.w / NEARNESS;
#endif
    return r * r * (1.0 + dot(across, across));
}
#endif
