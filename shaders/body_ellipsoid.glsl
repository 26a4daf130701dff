// body_ellipsoid.glsl - the ellipsoid that a globe is, seen from the eye (common/chart/ellipsoid.c); its functions are
// those of body_sphere.glsl.
//
// body[0]  xyz: k, to the north pole in the eye's axes; w: e^2
// body[1]  x: radius of curvature of the parallel at the viewer and the reference height; y: eye above that; z: that
//          height; w: W = sqrt(1 - e^2 sine^2) of the viewer's latitude
// body[2]  north and up of the eye from the body's middle, where it is a sphere: stretched along the axis by z = a / b; w: a
vec3 body_place(vec3 d, float z, float up)
{
    vec3 k = body[0].xyz;
    float e2 = body[0].w, wv = body[1].w, dz = dot(k, d), nz = k.z + dz, w = sqrt(1.0 - e2 * nz * nz);
    float nv = body[1].x - body[1].z, more = nv * e2 * dz * (nz + k.z) / (w * (w + wv));
    vec3 p = ((body[1].x + z) + more) * d - e2 * ((nv + more) * dz + k.z * more) * k;
    return vec3(p.xy, up + (p.z + more));
}

vec3 body_offset(vec3 d)
{
    return body_place(d, 0.0, 0.0);
}

vec3 body_departure(vec3 d)
{
    return body_offset(d) - (body[2].w + body[1].z) * d;
}

vec3 body_slope(vec3 p, vec3 t)
{
    float e2 = body[0].w, w = sqrt(1.0 - e2 * p.z * p.z);
    return w * (t + e2 / (1.0 - e2) * t.z * (vec3(0.0, 0.0, 1.0) - p.z * p));
}

float body_radius()
{
    return body[2].w;
}

vec3 stretched(vec3 v)
{
    return v + (body[2].z - 1.0) * dot(body[0].xyz, v) * body[0].xyz;
}

vec3 body_met(vec3 view)
{
    vec3 eye = vec3(0.0, body[2].xy), ray = normalize(stretched(view));
    float radius = body[2].w, middle = -dot(ray, eye), aside = length(cross(eye, ray));
    float inside = sqrt(max((radius - aside) * (radius + aside), 0.0));
    return normalize(stretched(eye + max(middle - inside, 0.0) * ray));
}

float body_lowest(vec3 view, out vec3 up)
{
    vec3 eye = vec3(0.0, body[2].xy), ray = normalize(stretched(view));
    float middle = -dot(ray, eye);
    up = normalize(stretched(eye + max(middle, 0.0) * ray));
    return (middle > 0.0 ? length(cross(eye, ray)) : length(eye)) - body[2].w;
}
