// rings.frag - the ground at a fragment, for spherical/rings.c (ground.glsl).
//
// Colours and normals have their own, finer level of detail, and their place on the charts is worked out for each
// fragment: nothing is interpolated across a pole or the meridian behind it.
INTERPOLATED in vec3 v_direction; // rings.vert
INTERPOLATED in vec2 v_terrain;
#ifdef IMAGERY
INTERPOLATED in float v_above;
#endif
const float EDGE_ON = 0.12; // radians of the globe in a pixel
#ifdef NORMALS
layout(binding = 2) uniform sampler2DArray normals_map;
#endif
#ifdef HOLES
layout(binding = 3) uniform sampler2DArray voids_map;
#endif

// Metres above z_base, as vertices have it.
float mesh_height()
{
    return v_terrain.x + SEA_LEVEL;
}

// Direction of the ground that is seen. Of faces that are edge on, at the globe's limb, a sample may lie outside by the
// rounding of its place, and what is interpolated many degrees beside them: there it is where the ray meets the body,
// or comes nearest to it.
vec3 direction_seen()
{
    vec3 s = v_direction;
    vec3 change = fwidth(s);
    vec3 up = body_met(view_ray()); // not only where it is called for: a renderer that does not branch computes it anyway
    return dot(change, change) < EDGE_ON * EDGE_ON ? s : vec3(-up.y, up.x, 1.0 - up.z);
}

float fragment_shift()
{
    float shift = max(0.0, surface[1].w - v_terrain.y - surface[3].z);
    return surface[10].w > 0.0 ? floor(shift) : shift;
}

#ifdef CONTOURS
// Lines are of the level whose samples are twice as far apart as a pixel is wide, whichever way: those of finer ones would
// fall to dashes. across: radians of the globe in a pixel.
float contour_shift(Stack stack, float across)
{
    vec4 coarsest = layer[3 * (stack.base - stack.coarsest)];
    return max(fragment_shift(), log2(across * coarsest.w) + float(stack.coarsest) + 1.0);
}
#endif

// What a chart has there.
struct Charted {
    float height; // metres above z_base
    bool known;   // false beside a part of a globe
#ifdef CONTOURS
    float rise; // above the chart's height below the viewer
#endif
#ifdef HOLES
    bool hole;
#endif
#ifdef IMAGERY
    vec2 place;
#endif
#ifdef NORMALS
    vec2 slope; // along the chart's axes per unit of its own lengths
#endif
};

#ifdef IMAGERY
// The ground's place, in the eye's axes.
vec3 from_eye(vec3 s)
{
    float radius = surface[1].x + surface[1].y + v_above;
    return vec3(radius * s.y, -radius * s.x, v_above - radius * s.z) + body_departure(vec3(s.y, -s.x, -s.z));
}

// A way there, metres in the eye's axes, as one of directions around p, in the frame of the viewer's meridian.
vec3 turned_by(vec3 p, vec3 v)
{
    float ct = surface[0].x, st = surface[0].y;
    vec3 d = vec3(st * v.z - ct * v.y, v.x, st * v.y + ct * v.z) / surface[1].x;
    return body_slope(p, d - p * dot(p, d));
}

// How a chart's place at direction p, in the frame of the viewer's meridian, changes with it by d.
vec2 chart_step(int chart, vec3 p, vec3 d)
{
    if (chart == 0) {
        float rho2 = max(p.x * p.x + p.y * p.y, 1e-8);
        return vec2((p.x * d.y - p.y * d.x) / rho2, d.z * inversesqrt(rho2));
    }
    float side = chart == 1 ? 1.0 : -1.0;
    vec2 q = (2.0 * d.xy - 2.0 * p.xy * (side * d.z / (1.0 + side * p.z))) / (1.0 + side * p.z);
    return vec2(surface[0].z * q.x - surface[0].w * q.y, surface[0].w * q.x + surface[0].z * q.y);
}
#endif

