// renderer.vert - a vertex of the support geometry: height from the vertex texture, morphed (LH04 6.2, AH05).
//
// All that the fragment shader needs goes into one vector: on a software renderer each one more costs 4 % of a frame.
layout(binding = 0) uniform sampler2DArray heights_map; // (z, z_c), metres above z_base
#ifdef HOLES
layout(binding = 3) uniform sampler2DArray voids_map;
out float v_void;
#endif
#if defined(LIT) || defined(LEVEL_COLOURS)
out vec4 v_terrain; // x: metres above z_base; y, z: place in the normal map; w: 2 level + 0.5 + alpha
#else
out float v_height; // metres above z_base
#endif
invariant gl_Position;

void main()
{
    ivec2 texel;
    vec2 plane, cell;
    float alpha;
    map_vertex(texel, plane, cell, alpha);
    ivec3 at = ivec3(texel & WINDOW_MASK, in_instance.w);
    vec2 z = texelFetch(heights_map, at, 0).rg;
    precise float height = (1.0 - alpha) * z.x + alpha * z.y;
    precise float above = (height - eye.x) - eye.y;
    gl_Position = view_projection * vec4(plane, above, 1.0);
#ifdef HOLES
    v_void = texelFetch(voids_map, at, 0).r;
#endif
#if defined(LIT) || defined(LEVEL_COLOURS)
    v_terrain = vec4(height, (2.0 * cell + 0.5) * (0.5 / float(WINDOW_MASK + 1)), 2.0 * float(in_instance.w) + 0.5 + alpha);
#else
    v_height = height;
#endif
}
