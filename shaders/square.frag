// square.frag - the ground at a fragment, for planar/square.c (ground.glsl).
#if defined(NORMALS) || defined(LEVEL_COLOURS) || defined(MULTISAMPLED) || defined(TOLERANCE)
#define PLACED
INTERPOLATED in vec4 v_terrain; // square.glsl
#else
INTERPOLATED in float v_height;
#endif
#ifdef MULTISAMPLED
flat in vec4 v_corner;
flat in vec3 v_more;

// Of a triangle that is edge on, a sample may lie outside by the rounding of its corners, and what is interpolated many
// cells beside it, or anything: there a corner's is taken. A triangle is one cell wide.
bool beside()
{
    vec2 way = abs(v_terrain.yz - v_corner.yz);
#ifdef TOLERANCE
    way *= layer[3 * int(v_corner.w) + 2].y;
#endif
    return !(max(way.x, way.y) < 1.25);
}

#endif

#ifdef PLACED
// Samples from the viewer's: of the layer, where blocks are chosen by their error of the finest level.
vec2 place_seen()
{
#ifdef MULTISAMPLED
    return beside() ? v_corner.yz : v_terrain.yz;
#else
    return v_terrain.yz;
#endif
}
#endif
#ifdef IMAGERY
#ifdef MULTISAMPLED
vec2 plane_seen() // metres east and north of the eye, as in square.glsl
{
#ifdef TOLERANCE
    return place_seen() * surface[0].xy - surface[0].zw;
#else
    return place_seen() / layer[3 * int(v_corner.w) + 2].y * surface[0].xy - surface[0].zw;
#endif
}
#else
INTERPOLATED in vec2 v_plane;
vec2 plane_seen()
{
    return v_plane;
}
#endif
#endif
#ifdef NORMALS
layout(binding = 2) uniform sampler2DArray normals_map;
#endif
#ifdef HOLES
in float v_void;
#endif
#ifdef AT_SEA
INTERPOLATED in float v_above_sea;
#endif

#ifdef PLACED
// The layer that the vertices read.
float level()
{
#ifdef MULTISAMPLED
    return v_corner.w;
#else
#ifdef TOLERANCE
    return floor(v_terrain.w + 0.5);
#else
    return floor(0.5 * v_terrain.w);
#endif
#endif
}
#endif

#ifdef TOLERANCE
// The layer of the level that the distance alone calls for, whichever the block is drawn by: a mesh that is off by less than
// a pixel still loses slopes and colours that are seen. Of levels that are not there yet the finest one that is.
Shown shown()
{
    vec2 place = place_seen(), away = abs(place - surface[1].yz);
    float far = max(away.x, away.y), reach = surface[2].x;
    int coarser = max(int(ceil(log2(max(far, 1.0) / reach))), whole[1].z), l = max(whole[1].x - coarser, 0);
    float alpha = max((far * layer[3 * l + 2].y - reach) * surface[2].y + 1.0, layer[3 * l].z);
    vec4 w = window[l];
    vec2 at = layer[3 * l].xy + place * layer[3 * l + 2].y;
    for (; l > 0 && (l > whole[1].y || any(lessThan(at, vec2(0.0))) || any(greaterThan(at, w.zw))); alpha = 0.0) {
        l--;
        w = window[l];
        at = layer[3 * l].xy + place * layer[3 * l + 2].y;
    }
    return Shown(l, l > 0 ? clamp(alpha, 0.0, 1.0) : 0.0, clamp(at, vec2(0.0), w.zw));
}
#endif

