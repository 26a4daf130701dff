// faces.vert - a vertex of a block of a face (spherical/faces.c): its place by its chart, its height from the level's window.
//
// Cells finer than the layer's lie on its mesh, where a globe bends away from its triangles (in_instance.z: by how many levels).
//
// A vertex passes over into the coarser level's mesh by alpha: a sample that the coarser level has, to the height that it has
// there; another one to the middle of the coarser edge that it lies on, in space. With alpha = 1 the mesh is the
// coarser one, bit for bit at shared vertices.
layout(location = 0) in ivec2 in_vertex;   // of the static geometry
layout(location = 1) in ivec4 in_instance; // its block: instance() in faces.c
#ifdef TOLERANCE
layout(location = 2) in vec4 in_corners; // alpha at its corners by the tolerance: south-west, south-east, north-west, north-east
#endif
layout(binding = 0) uniform sampler2DArray heights_map; // (z, z_c), metres above z_base
#ifdef HOLES
layout(binding = 3) uniform sampler2DArray voids_map;
out float v_void;
#endif
#ifdef AT_SEA
INTERPOLATED out float v_above_sea; // metres above SEA_LEVEL
#endif
INTERPOLATED out vec4 v_terrain; // x: metres above the reference height; y, z: samples of the layer from the viewer's; w: alpha of it
INTERPOLATED out vec3 v_direction; // normal less the viewer's: east, north, up
flat out vec4 v_corner;          // x, y, z: v_terrain's at a corner; w: layer
flat out vec4 v_window;          // x, y: the viewer's place in samples from the window's first; z: NEARNESS at the corner;
                                 // w: samples along a cell
flat out vec3 v_aside;           // v_direction's at the corner

int block_layer()
{
    return in_instance.w & 127;
}

// The alpha of a vertex on the edge of its block where the mesh beyond is another level's (tc_leaf_alpha() in
// common/blocks/blocks.h): 1 where it is coarser, 0 where it is finer; below 0: it is neither. missing: how much of the way
// to the coarser level is due to blocks that are not held.
float edge_alpha(out float missing)
{
    int bits = in_instance.w, cells = 1 << (in_instance.z >> 26 & 15);
    vec4 f = vec4(bits >> 15 & 1, bits >> 16 & 1, bits >> 17 & 1, bits >> 18 & 1);
    vec2 t = vec2(in_vertex) / float(cells);
    missing = mix(mix(f.x, f.y, t.x), mix(f.z, f.w, t.x), t.y);
    bool west = in_vertex.x == 0, east = in_vertex.x == cells, south = in_vertex.y == 0, north = in_vertex.y == cells;
    if ((west || east) && (south || north)) {
        int corner = (east ? 1 : 0) + (north ? 2 : 0);
        return (bits >> 11 >> corner & 1) != 0 ? 1.0 : (bits >> 19 >> corner & 1) != 0 ? 0.0 : -1.0;
    }
    int side = west ? 0 : east ? 1 : south ? 2 : north ? 3 : -1;
    if (side < 0)
        return -1.0;
    int along = 2 * (side < 2 ? in_vertex.y : in_vertex.x), halves = (along <= cells ? 1 : 0) + (along >= cells ? 2 : 0);
    return (bits >> 7 >> side & 1) != 0 ? 1.0 : ((bits >> 23 & 255) >> 2 * side & halves) != 0 ? 0.0 : -1.0;
}

vec3 direction_at(int chart, ivec2 at)
{
    settle_chart(chart, at);
    precise vec3 d = chart_direction(chart, at);
    return d;
}

// rest: of the height, what a float has no room for.
vec3 position_of(vec3 d, float height, float rest)
{
    precise float above = ((height - eye.x) - eye.y) + rest;
    precise vec3 p = body_place(d, height, above);
    return p;
}

// The heights of a place on a layer's level, and of the coarser level's mesh there: of a sample both are at hand; of what lies
// between samples, or is `finer`, all levels are of one mesh, and there is a rest. The same floats from either end of an edge.
vec3 heights_at(int l, int shift, int finer, ivec2 at)
{
    ivec2 cell = at >> shift, beside = at - (cell << shift);
    vec2 z = texelFetch(heights_map, ivec3(cell & WINDOW_MASK, l), 0).rg;
    if (beside == ivec2(0))
        return vec3(finer > 0 ? z.xx : z, 0.0);
    vec2 t = vec2(beside) * exp2(-float(shift));
    ivec2 next = cell + ivec2(beside.x > 0, beside.y > 0);
    bool lower = t.x + t.y <= 1.0;
    if (!lower) {
        z.x = texelFetch(heights_map, ivec3(next & WINDOW_MASK, l), 0).r;
        t = 1.0 - t.yx;
    }
    float east = texelFetch(heights_map, ivec3(ivec2(next.x, cell.y) & WINDOW_MASK, l), 0).r;
    float north = texelFetch(heights_map, ivec3(ivec2(cell.x, next.y) & WINDOW_MASK, l), 0).r;
    float own = 1.0 - t.x - t.y;
    precise float height = own * z.x + (t.x * east + t.y * north);
    precise float from_eye = own * (z.x - eye.x) + (t.x * (east - eye.x) + t.y * (north - eye.x));
    precise float rest = from_eye - (height - eye.x);
    return vec3(height, height, rest);
}

