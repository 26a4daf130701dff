// rings.glsl - the map transform of spherical/rings.c: from a direction around the viewer to the charts of a planet.
//
// Directions are (s_x, s_y, h): south, east, 1 - up in the viewer's frame. Everything is relative to the viewer and
// without cancellation (the design, section 7), so that floats do. spherical/rings_map.c is the same in double.
//
// surface[0]      cos and sin of the viewer's colatitude, cos and sin of its longitude
// surface[1]      radius at the ground below the viewer, eye above that ground, that ground, S_0 + 1
// surface[2]      share of the north cap at the viewer and of the south cap, not cut to 0 .. 1; their slope along the
//                 axis; height where no chart is, above the ground
// surface[3]      colatitude of the viewer; passage at the sides of windows, per sample; levels by which shading is finer
//                 than geometry; 1: a part of a globe
// surface[4 + k]  chart k: reference height in two parts, that above the ground
// surface[7 + k]  chart k: slopes of the cell that the viewer is in
// surface[10].w   1 where levels meet abruptly
// surface[13]     of throttled frames: where the first and the second stage begin to leave vertices out, ring coordinates;
//                 how far any may have passed over; step around, radians
// surface[10 + k] cap k: coefficients of s_x, h, 1; 1 - its share at the viewer; of a part of a globe surface[11]: its
//                 sides relative to the viewer; surface[12]: 1 where it wraps, ends at the south, at the north pole
// whole[0][k]     chart k: layer of shift 0; whole[2][k]: finest shift + 64 coarsest
// whole[1][k]     chart k: layer of the cell that the viewer is in; -1: none
// whole[0].w      vertices from row to row; whole[1].w: first one of the disc; whole[2].w: rows of a ring + 2^8 rows of the
//                 disc + 2^16 columns of a sector
// layer[...]      stack.glsl's
layout(binding = 0) uniform sampler2DArray heights_map; // (z, z_c), metres above z_base

// atan2 with a relative error of some 2e-7: the driver's may be off by 1e-5 (after Cephes' atanf).
float exact_atan(float y, float x)
{
    float a = abs(y), b = abs(x), lo = min(a, b), hi = max(a, b);
    float t = hi > 0.0 ? lo / hi : 0.0;
    bool far = t > 0.41421356;
    float u = far ? (lo - hi) / (lo + hi) : t, q = u * u;
    float r = (((8.05374449538e-2 * q - 1.38776856032e-1) * q + 1.99777106478e-1) * q - 3.33329491539e-1) * q * u + u;
    r += far ? 0.78539816 : 0.0;
    r = a > b ? 1.57079633 - r : r;
    r = x < 0.0 ? 3.14159265 - r : r;
    return y < 0.0 ? -r : r;
}

// z in the frame of the viewer's meridian, less the viewer's.
float rise(vec3 s)
{
    return -surface[0].y * s.x - surface[0].x * s.z;
}

// Shares of the caps.
vec2 cap_weights(vec3 s)
{
    float d = rise(s) * surface[2].z;
    return clamp(surface[2].xy + vec2(d, -d), 0.0, 1.0);
}

// How much more they are than at the viewer.
vec2 cap_changes(vec3 s)
{
    float d = rise(s) * surface[2].z;
    vec2 lo = -surface[2].xy, hi = vec2(surface[11].w, surface[12].w);
    return max(min(vec2(d, -d), hi), lo) - max(min(vec2(0.0), hi), lo);
}

#ifndef CH06
// Longitude and latitude relative to the viewer's.
vec2 map_lonlat(vec3 s, float w)
{
    float ct = surface[0].x, st = surface[0].y, c = 1.0 - s.z;
    float px = ct * s.x + st * c, pz = ct * c - st * s.x, rho = sqrt(px * px + s.y * s.y);
    float y2 = s.y * s.y, sine = px >= 0.0 ? s.x + (y2 > 0.0 ? ct * y2 / (rho + px) : 0.0) : rho * ct - pz * st;
    return vec2(exact_atan(s.y, px), -exact_atan(sine, rho * st + pz * ct));
}

// Place on a cap relative to the viewer's, or to the pole.
vec2 map_cap(int chart, vec3 s, float w)
{
    vec4 k = chart == 1 ? surface[11] : surface[12]; // no index: it would be looked up for each one alone
    float d = rise(s), up = chart == 1 ? surface[0].x + d : -surface[0].x - d;
    vec2 p = vec2(k.x * s.x + k.y * s.z + k.z, s.y) * (2.0 / (1.0 + up));
    return vec2(surface[0].z * p.x - surface[0].w * p.y, surface[0].w * p.x + surface[0].z * p.y);
}
#endif

