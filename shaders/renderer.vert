// renderer.vert - a vertex of the support geometry: height from the vertex texture, morphed (LH04 6.2, AH05).
//
// All that the fragment shader needs goes into one vector: on a software renderer each one more costs 4 % of a frame.
layout(binding = 0) uniform sampler2DArray heights_map; // (z, z_c), metres above z_base
#ifdef HOLES
layout(binding = 3) uniform sampler2DArray voids_map;
out float v_void;
#endif
#if defined(LIT) || defined(LEVEL_COLOURS)
INTERPOLATED out vec4 v_terrain; // x: metres above z_base; y, z: place in the normal map
                                // (multisampled: in samples from the window's first); w: 2 level + 0.5 + alpha
#else
INTERPOLATED out float v_height; // metres above z_base
#endif
#if defined(MULTISAMPLED) && (defined(LIT) || defined(LEVEL_COLOURS))
flat out int v_level;
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
    const float size = float(WINDOW_MASK + 1);
#ifdef MULTISAMPLED
    vec2 place = mod(cell - window[in_instance.w].xy, 2.0 * size);
#else
    vec2 place = (2.0 * cell + 0.5) * (0.5 / size);
#endif
#ifdef MULTISAMPLED
    v_level = in_instance.w;
#endif
    v_terrain = vec4(height, place, 2.0 * float(in_instance.w) + 0.5 + alpha);
#else
    v_height = height;
#endif
}