Charted look(int chart, vec3 s, float across)
{
    float share;
    vec2 place = map_chart(chart, s, 0.0, share), t;
    Charted c;
    c.height = mesh_height();
    c.known = share >= 1.0;
#ifdef IMAGERY
    c.place = place;
#endif
#ifdef CONTOURS
    c.rise = c.height - surface[1].z - surface[4 + chart].z;
#endif
#ifdef HOLES
    c.hole = false;
#endif
#ifdef NORMALS
    c.slope = vec2(0.0);
#endif
    Spot spot;
    if (!c.known || !find_spot(stack_of(chart), place, fragment_shift(), spot))
        return c;
#ifdef CONTOURS
    Spot even;
    if (!find_spot(stack_of(chart), place, contour_shift(stack_of(chart), across), even))
        even = spot;
    c.rise = spot_rise(chart, even, place);
#endif
    // The cell's corners: north-west, north-east, south-east, south-west.
    vec2 middle = layer[3 * spot.layer + 1].xy + cell_of(spot, t) + 1.0;
    vec3 corners = vec3(middle / float(WINDOW_MASK + 1), float(spot.layer));
    vec4 z = mix(textureGather(heights_map, corners, 0), textureGather(heights_map, corners, 1), spot.alpha);
    vec2 of_row = mix(z.wx, z.zy, t.x);
    c.height = mix(of_row.x, of_row.y, t.y);
#ifdef HOLES
    c.hole = texelFetch(voids_map, texel_of(spot.layer, ivec2(floor(spot.at + 0.5))), 0).r > 0.0;
#endif
#ifdef NORMALS
    // In steps of a texel's 512th the sum is exact, whichever number of its column the viewer has.
    vec2 from = layer[3 * spot.layer + 1].xy + round(spot.at * 1024.0) / 1024.0;
    vec4 n = textureLod(normals_map, vec3((2.0 * from + 0.5) * (0.5 / float(WINDOW_MASK + 1)), float(spot.layer)), 0.0);
    vec2 xy = mix(n.xy, n.zw, spot.alpha);
    // Slopes were kept steeper where samples are further apart than that (tc_ground_options.relief).
    vec2 samples = spot.place.zw;
    float spacing = (surface[1].x - surface[1].z) * inversesqrt(samples.x * samples.y);
    c.slope = -xy * inversesqrt(max(1.0 - dot(xy, xy), UPRIGHT)) * min(1.0, sqrt(RELIEF / spacing));
#endif
    return c;
}

#ifdef NORMALS
// A chart's slope at direction p, in p's frame: that of the viewer's meridian.
vec3 slope_at(vec3 p, int chart, vec2 g)
{
    if (chart == 0) {
        float rho2 = max(p.x * p.x + p.y * p.y, 1e-8), per_rho = inversesqrt(rho2);
        vec2 meridian = p.xy * per_rho;
        return g.x * min(per_rho, 100.0) * vec3(-meridian.y, meridian.x, 0.0) + g.y * vec3(-p.z * meridian, rho2 * per_rho);
    }
    float side = chart == 1 ? 1.0 : -1.0, up = 1.0 + side * p.z;
    g = vec2(surface[0].z * g.x + surface[0].w * g.y, surface[0].z * g.y - surface[0].w * g.x) * (2.0 / up);
    // Chart axes carried along meridians from the pole.
    float along = dot(p.xy, g);
    return vec3(g - p.xy * along / up, -side * along);
}

// East and north of a fall against a slope. At the pole any direction is south or north: this is none.
vec2 fall_of(vec3 p, vec3 slope)
{
    float rho = length(p.xy);
    return rho > 0.0 ? vec2(p.y * slope.x - p.x * slope.y, p.z * dot(p.xy, slope.xy) - rho * rho * slope.z) / rho
                     : vec2(0.0);
}
#endif

#if defined(NORMALS) || defined(IMAGERY)
// From the frame of the viewer's meridian to the eye's axes: east, north, up.
vec3 eye_axes(vec3 p)
{
    float ct = surface[0].x, st = surface[0].y;
    return vec3(p.y, st * p.z - ct * p.x, st * p.x + ct * p.z);
}
#endif

#ifdef PLAIN
// Beside a part of a globe: the body, at the height that it has there, as land or as a sea that deepens; between, the mesh
// comes down to it.
void show_plain(vec3 s, inout Ground g)
{
    float outside = surface[2].w + surface[1].z;
    g.height = max(mesh_height(), outside - around[1].w);
#ifdef WATER
    vec2 place = map_lonlat(s, 0.0), beyond = bring_inside(place), size = surface[11].zw - surface[11].xy;
    if (mesh_height() - heights.x <= heights.w)
        g.height = heights.x - around[1].w - 0.85 / heights.y * (1.0 - exp(-2.5 * length(beyond) / max(size.x, size.y)));
#endif
}
#endif

