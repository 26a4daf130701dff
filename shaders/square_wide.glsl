// square_wide.glsl - before square.glsl where a terrain has 2^30 samples a side or more: places as pairs of integers,
// high * 65536 + low with -32768 <= low < 32768. Each place is one pair alone, so vertices that two levels share are
// bit-identical as they are with one integer; near the viewer high is 0 and nothing is rounded twice.
#define WIDE
const float HIGH = 65536.0;

void carry(inout ivec2 high, inout ivec2 low)
{
    ivec2 over = (low + 32768) >> 16;
    high += over;
    low -= over << 16;
}

// The nearer of the place and the terrain's end.
void cut_at_edge(inout ivec2 high, inout ivec2 low, ivec4 edge)
{
    bvec2 beyond = bvec2(high.x > edge.x || (high.x == edge.x && low.x > edge.z),
                         high.y > edge.y || (high.y == edge.y && low.y > edge.w));
    high = mix(high, edge.xy, beyond);
    low = mix(low, edge.zw, beyond);
}
