// square_walls.frag - walls below the edge of a flat terrain, and the floor between them: the ground as it is cut there
// (ground.glsl); planar/square_walls.c.
INTERPOLATED in float v_height; // square.glsl
flat in vec3 v_wall;
#ifdef AT_SEA
INTERPOLATED in float v_above_sea;
#endif
#ifdef HOLES
in float v_void;
#endif

// Layers of rock, by height: shares of the wall's colour. They fade where they come too near to each other.
float strata(float height)
{
    float at = (height - around[1].z) * around[3].w * 40.0;
    float bent = at + 1.3 * sin(0.37 * at) + 0.8 * sin(0.11 * at + 1.0);
    return 1.0 + 0.16 * sin(bent) * clamp(1.0 - fwidth(bent), 0.0, 1.0);
}

#ifdef CONTOURS
// Metres above the eye where the pixel's ray meets the wall's plane: strips of walls are narrower than a pixel, and what is
// interpolated for their middles is of no height of theirs.
float rise()
{
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    vec3 ray = pixel[2].xyz + across.x * pixel[0].xyz + across.y * pixel[1].xyz;
    vec2 away = mix(around[0].xy, around[0].zw, step(0.0, v_wall.xy)) / ray.xy;
    float to = v_wall.x != 0.0 ? away.x : away.y;
    return v_wall.xy == vec2(0.0) ? (around[1].z - eye.x) - eye.y : to * ray.z;
}
#endif

Ground surface_ground()
{
    Ground g;
    g.height = (v_height + eye.w) + eye.z;
#ifdef AT_SEA
    g.height = abs(v_above_sea) < abs(v_height) ? v_above_sea + SEA_LEVEL : g.height;
#endif
    g.colour = vec4(around[3].rgb * strata(g.height), 1.0);
#if defined(SEA) && defined(WATER)
    bool wet = g.height <= around[1].y + around[2].w; // of ground below the sea: else the sea is before it
    g.colour.a = wet ? 0.0 : 1.0;
    g.height = wet ? min(g.height, heights.x - around[1].w) : g.height; // as the sea around is coloured
#else
#if defined(SEA) && defined(FLOOD)
    bool wet = v_above_sea <= beyond.w;
    g.colour.a = wet ? 0.0 : 1.0;
#else
    const bool wet = false;
#endif
#endif
#ifdef FLOOD
    g.above_sea = v_above_sea;
#endif
#ifdef CONTOURS
    g.rise = rise();
#endif
#ifdef NORMALS
    g.up = vec3(0.0, 0.0, 1.0);
    g.normal = wet ? g.up : vec3(v_wall.xy, dot(v_wall.xy, v_wall.xy) - 1.0);
    g.fall = vec2(0.0);
#endif
#ifdef ZONES
    g.sine = 0.0;
#endif
#ifdef LEVEL_COLOURS
    g.level = v_wall.z;
#endif
#ifdef HOLES
    g.hole = v_void > 0.0;
#endif
    return g;
}

#ifdef CONTOURS
float surface_datum()
{
    return 0.0;
}
#endif

#ifdef HAZE
float surface_haze()
{
    vec2 across = gl_FragCoord.xy * lens.xy - lens.zw;
    float r = haze.w / NEARNESS;
    return r * r * (1.0 + dot(across, across));
}
#endif