// Charts are gone through in a loop, which is run as often as one of the fragments next to each other needs it
// (stack.glsl); conditions one after the other are all run by a renderer that does not branch.
Ground surface_ground()
{
    vec3 s = direction_seen();
    float ct = surface[0].x, st = surface[0].y, c = 1.0 - s.z;
    vec3 p = vec3(ct * s.x + st * c, s.y, ct * c - st * s.x), slope = vec3(0.0);
    p *= max(1.5 - 0.5 * dot(p, p), 0.5); // a step of Newton's: what is interpolated is hardly shorter than 1
    vec2 caps = cap_weights(s);
    float rest = 1.0 - caps.x - caps.y;
    int cap = caps.x > 0.0 ? 1 : 2;
    bool known = true;
#ifdef IMAGERY
    vec2 places[3];
#endif
    float across = max(length(dFdx(s)), length(dFdy(s)));
    Ground g;
    g.height = 0.0;
#ifdef CONTOURS
    vec2 change = cap_changes(s);
    g.rise = dot(vec3(-change.x - change.y, change), vec3(surface[4].z, surface[5].z, surface[6].z)); // rings.vert
#endif
    int chart = rest > 0.0 ? 0 : cap;
    do {
        Charted there = look(chart, s, across);
        float share = chart == 0 ? rest : 1.0 - rest;
        g.height += share * there.height;
#ifdef CONTOURS
        g.rise += share * there.rise;
#endif
        known = there.known;
#ifdef IMAGERY
        places[chart] = there.place;
#endif
#ifdef HOLES
        if (chart == 0 ? rest >= 0.5 : rest < 0.5)
            g.hole = there.hole;
#endif
#ifdef NORMALS
        slope += share * slope_at(p, chart, there.slope);
#endif
        chart = chart == 0 && rest < 1.0 ? cap : 3;
    } while (chart < 3);
#ifdef FLOOD
    g.above_sea = known ? g.height - SEA_LEVEL : v_terrain.x;
#endif
#ifdef PLAIN
    g.colour = vec4(0.0);
    if (!known)
        show_plain(s, g);
#else
    g.colour = vec4(0.16, 0.165, 0.17, known ? 0.0 : 1.0); // where there is no terrain, only the body
#ifdef FLOOD
    g.above_sea = known ? g.above_sea : 2.0 * beyond.w; // which has no sea, either
#endif
#endif
#ifdef NORMALS
    g.up = eye_axes(p);
    slope = body_slope(p, slope);
    g.normal = normalize(eye_axes(p - slope));
    // Slopes are along the body, places along the ground.
    float radius = body_radius();
    g.fall = fall_of(p, slope) * (radius / (radius + g.height));
#endif
#ifdef ZONES
    g.sine = p.z;
#endif
#if defined(LIT) && defined(CLIMATE)
    g.day = smoothstep(-0.22, 0.3, dot(g.up, sun.xyz));
    g.snow_line = snow_line(p.z);
#endif
#ifdef IMAGERY
#ifdef NORMALS
    Footprint f = footprint_of(from_eye(s), g.normal);
#else
    Footprint f = footprint_of(from_eye(s), eye_axes(p));
#endif
    vec3 longer = turned_by(p, f.longer), shorter = turned_by(p, f.shorter);
    vec4 image = vec4(0.0);
    chart = rest > 0.0 ? 0 : cap;
    do {
        image += (chart == 0 ? rest : 1.0 - rest) * image_at(chart, places[chart], chart_step(chart, p, longer),
                                                             chart_step(chart, p, shorter));
        chart = chart == 0 && rest < 1.0 ? cap : 3;
    } while (chart < 3);
    if (known)
        g.colour = image_colour(image);
#endif
#ifdef LEVEL_COLOURS
    g.level = max(floor(min(v_terrain.y, surface[1].w)), 0.0);
#endif
    return g;
}

#ifdef CONTOURS
// The ground below the viewer.
float surface_datum()
{
    return -surface[1].y;
}
#endif

#ifdef HAZE
float surface_haze()
{
    vec3 s = direction_seen();
    return air_before(NEARNESS, vec3(s.y, -s.x, 1.0 - s.z), mesh_height());
}
#endif
