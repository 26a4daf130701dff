// rings.vert - a vertex of concentric rings: its height from the charts, its place relative to the eye.
//
// Heights are differences to the ground below the viewer from the first subtraction on, and around the viewer to the
// surface of the cell that it is in, so that centimetres next to the eye are exact on a planet.
layout(location = 0) in vec4 in_vertex; // s_x, s_y, h, w
INTERPOLATED out vec3 v_direction; // (s_x, s_y, h)
INTERPOLATED out vec2 v_terrain;   // metres above z_base, ring coordinate

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

vec3 surface_vertex()
{
    vec3 s = in_vertex.xyz;
    float w = in_vertex.w, shift = shift_of(w), height = 0.0;
    vec2 caps = cap_weights(s);
    vec3 weight = vec3(1.0 - caps.x - caps.y, caps);
    // What charts give below the viewer adds up to nothing with their shares there: only changes of shares count.
    vec2 change = cap_changes(s);
    vec3 more = vec3(-change.x - change.y, change);
    int cap = caps.x > 0.0 ? 1 : 2;
    // A loop, as in rings.frag.
    for (int chart = weight.x > 0.0 ? 0 : cap; chart < 3; chart = chart == 0 && weight[cap] > 0.0 ? cap : 3) {
        float z = 0.0;
        if (!chart_height(chart, s, w, shift, z))
            z = surface[2].w - surface[4 + chart].z;
        height += weight[chart] * z;
    }
    height += dot(more, vec3(surface[4].z, surface[5].z, surface[6].z));
    v_direction = s;
    v_terrain = vec2(surface[1].z + height, w);
    float radius = surface[1].x + height;
    return vec3(radius * s.y, -radius * s.x, (height - surface[1].y) - radius * s.z);
}
