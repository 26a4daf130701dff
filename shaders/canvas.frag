// canvas.frag - the samples of a pixel make its colour. What is stored are roots (renderer.frag): their squares add up.
layout(binding = 0) uniform sampler2DMS samples_map;
layout(location = 0) out vec4 colour;

void main()
{
    int count = textureSamples(samples_map);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < count; k++) {
        vec4 c = texelFetch(samples_map, ivec2(gl_FragCoord.xy), k);
        sum += vec4(c.rgb * c.rgb, c.a);
    }
    sum /= float(count);
    colour = vec4(sqrt(sum.rgb), sum.a);
}
