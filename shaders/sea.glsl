// sea.glsl - a level sea around a flat terrain: a strip from below its edge out to the horizon.
vec3 surface_vertex()
{
    int corner = gl_VertexID >> 1 & 3;
    vec2 side = vec2(corner == 1 || corner == 2, corner >= 2);
    bool far = (gl_VertexID & 1) != 0;
    vec2 within = mix(around[0].xy + around[2].z, around[0].zw - around[2].z, side);
    return vec3(far ? (2.0 * side - 1.0) * around[2].x : within, around[1].x);
}
