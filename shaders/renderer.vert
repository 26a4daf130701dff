// renderer.vert - a vertex of the support geometry.
//
// The surface's part before it defines
//     vec3 surface_vertex()    position relative to the eye, metres; sets what the surface's fragment part reads
invariant gl_Position;

void main()
{
    gl_Position = view_projection * vec4(surface_vertex(), 1.0);
}
