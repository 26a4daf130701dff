// square.glsl - the map transform of planar/square_draws.c: square grids over a flat map; heights from the vertex texture,
// morphed (LH04 6.2, AH05).
//
// Positions come from one integer, the vertex's place in samples of the finest level relative to the viewer's sample,
// by the same expression in every level: a vertex that two levels share is bit-identical in both (no cracks).
//
// What is interpolated goes into one vector: on a software renderer each one more costs 4 % of a frame.
// Where blocks are chosen by their error (planar/square_tree.c): surface[1] x: 1 / cells of a block along a side; y, z: the
// viewer beyond its sample, finest samples; surface[2] x: samples that a level's normals reach; y: 1 / those in which they pass
// over; whole[1] x: shift of the coarsest level; y: last layer that is up to date; z: least shift whose normals are seen;
// layer[3 l] x, y: the viewer's sample from the window's first, in samples; z: least alpha of normals; [3 l + 2] y: 2^-shift
#ifdef WALLS
// Of a strip along a side of the block: every other vertex is at the foot (planar/square_walls.c).
bool at_foot()
{
    return (gl_VertexID & 1) != 0;
}

// Of the floor, whose corners they are.
bool of_floor()
{
    return gl_VertexID >= 1 << 21;
}

ivec2 wall_vertex()
{
    ivec2 place = ivec2(gl_VertexID >> 10 & 1023, gl_VertexID >> 1 & 511);
    return gl_VertexID < 1 << 20 ? place : place.yx;
}
#define in_vertex wall_vertex()
#else
layout(location = 0) in ivec2 in_vertex; // of the static geometry
#endif
layout(location = 1) in ivec4 in_instance; // its block: instance() in square_draws.c
#ifdef TOLERANCE
layout(location = 2) in vec4 in_corners; // alpha at its corners: south-west, south-east, north-west, north-east
#endif
layout(binding = 0) uniform sampler2DArray heights_map; // (z, z_c), metres above z_base
#ifdef HOLES
layout(binding = 3) uniform sampler2DArray voids_map;
out float v_void;
#endif
#ifdef AT_SEA
INTERPOLATED out float v_above_sea; // metres above SEA_LEVEL
#endif
#ifdef WALLS
INTERPOLATED out float v_height; // as they are told
flat out vec3 v_wall;            // x, y: outwards, 0 of the floor; z: level
#else
#if defined(NORMALS) || defined(LEVEL_COLOURS) || defined(MULTISAMPLED) || defined(TOLERANCE)
#define PLACED
INTERPOLATED out vec4 v_terrain; // x: height as it is told; y, z: place in the normal map; w: 2 level + 0.5 + alpha
                                // (multisampled: y, z: samples from the viewer's; w: alpha; where blocks are chosen
                                // by their error: y, z: finest samples from the viewer's; w: level)
#else
INTERPOLATED out float v_height; // as it is told
#endif
#endif
#if defined(IMAGERY) && !defined(MULTISAMPLED)
INTERPOLATED out vec2 v_plane; // metres east and north of the eye
#endif
#if defined(MULTISAMPLED) && !defined(WALLS)
flat out vec4 v_corner; // x, y, z: v_terrain's at a corner; w: level
flat out vec3 v_more;   // x, y: the viewer's place in samples from the window's first; z: NEARNESS at the corner
#endif

int block_layer()
{
#ifdef WIDE
    return in_instance.w >> 24;
#else
    return in_instance.w;
#endif
}

