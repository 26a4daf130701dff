// body_sphere.glsl - the sphere that a globe is, seen from the eye (common/chart/sphere.c).
//
// Normals are unit vectors; d is a normal less that at the viewer's foot point, in the eye's axes: east, north, up. What
// every body_*.glsl defines, of which a map's class names one:
//
//     vec3  body_offset(vec3 d)     from the viewer's foot point at the reference height to the place of the same height
//                                   whose normal is that much another: metres in the eye's axes, without cancellation
//     vec3  body_place(vec3 d, float z, float up)  relative to the eye: the place z above the reference height, which
//                                   were it the viewer's would be `up` above the eye
//     vec3  body_departure(vec3 d)  how far the place on the body is from that on a sphere through the foot point, of the
//                                   equator's radius
//     vec3  body_slope(vec3 p, vec3 t)  a slope or a way along the ground at normal p as it would be on a sphere of the
//                                   equator's radius: by radians that normals turn. z of p and t is along the axis
//     vec3  body_met(vec3 view)     normal at height 0 where the ray from the eye meets the body, or is nearest to it;
//                                   of any length
//     float body_lowest(vec3 view, out vec3 up)  height of the ray's lowest point, from the eye on; the normal there
//     float body_radius()           metres, at the equator
//
// body[0]  xyz: to the north pole, in the eye's axes
// body[1]  x: radius at the reference height; y: eye above that; z: that height
vec3 body_offset(vec3 d)
{
    return body[1].x * d;
}

vec3 body_place(vec3 d, float z, float up)
{
    float radius = body[1].x + z;
    return vec3(radius * d.xy, up + radius * d.z);
}

vec3 body_departure(vec3 d)
{
    return vec3(0.0);
}

vec3 body_slope(vec3 p, vec3 t)
{
    return t;
}

float body_radius()
{
    return body[1].x - body[1].z;
}

vec3 body_met(vec3 view)
{
    float eye_radius = body[1].x + body[1].y, radius = body_radius(), long2 = dot(view, view);
    float middle = -view.z * eye_radius;
    float inside = sqrt(max(radius * radius * long2 - eye_radius * eye_radius * dot(view.xy, view.xy), 0.0));
    return normalize(vec3(0.0, 0.0, eye_radius) + max(middle - inside, 0.0) / long2 * view);
}

float body_lowest(vec3 view, out vec3 up)
{
    float eye_radius = body[1].x + body[1].y, radius = body_radius();
    up = normalize(vec3(0.0, 0.0, eye_radius) + max(-view.z, 0.0) * eye_radius * view);
    return view.z >= 0.0 ? eye_radius - radius : eye_radius * sqrt(max(1.0 - view.z * view.z, 0.0)) - radius;
}