#ifdef NORMALS
#ifdef TOLERANCE
vec3 normal(Shown s)
{
    vec2 place = (2.0 * (window[s.layer].xy + s.at) + 0.5) * (0.5 / float(WINDOW_MASK + 1));
    vec4 n = textureLod(normals_map, vec3(place, float(s.layer)), 0.0);
    vec2 xy = mix(n.xy, n.zw, s.alpha);
    return vec3(xy, sqrt(1.0 - min(dot(xy, xy), 1.0)));
}
#else
// The layer's normal and the coarser one's, by the same alpha as the heights.
vec3 normal(float level)
{
#ifdef MULTISAMPLED
    float alpha = beside() ? 0.0 : clamp(v_terrain.w, 0.0, 1.0);
    // No further than the window, beyond which the map holds what was there before.
    vec4 w = window[int(level)];
    vec2 at = clamp(v_more.xy + place_seen(), vec2(0.0), w.zw);
    vec2 place = (2.0 * (w.xy + at) + 0.5) * (0.5 / float(WINDOW_MASK + 1));
#else
    float alpha = clamp(v_terrain.w - 2.0 * level - 0.5, 0.0, 1.0);
    vec2 place = v_terrain.yz;
#endif
    vec4 n = textureLod(normals_map, vec3(place, level), 0.0);
    vec2 xy = mix(n.xy, n.zw, alpha);
    return vec3(xy, sqrt(1.0 - min(dot(xy, xy), 1.0)));
}
#endif
#endif

#ifdef CONTOURS
// At the pixel's middle, also where samples are shaded: lines are that of a triangle's plane, which goes on beside it.
float rise()
{
#ifdef PLACED
    return interpolateAtOffset(v_terrain, vec2(0.0)).x;
#else
    return interpolateAtOffset(v_height, vec2(0.0));
#endif
}
#endif

// A height that is told, above the eye.
float above_eye(float told)
{
    return told + ((eye.z - eye.x) + (eye.w - eye.y));
}

Ground surface_ground()
{
    Ground g;
#ifdef PLACED
    float told = v_terrain.x;
#else
    float told = v_height;
#endif
#ifdef MULTISAMPLED
    told = beside() ? v_corner.x : told;
#endif
#ifdef CONTOURS
    g.rise = rise();
#ifdef MULTISAMPLED
    g.rise = beside() ? v_corner.x : g.rise;
#endif
    g.rise = above_eye(g.rise);
#endif
#ifdef TOLERANCE
    Shown s = shown();
    g.height = shown_height(s);
#else
    g.height = (told + eye.w) + eye.z;
#endif
#ifdef AT_SEA
#ifdef TOLERANCE
    float above_sea = g.height - SEA_LEVEL;
#else
    float above_sea = v_above_sea;
#ifdef MULTISAMPLED
    above_sea = beside() ? g.height - SEA_LEVEL : v_above_sea;
#endif
    g.height = abs(above_sea) < abs(told) ? above_sea + SEA_LEVEL : g.height;
#endif
#ifdef FLOOD
    g.above_sea = above_sea;
#endif
#endif
    g.colour = vec4(0.0);
#ifdef NORMALS
#ifdef TOLERANCE
    g.normal = normal(s);
#else
    g.normal = normal(level());
#endif
    g.up = vec3(0.0, 0.0, 1.0);
    g.fall = g.normal.xy / max(g.normal.z, 1e-3);
#endif
#ifdef IMAGERY
    vec2 plane = plane_seen();
#ifdef NORMALS
    Footprint f = footprint_of(vec3(plane, above_eye(told)), g.normal);
#else
    Footprint f = footprint_of(vec3(plane, above_eye(told)), vec3(0.0, 0.0, 1.0));
#endif
    g.colour = image_colour(image_at(0, plane, f.longer.xy, f.shorter.xy));
#endif
#ifdef ZONES
    g.sine = sin(around[4].x + around[4].y * ((pixel[2].y + dot(gl_FragCoord.xy * lens.xy - lens.zw,
                                                                vec2(pixel[0].y, pixel[1].y))) / gl_FragCoord.w));
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
// Distance d from the depth that is there anyway: (d / L)^2. A triangle without area is not shaded where its samples are.
float surface_haze()
{
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    float nearness = NEARNESS;
#ifdef MULTISAMPLED
#ifdef CLOSERS
    nearness = v_more.z;
#else
    nearness = beside() ? v_more.z : nearness;
#endif
#endif
    float r = haze.w / nearness;
    return r * r * (1.0 + dot(across, across));
}
#endif
