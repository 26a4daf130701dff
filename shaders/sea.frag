// sea.frag - the sea around a flat terrain (ground.glsl). It deepens away from it.

Ground surface_ground()
{
    Ground g;
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    vec3 ray = pixel[2].xyz + across.x * pixel[0].xyz + across.y * pixel[1].xyz;
    vec2 place = ray.xy * min(around[1].x / ray.z, 1e30); // of pixels that are covered in part it may be anything
    place = ray.z * around[1].x > 0.0 ? clamp(place, vec2(-1e15), vec2(1e15)) : vec2(1e15);
    vec2 off = max(max(around[0].xy - place, place - around[0].zw), 0.0);
    float away = min(length(off) * around[2].y, 1e3);
#ifdef FLOOD
    g.height = beyond.z;
    g.above_sea = 0.0;
#else
    g.height = heights.x - around[1].w - 0.85 / heights.y * (1.0 - exp(-2.5 * away));
#endif
    g.colour = vec4(0.0);
#ifdef NORMALS
    g.up = g.normal = vec3(0.0, 0.0, 1.0);
    g.fall = vec2(0.0);
#endif
#ifdef ZONES
    g.sine = 0.0;
#endif
    return g;
}

#ifdef HAZE
float surface_haze()
{
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    float r = haze.w / max(NEARNESS, 1e-30);
    return r * r * (1.0 + dot(across, across));
}
#endif
