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
    vec4 place, held; // the layer's first and third vector
    vec2 at;     // samples from the viewer's nearest
};

// Samples that a place brought to the side of a map may lie beyond it by rounding.
const float ROUNDING = 1.0 / 1024.0;

// The wanted level where it is held, else the next coarser one that is. False where there is none.
//
// Loops are tested at their ends, here and wherever they are run once as a rule: a renderer that does not branch runs one
// that is tested at its beginning once more, for nobody.
bool find_spot(Stack stack, vec2 place, float shift, out Spot spot)
{
    int wanted = clamp(int(shift), stack.finest, stack.coarsest), k = wanted - 1;
    float edge;
    do {
        k++;
        spot.layer = stack.base - k;
        spot.place = layer[3 * spot.layer];
        spot.held = layer[3 * spot.layer + 2];
        spot.at = spot.place.xy + place * spot.place.zw;
        vec2 inside = min(spot.at - spot.held.xy, spot.held.zw - spot.at);
        edge = min(inside.x, inside.y);
    } while (edge < -ROUNDING && k < stack.coarsest);
    spot.at = clamp(spot.at, spot.held.xy, spot.held.zw);
    spot.alpha = k == wanted ? clamp(shift - float(k), 0.0, 1.0) : 0.0;
    spot.alpha = k < stack.coarsest ? max(spot.alpha, min(1.0 - edge * stack.passage, 1.0)) : 0.0;
    return edge >= -ROUNDING;
}

// Cell that a spot is in, by its first sample, and where in it.
vec2 cell_of(Spot spot, out vec2 t)
{
    vec2 last = layer[3 * spot.layer + 1].zw, cell = max(min(floor(spot.at), last - 1.0), spot.held.xy);
    t = min(spot.at - cell, min(vec2(1.0), last - cell));
    return cell;
}

// Texel of a sample.
ivec3 texel_of(int l, ivec2 at)
{
    return ivec3((ivec2(layer[3 * l + 1].xy) + at) & WINDOW_MASK, l);
}
