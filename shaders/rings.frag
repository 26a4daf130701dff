// rings.frag - what renderer.frag asks of spherical/rings.c.
INTERPOLATED in vec3 v_direction; // rings.vert
INTERPOLATED in vec2 v_terrain;
#ifdef LIT
layout(binding = 2) uniform sampler2DArray normals_map;
#endif

float surface_height()
{
    return v_terrain.x;
}

float surface_level()
{
    return max(surface[1].w - floor(v_terrain.y), 0.0);
}

#ifdef HOLES
layout(binding = 3) uniform sampler2DArray voids_map;

bool surface_void()
{
    vec2 caps = cap_weights(v_direction), where;
    int chart = caps.x > 0.5 ? 1 : caps.y > 0.5 ? 2 : 0, at;
    float alpha;
    if (!find_layer(chart, map_chart(chart, v_direction, 0.0), v_terrain.y, at, alpha, where))
        return false;
    ivec2 texel = ivec2(layer[3 * at + 1].xy) + ivec2(floor(where + 0.5));
    return texelFetch(voids_map, ivec3(texel & WINDOW_MASK, at), 0).r > 0.0;
}
#endif

#ifdef LIT
// Slopes along the chart's axes, per unit of its own lengths.
vec2 chart_slopes(int chart, vec2 place)
{
    vec2 where;
    int at;
    float alpha;
    if (!find_layer(chart, place, v_terrain.y, at, alpha, where))
        return vec2(0.0);
    vec2 texel = (2.0 * (layer[3 * at + 1].xy + where) + 0.5) * (0.5 / float(WINDOW_MASK + 1));
    vec4 n = textureLod(normals_map, vec3(texel, float(at)), 0.0);
    vec2 xy = mix(n.xy, n.zw, alpha);
    return -xy * inversesqrt(max(1.0 - dot(xy, xy), 0.01));
}

// Normal and up in the eye's axes: east, north, up.
vec3 surface_normal(out vec3 up)
{
    vec3 s = v_direction;
    float ct = surface[0].x, st = surface[0].y, c = 1.0 - s.z;
    // In the frame of the viewer's meridian.
    vec3 p = normalize(vec3(ct * s.x + st * c, s.y, ct * c - st * s.x)), slope = vec3(0.0);
    vec2 caps = cap_weights(s);
    float rho = sqrt(p.x * p.x + p.y * p.y);
    if (caps.x + caps.y < 1.0) {
        vec2 g = chart_slopes(0, map_lonlat(s, 0.0));
        vec2 meridian = p.xy / max(rho, 1e-4);
        g.x /= max(rho, 0.01);
        slope = (1.0 - caps.x - caps.y) * (g.x * vec3(-meridian.y, meridian.x, 0.0) +
                                           g.y * vec3(-p.z * meridian, rho));
    }
    if (caps.x + caps.y > 0.0) {
        float side = caps.x > 0.0 ? 1.0 : -1.0, z = side * p.z;
        int chart = caps.x > 0.0 ? 1 : 2;
        vec2 g = chart_slopes(chart, map_cap(chart, s, 0.0)) * (2.0 / (1.0 + z));
        g = vec2(surface[0].z * g.x + surface[0].w * g.y, surface[0].z * g.y - surface[0].w * g.x);
        // Chart axes carried along meridians from the pole.
        float along = dot(p.xy, g);
        slope += (caps.x + caps.y) * vec3(g - p.xy * along / (1.0 + z), -side * along);
    }
    vec3 n = p - slope;
    up = vec3(p.y, st * p.z - ct * p.x, st * p.x + ct * p.z);
    return normalize(vec3(n.y, st * n.z - ct * n.x, st * n.x + ct * n.z));
}
#endif

#ifdef HAZE
// The way through air that thins out with height: to the terrain, or from where the air begins.
float surface_haze()
{
    float radius = surface[1].x - surface[1].z, thickness = 0.00125 * radius;
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    vec3 view = normalize(ray[2].xyz + (gl_FragCoord.x * lens.x / lens.z - 1.0) * ray[0].xyz +
                          (gl_FragCoord.y * lens.y / lens.w - 1.0) * ray[1].xyz);
    float away = haze.w / gl_FragCoord.z * sqrt(1.0 + dot(across, across));
    vec3 s = v_direction, up = vec3(s.y, -s.x, 1.0 - s.z);
    float steep = max(-dot(view, up), 0.0), path = min(away, thickness / (steep + 0.035));
    float d = path / (0.018 * radius) * exp(-max(v_terrain.x - heights.x, 0.0) / thickness);
    return d * d;
}
#endif
