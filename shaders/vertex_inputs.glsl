// vertex_inputs.glsl - a vertex of the static support geometry, and its block.
layout(location = 0) in ivec2 in_vertex;
layout(location = 1) in ivec4 in_instance;
