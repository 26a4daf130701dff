// rings.frag - what renderer.frag asks of spherical/rings.c.
//
// Colours and normals have their own, finer level of detail, and their place on the charts is worked out for each
// fragment: nothing is interpolated across a pole or the meridian behind it.
INTERPOLATED in vec3 v_direction; // rings.vert
INTERPOLATED in vec2 v_terrain;
layout(binding = 0) uniform sampler2DArray heights_map; // (z, z_c), metres above z_base
#ifdef LIT
layout(binding = 2) uniform sampler2DArray normals_map;
#endif

float fragment_shift()
{
    float shift = max(0.0, surface[1].w - v_terrain.y - surface[3].z);
    return surface[10].w > 0.0 ? floor(shift) : shift;
}

float surface_level()
{
    return max(floor(min(v_terrain.y, surface[1].w)), 0.0);
}

#ifdef HOLES
layout(binding = 3) uniform sampler2DArray voids_map;

bool surface_void()
{
    vec2 caps = cap_weights(v_direction), where;
    int chart = caps.x > 0.5 ? 1 : caps.y > 0.5 ? 2 : 0, at;
    float alpha, share;
    vec2 place = map_chart(chart, v_direction, 0.0, share);
    if (share < 1.0 || !find_layer(chart, place, fragment_shift(), at, alpha, where))
        return false;
    ivec2 texel = ivec2(layer[3 * at + 1].xy) + ivec2(floor(where + 0.5));
    return texelFetch(voids_map, ivec3(texel & WINDOW_MASK, at), 0).r > 0.0;
}
#endif

// Set by surface_height(): 0 beside a part of a globe; up and slopes in the frame of the viewer's meridian.
float fragment_known;
vec3 fragment_up, fragment_slope;

// Height, and slopes along the chart's axes per unit of its own lengths.
void look(int chart, out float height, out vec2 slopes)
{
    vec2 where, t;
    int at;
    float alpha, share;
    vec2 place = map_chart(chart, v_direction, 0.0, share);
    height = v_terrain.x;
    slopes = vec2(0.0);
    fragment_known = share < 1.0 ? 0.0 : 1.0;
    if (share < 1.0 || !find_layer(chart, place, fragment_shift(), at, alpha, where))
        return;
    ivec2 corner = ivec2(layer[3 * at + 1].xy) + ivec2(cell_of(at, where, t));
    vec2 south = mix(texelFetch(heights_map, ivec3(corner & WINDOW_MASK, at), 0).rg,
                     texelFetch(heights_map, ivec3((corner + ivec2(1, 0)) & WINDOW_MASK, at), 0).rg, t.x);
    vec2 north = mix(texelFetch(heights_map, ivec3((corner + ivec2(0, 1)) & WINDOW_MASK, at), 0).rg,
                     texelFetch(heights_map, ivec3((corner + ivec2(1, 1)) & WINDOW_MASK, at), 0).rg, t.x);
    vec2 z = mix(south, north, t.y);
    height = mix(z.x, z.y, alpha);
#ifdef LIT
    // In steps of a texel's 512th the sum is exact, whichever number of its column the viewer has.
    vec2 texel = (2.0 * (layer[3 * at + 1].xy + round(where * 1024.0) / 1024.0) + 0.5) * (0.5 / float(WINDOW_MASK + 1));
    vec4 n = textureLod(normals_map, vec3(texel, float(at)), 0.0);
    vec2 xy = mix(n.xy, n.zw, alpha);
    // Slopes were kept steeper where samples are further apart than that (tc_ground_options.relief).
    vec2 samples = layer[3 * at].zw;
    float spacing = (surface[1].x - surface[1].z) * inversesqrt(samples.x * samples.y);
    slopes = -xy * inversesqrt(max(1.0 - dot(xy, xy), 0.01)) * min(1.0, sqrt(RELIEF / spacing));
#endif
}

// Charts are gone through in a loop, which is run as often as one of the fragments next to each other needs it; conditions
// one after the other are all run by a renderer that does not branch.
float surface_height()
{
    vec3 s = v_direction;
    float ct = surface[0].x, st = surface[0].y, c = 1.0 - s.z, height = 0.0;
    vec3 p = normalize(vec3(ct * s.x + st * c, s.y, ct * c - st * s.x)), slope = vec3(0.0);
    vec2 caps = cap_weights(s);
    float rest = 1.0 - caps.x - caps.y;
    int cap = caps.x > 0.0 ? 1 : 2;
    for (int chart = rest > 0.0 ? 0 : cap; chart < 3; chart = chart == 0 && rest < 1.0 ? cap : 3) {
        float z;
        vec2 g;
        look(chart, z, g);
        float share = chart == 0 ? rest : 1.0 - rest;
        height += share * z;
        if (chart == 0) {
            float rho = sqrt(p.x * p.x + p.y * p.y);
            vec2 meridian = p.xy / max(rho, 1e-4);
            slope += share * (g.x / max(rho, 0.01) * vec3(-meridian.y, meridian.x, 0.0) + g.y * vec3(-p.z * meridian, rho));
        } else {
            float side = chart == 1 ? 1.0 : -1.0, up = 1.0 + side * p.z;
            g = vec2(surface[0].z * g.x + surface[0].w * g.y, surface[0].z * g.y - surface[0].w * g.x) * (2.0 / up);
            // Chart axes carried along meridians from the pole.
            float along = dot(p.xy, g);
            slope += share * vec3(g - p.xy * along / up, -side * along);
        }
    }
    fragment_up = p;
    fragment_slope = slope;
    return height;
}

// 1 where there is no terrain, only the sphere.
float surface_unknown()
{
    return 1.0 - fragment_known;
}

#ifdef LIT
// Normal and up in the eye's axes: east, north, up.
vec3 surface_normal(out vec3 up)
{
    float ct = surface[0].x, st = surface[0].y;
    vec3 p = fragment_up, n = p - fragment_slope;
    up = vec3(p.y, st * p.z - ct * p.x, st * p.x + ct * p.z);
    return normalize(vec3(n.y, st * n.z - ct * n.x, st * n.x + ct * n.z));
}

// Height from which snow stays: about that of the Earth's mountains at the equator, the sea near the poles.
float surface_snow()
{
    return 5600.0 * (1.0 - pow(abs(fragment_up.z) / 0.965, 3.0));
}
#endif

#ifdef HAZE
// The way through air that thins out with height: to the terrain, or from where the air begins.
float surface_haze()
{
    float radius = surface[1].x - surface[1].z, thickness = 0.00125 * radius;
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    vec3 view = normalize(pixel[2].xyz + (gl_FragCoord.x * lens.x / lens.z - 1.0) * pixel[0].xyz +
                          (gl_FragCoord.y * lens.y / lens.w - 1.0) * pixel[1].xyz);
    float away = haze.w / NEARNESS * sqrt(1.0 + dot(across, across));
    vec3 s = v_direction, up = vec3(s.y, -s.x, 1.0 - s.z);
    float steep = max(-dot(view, up), 0.0), path = min(away, thickness / (steep + 0.035));
    float d = path / (0.018 * radius) * exp(-max(v_terrain.x - heights.x, 0.0) / thickness);
    return d * d;
}
#endif