#ifdef HOLES
// Likewise whether any sample that has a share in it is void.
float void_at(int l, int shift, ivec2 at)
{
    ivec2 cell = at >> shift, beside = at - (cell << shift), next = cell + ivec2(beside.x > 0, beside.y > 0);
    int one = 1 << shift, sum = beside.x + beside.y;
    float v = 0.0;
    if (sum < one)
        v = max(v, texelFetch(voids_map, ivec3(cell & WINDOW_MASK, l), 0).r);
    if (sum > one)
        v = max(v, texelFetch(voids_map, ivec3(next & WINDOW_MASK, l), 0).r);
    if ((sum <= one ? beside.x : one - beside.y) > 0)
        v = max(v, texelFetch(voids_map, ivec3(ivec2(next.x, cell.y) & WINDOW_MASK, l), 0).r);
    if ((sum <= one ? beside.y : one - beside.x) > 0)
        v = max(v, texelFetch(voids_map, ivec3(ivec2(cell.x, next.y) & WINDOW_MASK, l), 0).r);
    return v;
}
#endif

vec3 surface_vertex()
{
    int l = block_layer(), finer = in_instance.z & 31;
    vec4 level = layer[3 * l];
    int chart = int(level.x), own = int(level.y), shift = own - finer, torus = 2 * (WINDOW_MASK + 1);
    ivec2 at = in_instance.xy + (in_vertex << shift), texel = at >> own;
    vec3 z = heights_at(l, own, finer, at);
    vec3 d = direction_at(chart, at);
    float missing, edge = edge_alpha(missing);
    float to_range = level.z;
#ifdef TOLERANCE
    // Exact along edges: a block has a power of two cells a side, and alphas are multiples of 2^-16.
    vec2 t = vec2(in_vertex) * exp2(-float(in_instance.z >> 26 & 15));
    vec2 ends = in_corners.xz * (1.0 - t.x) + in_corners.yw * t.x;
    float by_error = ends.x * (1.0 - t.y) + ends.y * t.y;
    float alpha = max(finer > 0 ? 0.0 : clamp((viewer_distance(d) * to_range - surface[2].x) * surface[2].y, 0.0, 1.0), by_error);
#else
    if (finer > 0) {
        float cell = surface[3].y * exp2(float(1 - finer));
        to_range = max(surface[3].x * exp2(-float(shift)), surface[3].z / (cell * cell * (1.0 + surface[3].w / max(surface[2].w, cell))));
    }
    float alpha = clamp((viewer_distance(d) * to_range - surface[2].x) * surface[2].y, 0.0, 1.0);
#endif
    alpha = edge < 0.0 ? max(alpha, missing) : edge;
    alpha = to_range > 0.0 ? alpha * surface[2].z : 0.0;
    ivec2 odd = at >> shift & 1;
    bool between = odd != ivec2(0);
    precise float height = between || finer > 0 ? z.x : (1.0 - alpha) * z.x + alpha * z.y;
    precise vec3 position = position_of(d, height, z.z);
    if (between && alpha > 0.0) {
        // Ends of the coarser edge: along a row, a column, or the diagonal that all cells are cut by.
        ivec2 way = ivec2(odd.x, odd.x == 1 ? -odd.y : 1) << shift;
        vec2 z0 = heights_at(l, own, finer, at + way).yz, z1 = heights_at(l, own, finer, at - way).yz;
        vec3 d0 = direction_at(chart, at + way), d1 = direction_at(chart, at - way);
        position = (1.0 - alpha) * position + alpha * (0.5 * (position_of(d0, z0.x, z0.y) + position_of(d1, z1.x, z1.y)));
        d = (1.0 - alpha) * d + alpha * (0.5 * (d0 + d1));
    }
    float told = ((1.0 - alpha) * (z.x - surface[1].y) + alpha * (z.y - surface[1].y)) - surface[1].z;
    // Samples of the layer's level from the viewer's place on the chart.
    ivec2 nearest = ivec2(whole[PLACES(chart) + 1].w, whole[PLACES(chart) + 2].w);
    vec2 place = (vec2(at - nearest) - surface[FACE(chart) + 4].xy) * exp2(-float(own));
    vec2 viewer = mod(vec2(texel & (torus - 1)) - window[l].xy, float(torus)) + vec2(at - (texel << own)) * exp2(-float(own)) - place;
    vec4 corner = view_projection * vec4(position, 1.0);
    v_terrain = vec4(told, place, finer > 0 ? 0.0 : alpha);
#ifdef AT_SEA
    v_above_sea = (1.0 - alpha) * (z.x - SEA_LEVEL) + alpha * (z.y - SEA_LEVEL);
#endif
    v_direction = d;
    v_corner = vec4(told, place, float(l));
    v_window = vec4(viewer, corner.w > 0.0 ? NEARNESS_AT(corner) : 1.0, exp2(-float(finer)));
    v_aside = d;
#ifdef HOLES
    v_void = void_at(l, own, at);
#endif
    return position;
}