// Brings a place on chart 0 to the side of a part of a globe; how far it was beyond it, radians.
vec2 bring_inside(inout vec2 place)
{
    vec4 side = surface[11];
    bool wraps = surface[12].x > 0.0;
    if (!wraps)
        place.x += 6.2831853 * round((0.5 * (side.x + side.z) - place.x) / 6.2831853);
    vec2 inside = clamp(place, side.xy, side.zw);
    if (wraps)
        inside.x = place.x;
    vec2 beyond = (place - inside) * vec2(surface[0].y, 1.0);
    if ((beyond.y > 0.0 ? surface[12].z : surface[12].y) > 0.0)
        beyond.y = 0.0;
    place = inside;
    return beyond;
}

// Place on a chart relative to the viewer's. share: of the height there; beside a part of a globe, where the place is
// brought to its side, less than 1, and 0 from about a cell of the mesh on.
vec2 map_chart(int chart, vec3 s, float w, out float share)
{
    share = 1.0;
    if (chart > 0)
        return map_cap(chart, s, w);
    vec2 place = map_lonlat(s, w);
    if (surface[3].w > 0.0) {
        vec2 beyond = bring_inside(place);
        share = beyond == vec2(0.0) ? 1.0 : max(0.0, 1.0 - length(beyond) / (APRON * sqrt(2.0 * s.z)));
    }
    return place;
}

// The levels of a chart that there are.
Stack stack_of(int chart)
{
    int range = whole[2][chart];
    return Stack(whole[0][chart], range & 63, range >> 6, surface[3].y);
}

#ifdef THROTTLED
// How far vertices that a stage leaves out have passed over to the middle of their neighbours.
float passed(int stage, float w)
{
    float past = w - surface[13][stage];
    return surface[10].w > 0.0 ? (past >= 1.0 ? 1.0 : 0.0) : clamp(past, 0.0, 1.0) * surface[13].z;
}
#endif

// Level of detail for ring coordinate w: coarser levels from the finest, and so many more.
float shift_of(float w, float coarser)
{
    float shift = max(0.0, surface[1].w - w + coarser);
    return surface[10].w > 0.0 ? floor(shift) : shift;
}

// Height at a spot of a chart above the chart's height below the viewer. Next to the viewer it keeps the digits that
// the height itself has not.
float spot_rise(int chart, Spot spot, vec2 place)
{
    vec4 l = spot.place, reference = surface[4 + chart], slope = surface[7 + chart];
    vec2 t, cell = cell_of(spot, t);
    bool near = spot.layer == whole[1][chart];
    vec4 z;
    for (int k = 0; k < 4; k++) {
        ivec2 corner = ivec2(k & 1, k >> 1);
        precise vec2 q = texelFetch(heights_map, texel_of(spot.layer, ivec2(cell) + corner), 0).rg;
        q = (q - reference.x) - reference.y;
        vec2 d = cell + vec2(corner) - l.xy;
        // Bilinear interpolation gives the bilinear surface of the viewer's cell back: it is taken off the corners
        // and added at the place, exactly nothing being left at the corners of that cell.
        float surface_there = near ? d.x * slope.x + d.y * slope.y + d.x * d.y * slope.z : 0.0;
        float left = mix(q.x, q.y, spot.alpha) - surface_there;
        vec2 from_own = cell + vec2(corner) - floor(l.xy);
        bool own = near && spot.alpha == 0.0 && all(lessThanEqual(abs(from_own - 0.5), vec2(0.75)));
        z[k] = own ? 0.0 : left;
    }
    // Not 1 - t: beside the sample nearest to the viewer both shares keep all their digits, so that the edge between two
    // cells is where it is.
    precise vec2 u = max((cell + 1.0) - spot.at, max((cell + 1.0) - layer[3 * spot.layer + 1].zw, 0.0));
    float rise = (z.x * u.x + z.y * t.x) * u.y + (z.z * u.x + z.w * t.x) * t.y;
    if (near) {
        vec2 d = place * l.zw;
        rise += d.x * slope.x + d.y * slope.y + d.x * d.y * slope.z;
    }
    return rise;
}
