// shown.glsl - what is seen at a fragment, of a level that its block need not be drawn by (square.frag, faces.frag).
struct Shown {
    int layer;
    float alpha; // share of the coarser level
    vec2 at;     // samples of the layer from its window's first
};

#ifdef TOLERANCE
layout(binding = 0) uniform sampler2DArray heights_map; // (z, z_c), metres above z_base

// Its height, metres above z_base: evenly between four samples.
float shown_height(Shown s)
{
    vec2 cell = min(floor(s.at), max(window[s.layer].zw - 1.0, 0.0)), t = s.at - cell;
    ivec2 first = ivec2(window[s.layer].xy) + ivec2(cell);
    vec2 sw = texelFetch(heights_map, ivec3(first & WINDOW_MASK, s.layer), 0).rg;
    vec2 se = texelFetch(heights_map, ivec3((first + ivec2(1, 0)) & WINDOW_MASK, s.layer), 0).rg;
    vec2 nw = texelFetch(heights_map, ivec3((first + ivec2(0, 1)) & WINDOW_MASK, s.layer), 0).rg;
    vec2 ne = texelFetch(heights_map, ivec3((first + 1) & WINDOW_MASK, s.layer), 0).rg;
    vec2 z = mix(mix(sw, se, t.x), mix(nw, ne, t.x), t.y);
    return mix(z.x, z.y, s.alpha);
}
#endif
