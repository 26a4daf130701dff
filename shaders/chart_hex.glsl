// chart_hex.glsl - four sheared charts of an octahedron (common/chart/hex.c), seen from the viewer.
//
// Rows s = i + j from the nearer pole lie along parallels, with t = s / N and |sine of latitude| = 1 - t^2; the longitude goes
// evenly along a row. North and south of the equator the formulas differ, and so does the viewer's place by them.
//
// FACE(k)          rests of the viewer's place by the northern and by the southern formulas: i, j, i, j
// FACE(k) + 1      x: share of a row from the chart's first meridian to the viewer's; y: rows of the viewer north of the
//                  equator, over N; z: from the nearer pole
// whole[PLACES(k)] samples next to those places

// Normal at a place less the viewer's: east, north, up. Without cancellation: off by at most some 2e-7 of its length.
vec3 chart_direction(int chart, ivec2 at)
{
    int cells = whole[0].x, rows = at.x + at.y;
    bool north = rows <= cells;
    ivec4 nearest = whole[PLACES(chart)];
    vec4 rest = surface[FACE(chart)];
    float share = surface[FACE(chart) + 1].x;
    ivec2 from = at - (north ? nearest.xy : nearest.zw);
    vec2 left = north ? rest.xy : rest.zw;
    precise vec2 way = vec2(from) - left;
    precise float south = float(from.x + from.y) - (left.x + left.y); // rows
    float z_v = surface[0].x, rho_v = surface[0].y, to_share = surface[0].z, e_v = surface[FACE(chart) + 1].y, t_v = surface[FACE(chart) + 1].z;

    float from_pole = float(north ? rows : 2 * cells - rows), along = float(north ? at.y : cells - at.x);
    // Shares of a row from the viewer's meridian: next to the viewer by the difference of places, else by that of shares.
    float turn = 0.0;
    if (from_pole > 0.0)
        turn = abs(south) < 0.5 * from_pole ? (north ? way.y - share * south : share * south - way.x) / from_pole
                                            : along / from_pole - share;
    vec2 half_turn = sine_cosine(0.78539816 * turn);
    float t = from_pole * to_share, rho = t * sqrt(2.0 - t * t);
    float e = float(cells - rows) * to_share, z = e * (2.0 - abs(e));
    float dz = e * e_v >= 0.0 ? -south * to_share * (t + t_v) : z - z_v;
    float drho = -dz * (z + z_v) / max(rho + rho_v, 1e-30);
    // In the viewer's meridian plane, and across.
    float out_ = drho - 2.0 * rho * half_turn.x * half_turn.x, east = 2.0 * rho * half_turn.x * half_turn.y;
    return vec3(east, rho_v * dz - z_v * out_, -0.5 * (east * east + out_ * out_ + dz * dz));
}

// How far a step along x goes west, over how far one of both goes around: y's goes east by the rest.
float before_place(vec2 place)
{
    bool northern = place.x + place.y <= 1.0;
    float t = northern ? place.x + place.y : 2.0 - place.x - place.y;
    float share = clamp((northern ? place.y : 1.0 - place.x) / max(t, 1e-7), 0.0, 1.0);
    return northern ? share : 1.0 - share;
}

// A slope along the ground, by radians that normals turn, from what the height changes with the chart's coordinates: at
// unit normal n, whose axes east and north of there are in the eye's. place: chart coordinates.
vec3 chart_slope(int chart, vec2 place, vec2 change, vec3 n, vec3 east, vec3 north, float sine)
{
    float w = sqrt(1.0 + abs(sine)); // sqrt(2 - t^2)
    float to_east = (change.y - change.x) / (1.57079633 * w);
    float before = before_place(place);
    float to_north = -0.5 * w * (change.x + before * 1.57079633 * w * to_east);
    return to_east * east + to_north * north;
}

// How chart coordinates change with a small way d on the unit sphere.
vec2 chart_step(int chart, vec2 place, vec3 d, vec3 n, vec3 east, vec3 north, float sine)
{
    float w = sqrt(1.0 + abs(sine));
    float before = before_place(place);
    // d = x (-2 / w north - before pi/2 w east) + y (-2 / w north + (1 - before) pi/2 w east)
    float sum = -0.5 * w * dot(d, north), difference = dot(d, east) / (1.57079633 * w);
    return vec2(sum * (1.0 - before) - difference, sum * before + difference);
}
