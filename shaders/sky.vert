// sky.vert - one triangle over the whole frame, at infinity.
out vec3 v_ray; // from the eye, map axes; not normalised

void main()
{
    vec2 screen = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
    v_ray = ray[0].xyz * screen.x + ray[1].xyz * screen.y + ray[2].xyz;
    gl_Position = vec4(screen, beyond.x, 1.0);
}
