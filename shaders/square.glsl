// square.glsl - the map transform of planar/square.c: square grids over a flat map.
//
// Positions come from one integer, the vertex's place in samples of the finest level relative to the viewer's sample,
// by the same expression in every level: a vertex that two levels share is bit-identical in both (no cracks).

// texel: in the level's height window; plane: metres east and north of the eye; cell: place in the level's window in
// samples, for normals; alpha: 0 this level's height, 1 the coarser level's.
void map_vertex(out ivec2 texel, out vec2 plane, out vec2 cell, out float alpha)
{
    vec4 start = level[3 * in_instance.w], rate = level[3 * in_instance.w + 1], rest = level[3 * in_instance.w + 2];
    ivec2 origin = ivec2(in_instance.z & 0xffff, in_instance.z >> 16);
    ivec2 place = min(in_instance.xy + (in_vertex << floatBitsToInt(rest.z)), floatBitsToInt(surface[1].xy));
    texel = origin + in_vertex;
    plane = vec2(place) * surface[0].xy - surface[0].zw;
    cell = vec2(origin) + vec2(place - in_instance.xy) * rest.y;
    vec2 c = vec2(place) * rest.y;
    vec4 ramp = vec4(start.x - c.x, c.x - start.y, start.z - c.y, c.y - start.w) * rate;
    alpha = clamp(max(max(max(ramp.x, ramp.y), max(ramp.z, ramp.w)), rest.x), 0.0, 1.0);
}
