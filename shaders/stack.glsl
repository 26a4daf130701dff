// stack.glsl - a stack of layers, the levels of one field in a window each: which of them a place reads, and how.
//
// A layer's shift is its number of levels from the finest; a place is relative to the viewer's, in units of its chart.
//
// layer[3 l]      of layer l: viewer's place from the nearest sample; samples per unit of the chart
// layer[3 l + 1]  that sample, modulo twice the window's array; last samples of the lattice, relative to it
// layer[3 l + 2]  what is held, relative to it: first x, y, last x, y
struct Stack {
    int base;             // layer of shift 0
    int finest, coarsest; // shifts of what there is
    float passage;        // to the coarser level at the sides of windows, per sample
};

struct Spot {
    int layer;
    float alpha; // 0: what the layer has, 1: what the coarser one has there
    vec2 at;     // samples from the viewer's nearest
};

// Samples that a place brought to the side of a map may lie beyond it by rounding.
const float ROUNDING = 1.0 / 1024.0;

// The wanted level where it is held, else the next coarser one that is. False where there is none.
bool find_spot(Stack stack, vec2 place, float shift, out Spot spot)
{
    int k = clamp(int(shift), stack.finest, stack.coarsest);
    spot.alpha = clamp(shift - float(k), 0.0, 1.0);
    for (; k <= stack.coarsest; k++, spot.alpha = 0.0) {
        spot.layer = stack.base - k;
        vec4 l = layer[3 * spot.layer], held = layer[3 * spot.layer + 2];
        spot.at = l.xy + place * l.zw;
        vec2 inside = min(spot.at - held.xy, held.zw - spot.at);
        float edge = min(inside.x, inside.y);
        if (edge < -ROUNDING)
            continue;
        spot.at = clamp(spot.at, held.xy, held.zw);
        spot.alpha = k < stack.coarsest ? max(spot.alpha, min(1.0 - edge * stack.passage, 1.0)) : 0.0;
        return true;
    }
    return false;
}

// Cell that a spot is in, by its first sample, and where in it.
vec2 cell_of(Spot spot, out vec2 t)
{
    vec2 last = layer[3 * spot.layer + 1].zw, cell = max(min(floor(spot.at), last - 1.0), layer[3 * spot.layer + 2].xy);
    t = min(spot.at - cell, min(vec2(1.0), last - cell));
    return cell;
}

// Texel of a sample.
ivec3 texel_of(int l, ivec2 at)
{
    return ivec3((ivec2(layer[3 * l + 1].xy) + at) & WINDOW_MASK, l);
}