// texel: in the level's height window; plane: metres east and north of the eye; cell: place in the level's window in
// samples, for normals; c: from the viewer's; alpha: 0 this level's height, 1 the coarser level's.
void map_vertex(out ivec2 texel, out vec2 plane, out vec2 cell, out vec2 c, out float alpha)
{
    int at = 3 * block_layer();
    vec4 start = layer[at], rate = layer[at + 1], rest = layer[at + 2];
    int shift = whole[1].x - block_layer();
#ifdef WIDE
    ivec2 origin = ivec2(in_instance.w, in_instance.w >> 12) & 0xfff;
    ivec2 first_high = in_instance.xy, first_low = ivec2(in_instance.z << 16, in_instance.z) >> 16;
    ivec2 high = first_high, low = first_low;
    if (shift < 16)
        low += in_vertex << shift;
    else
        high += in_vertex << (shift - 16);
    carry(high, low);
    cut_at_edge(high, low, whole[0]);
    plane = vec2(high) * (HIGH * surface[0].xy) + (vec2(low) * surface[0].xy - surface[0].zw);
    cell = vec2(origin) + vec2(high - first_high) * (HIGH * rest.y) + vec2(low - first_low) * rest.y;
    c = vec2(high) * (HIGH * rest.y) + vec2(low) * rest.y;
#else
    ivec2 origin = ivec2(in_instance.z & 0xffff, in_instance.z >> 16);
    ivec2 place = min(in_instance.xy + (in_vertex << shift), whole[0].xy);
    plane = vec2(place) * surface[0].xy - surface[0].zw;
    cell = vec2(origin) + vec2(place - in_instance.xy) * rest.y;
    c = vec2(place) * rest.y;
#endif
    texel = origin + in_vertex;
#ifdef TOLERANCE
    // Exact along edges: a block has a power of two cells a side, and alphas are multiples of 2^-16.
    vec2 t = vec2(in_vertex) * surface[1].x;
    vec2 ends = in_corners.xz * (1.0 - t.x) + in_corners.yw * t.x;
    alpha = ends.x * (1.0 - t.y) + ends.y * t.y;
    c /= rest.y; // a power of two
#else
    vec4 ramp = vec4(start.x - c.x, c.x - start.y, start.z - c.y, c.y - start.w) * rate;
    alpha = clamp(max(max(max(ramp.x, ramp.y), max(ramp.z, ramp.w)), rest.x), 0.0, 1.0);
#endif
}

#ifdef WALLS
// A little above the walls' feet, whose many vertices lie beside its four sides, not on them: seen from below, walls hang
// before its near sides by more than a part of a pixel, and what is beyond the far ones is beyond the block.
vec3 floor_vertex()
{
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1 & 1);
    vec2 far = max(abs(around[0].xy), abs(around[0].zw));
    float above = (around[1].z - eye.x) - eye.y;
    above += 5e-5 * length(vec3(far, above));
    v_height = (around[1].z - eye.z) - eye.w;
    v_wall = vec3(0.0, 0.0, float(block_layer()));
#ifdef AT_SEA
    v_above_sea = around[1].z - SEA_LEVEL;
#endif
#ifdef HOLES
    v_void = 0.0;
#endif
    vec2 plane = mix(around[0].xy, around[0].zw, corner);
#if defined(IMAGERY) && !defined(MULTISAMPLED)
    v_plane = plane;
#endif
    return vec3(plane, above);
}
#endif

vec3 surface_vertex()
{
#ifdef WALLS
    if (of_floor())
        return floor_vertex();
#endif
    ivec2 texel;
    vec2 plane, cell, c;
    float alpha;
    map_vertex(texel, plane, cell, c, alpha);
    ivec3 at = ivec3(texel & WINDOW_MASK, block_layer());
    vec2 z = texelFetch(heights_map, at, 0).rg;
    precise float height = (1.0 - alpha) * z.x + alpha * z.y;
    precise float above = (height - eye.x) - eye.y;
#ifdef WALLS
    if (at_foot())
        height = height > around[1].y ? around[1].z : around[1].y + around[2].w;
    above = (height - eye.x) - eye.y;
    v_height = (height - eye.z) - eye.w;
    bool row = gl_VertexID >= 1 << 20, first = (gl_VertexID >> 10 & 1023) == 0;
    v_wall = vec3((first ? -1.0 : 1.0) * (row ? vec2(0.0, 1.0) : vec2(1.0, 0.0)), float(block_layer()));
#endif
#ifdef AT_SEA
    v_above_sea = height - SEA_LEVEL;
#endif
    float told = ((1.0 - alpha) * (z.x - eye.z) + alpha * (z.y - eye.z)) - eye.w;
#ifdef HOLES
    v_void = texelFetch(voids_map, at, 0).r;
#endif
#ifdef PLACED
    const float size = float(WINDOW_MASK + 1);
    float level = float(block_layer());
#ifdef MULTISAMPLED
    vec4 corner = view_projection * vec4(plane, above, 1.0);
    v_terrain = vec4(told, c, alpha);
    v_corner = vec4(told, c, level);
    v_more = vec3(mod(cell - window[block_layer()].xy, 2.0 * size) - c, corner.w > 0.0 ? NEARNESS_AT(corner) : 1.0);
#else
    v_terrain = vec4(told, (2.0 * cell + 0.5) * (0.5 / size), 2.0 * level + 0.5 + alpha);
#endif
#ifdef TOLERANCE
    v_terrain = vec4(told, c, level);
#endif
#else
#ifndef WALLS
    v_height = told;
#endif
#endif
#if defined(IMAGERY) && !defined(MULTISAMPLED)
    v_plane = plane;
#endif
    return vec3(plane, above);
}
