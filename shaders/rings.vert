// rings.vert - a vertex of concentric rings: its height from the charts, its place relative to the eye.
//
// Heights are differences to the ground below the viewer from the first subtraction on, and around the viewer to the
// surface of the cell that it is in, so that centimetres next to the eye are exact on a planet.
layout(location = 0) in vec4 in_vertex; // s_x, s_y, h, w
INTERPOLATED out vec3 v_direction; // (s_x, s_y, h)
INTERPOLATED out vec2 v_terrain;   // metres above SEA_LEVEL, ring coordinate
#ifdef IMAGERY
INTERPOLATED out float v_above; // metres above the eye
#endif

// Height on a chart above the chart's height below the viewer.
bool chart_height(int chart, vec3 s, float w, float shift, out float height)
{
    float share;
    vec2 place = map_chart(chart, s, w, share);
    Spot spot;
    if (share <= 0.0 || !find_spot(stack_of(chart), place, shift, spot))
        return false;
    height = spot_rise(chart, spot, place);
    if (share < 1.0) {
        float outside = surface[2].w - surface[4 + chart].z;
        height = outside + share * (height - outside);
    }
    return true;
}

// Height above the ground below the viewer by a level of detail.
float height_by(vec3 s, float w, float shift)
{
    float height = 0.0;
    vec2 caps = cap_weights(s);
    vec3 weight = vec3(1.0 - caps.x - caps.y, caps);
    // What charts give below the viewer adds up to nothing with their shares there: only changes of shares count.
    vec2 change = cap_changes(s);
    vec3 more = vec3(-change.x - change.y, change);
    int cap = caps.x > 0.0 ? 1 : 2;
    float polar = caps.x + caps.y;
    int chart = weight.x > 0.0 ? 0 : cap;
    do { // as in rings.frag
        float z = 0.0;
        if (!chart_height(chart, s, w, shift, z))
            z = surface[2].w - surface[4 + chart].z;
        height += weight[chart] * z;
        chart = chart == 0 && polar > 0.0 ? cap : 3;
    } while (chart < 3);
    height += dot(more, vec3(surface[4].z, surface[5].z, surface[6].z));
    return height;
}

// Relative to the eye.
vec3 position_of(vec3 s, float height)
{
    return body_place(vec3(s.y, -s.x, -s.z), height, height - surface[1].y);
}

#ifdef THROTTLED
// Of 0 .. last the stage that leaves it out (tc_rings_stage_of()); 2: none.
int stage_of(int at, int last)
{
    int stage = (at & 1) != 0 ? 0 : (at & 2) != 0 ? 1 : 2;
    return at + (1 << stage) <= last ? stage : 2;
}

// A direction as far inwards and around as these angles say, both small. Sines and cosines are those of their series:
// drivers' may be off by more than what steps next to the viewer are.
vec3 turned(vec3 s, float inwards, float around)
{
    float a = inwards * inwards, b = around * around;
    float sa = inwards * (1.0 - a / 6.0 * (1.0 - a / 20.0 * (1.0 - a / 42.0)));
    float ca = 0.5 * a * (1.0 - a / 12.0 * (1.0 - a / 30.0 * (1.0 - a / 56.0))); // 1 - cosine
    float sb = around * (1.0 - b / 6.0 * (1.0 - b / 20.0 * (1.0 - b / 42.0)));
    float cb = 1.0 - 0.5 * b * (1.0 - b / 12.0 * (1.0 - b / 30.0));
    float away = length(s.xy);
    vec2 xy = s.xy * ((1.0 - ca) - (1.0 - s.z) / away * sa);
    return vec3(xy.x * cb - xy.y * sb, xy.y * cb + xy.x * sb, s.z * (1.0 - ca) + ca - away * sa);
}

// A vertex, and as far as its stage has passed over, the middle between its two neighbours, of the rows or columns beside
// its own or of both, as the next stage reads them. A vertex that is not left out passes over to what the next stage
// reads there: whole levels are mixed, since what a level has of the coarser one is not quite what that has.
vec3 surface_vertex()
{
    bool disc = gl_VertexID >= whole[1].w;
    int columns = whole[2].w >> 16, last = disc ? whole[2].w >> 8 & 255 : whole[2].w & 255, stride = whole[0].w;
    float w = in_vertex.w, ring = disc ? w : floor(w);
    // Without dividing integers, which processors are slow at.
    int number = disc ? gl_VertexID - whole[1].w : gl_VertexID;
    int row = int(disc ? (float(number) + 0.5) / float(stride) : (w - ring) * float(last) + 0.5);
    int column = number - (disc ? row : int(ring) * last + row) * stride;
    column -= columns * int((float(column) + 0.5) / float(columns));
    int row_stage = stage_of(row, last), column_stage = stage_of(column, columns), stage = min(row_stage, column_stage);
    vec2 far = vec2(passed(0, w), passed(1, w));
    bool moves = stage < 2 && far[stage & 1] > 0.0;
    int level = moves ? stage : far.x >= 1.0 ? far.y >= 1.0 ? 2 : 1 : 0;
    float share = level < 2 ? far[level & 1] : 0.0;
    if (!moves && shift_of(w, float(level + 1)) <= 0.0) // either way the finest
        share = 0.0;
    float apart = float(1 << stage), rows = row_stage == stage ? apart : 0.0;
    float around = column_stage == stage ? apart * surface[13].w : 0.0;
    float inwards = rows * ldexp(3.14159265, -int(ring)) / float(last) * (disc ? 1.0 : 0.5);
    vec3 direction = vec3(0.0), position = vec3(0.0);
    vec2 terrain = vec2(0.0);
#ifdef IMAGERY
    float above = 0.0;
#endif
    // As in rings.frag: it ends early where all of it, or nothing, is left of the vertex itself.
    int k = share < 1.0 ? 0 : 1, end = share > 0.0 ? moves ? 3 : 2 : 1;
    do {
        float way = k == 2 ? -1.0 : 1.0, part = k == 0 ? 1.0 - share : moves ? 0.5 * share : share, its_w = w;
        vec3 s = in_vertex.xyz;
        if (k > 0 && moves) {
            s = turned(s, way * inwards, -way * around);
            its_w += disc ? 0.0 : way * rows / float(last);
        }
        float height = height_by(s, its_w, shift_of(its_w, float(k > 0 ? level + 1 : level)));
        direction += part * s;
        terrain += part * vec2((height + surface[1].z) - SEA_LEVEL, its_w);
        position += part * position_of(s, height);
#ifdef IMAGERY
        above += part * (height - surface[1].y);
#endif
    } while (++k < end);
    v_direction = direction;
    v_terrain = terrain;
#ifdef IMAGERY
    v_above = above;
#endif
    return position;
}
#else
vec3 surface_vertex()
{
    vec3 s = in_vertex.xyz;
    float height = height_by(s, in_vertex.w, shift_of(in_vertex.w, 0.0));
    v_direction = s;
    v_terrain = vec2((height + surface[1].z) - SEA_LEVEL, in_vertex.w);
#ifdef IMAGERY
    v_above = height - surface[1].y;
#endif
    return position_of(s, height);
}
#endif
