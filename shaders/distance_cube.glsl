// distance_cube.glsl - PT's distance: in space (spherical/faces_scheme.c).
float viewer_distance(vec3 d)
{
    float height = surface[0].w;
    return sqrt(dot(d, d) + height * height);
}
