// chart_cube.glsl - the six faces of a cube (common/chart/cube.c), seen from the viewer.
//
// A place is the direction of c + A x + B y, A = tan a, B = tan b, where a and b go evenly from -pi/4 to pi/4 along the face.
//
// FACE(k)          x, y: rests of the viewer's place; z, w: its A and B
// FACE(k) + 1      c in the eye's axes; w: 1 where the viewer is on the face or next to it
// FACE(k) + 2, 3   x and y in the eye's axes; w: cosines of the viewer's a and b
// whole[PLACES(k)] sample next to the viewer's place

// Normal at a place less the viewer's: east, north, up. Next to the viewer without cancellation; elsewhere it is long.
vec3 chart_direction(int chart, ivec2 at)
{
    vec4 rest = surface[FACE(chart)], c = surface[FACE(chart) + 1], x = surface[FACE(chart) + 2], y = surface[FACE(chart) + 3];
    float step_ = 1.57079633 * surface[0].z;
    vec2 a = sine_cosine(float(2 * at.x - whole[0].x) * (0.5 * step_)), b = sine_cosine(float(2 * at.y - whole[0].x) * (0.5 * step_));
    vec3 d;
    if (c.w > 0.0) {
        precise vec2 way = (vec2(at - whole[PLACES(chart)].xy) - rest.xy) * step_;
        float da = sine_cosine(way.x).x / (a.y * x.w), db = sine_cosine(way.y).x / (b.y * y.w);
        vec2 q = rest.zw + vec2(da, db);
        float l2 = 1.0 + dot(q, q), v2 = 1.0 + dot(rest.zw, rest.zw), l = sqrt(l2), v = sqrt(v2);
        float shorter = -(da * (q.x + rest.z) + db * (q.y + rest.w)) / (l * v * (l + v)); // 1 / l - 1 / v
        d = (da * x.xyz + db * y.xyz) / l + (c.xyz + rest.z * x.xyz + rest.w * y.xyz) * shorter;
    } else {
        vec2 q = vec2(a.x / a.y, b.x / b.y);
        d = (c.xyz + q.x * x.xyz + q.y * y.xyz) * inversesqrt(1.0 + dot(q, q)) - vec3(0.0, 0.0, 1.0);
    }
    return vec3(d.xy, -0.5 * dot(d, d));
}

// A slope along the ground, by radians that normals turn, from what the height changes with the chart's coordinates, at
// unit normal n.
vec3 chart_slope(int chart, vec2 place, vec2 change, vec3 n, vec3 east, vec3 north, float sine)
{
    vec3 c = surface[FACE(chart) + 1].xyz, x = surface[FACE(chart) + 2].xyz, y = surface[FACE(chart) + 3].xyz;
    float l = 1.0 / max(dot(n, c), 0.3);
    vec2 q = l * vec2(dot(n, x), dot(n, y));
    vec2 g = change * l / (1.57079633 * (1.0 + q * q));
    return g.x * x + g.y * y - dot(g, q) * c;
}

// How chart coordinates change with a small way d on the unit sphere.
vec2 chart_step(int chart, vec2 place, vec3 d, vec3 n, vec3 east, vec3 north, float sine)
{
    vec3 c = surface[FACE(chart) + 1].xyz, x = surface[FACE(chart) + 2].xyz, y = surface[FACE(chart) + 3].xyz;
    float l = 1.0 / max(dot(n, c), 0.3);
    vec2 q = l * vec2(dot(n, x), dot(n, y));
    return l * (vec2(dot(d, x), dot(d, y)) - q * dot(d, c)) / (1.57079633 * (1.0 + q * q));
}
