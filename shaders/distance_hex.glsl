// distance_hex.glsl - BN08's distance: hexagons around the viewer, two of their sides along the parallel
// (spherical/faces_scheme.c).
float viewer_distance(vec3 d)
{
    float flat_ = dot(d.xy, d.xy), away = flat_ > 1e-30 ? sqrt(dot(d, d) / flat_) : 1.0;
    vec2 p = abs(d.xy) * away;
    return max(max(p.y, 0.8660254 * p.x + 0.5 * p.y), surface[0].w);
}
