// faces.frag - the ground at a fragment of a block of a face, for spherical/faces.c (ground.glsl).
INTERPOLATED in vec4 v_terrain; // faces.vert
INTERPOLATED in vec3 v_direction;
flat in vec4 v_corner;
flat in vec4 v_window;
flat in vec3 v_aside;
#ifdef NORMALS
layout(binding = 2) uniform sampler2DArray normals_map;
#endif
#ifdef HOLES
in float v_void;
#endif
#ifdef AT_SEA
INTERPOLATED in float v_above_sea;
#endif

int block_layer()
{
    return int(v_corner.w);
}

// Of a triangle that is edge on, a sample may lie outside by the rounding of its corners, and what is interpolated many
// cells beside it, or anything: there a corner's is taken. A triangle is one cell wide.
bool beside()
{
    vec2 way = abs(v_terrain.yz - v_corner.yz);
    return !(max(way.x, way.y) < 1.25 * v_window.w);
}

vec2 samples_seen()
{
    return beside() ? v_corner.yz : v_terrain.yz;
}

vec3 direction_seen()
{
    return beside() ? v_aside : v_direction;
}

// Metres above the reference height: what is interpolated has few digits, so that it is small where it is looked at.
float told_height()
{
    return beside() ? v_corner.x : v_terrain.x;
}

#ifdef TOLERANCE
// The layer of the level that the distance alone calls for, whichever the block is drawn by: a mesh that is off by less than
// a pixel still loses slopes and colours that are seen. Of levels that are not there yet the finest one that is.
Shown shown(int l, vec2 samples)
{
    float far = viewer_distance(direction_seen()) * surface[3].x, own = layer[3 * l].y;
    int shift = whole[0].y + max(int(ceil(log2(max(far, 0.5)))), 0), coarsest = l - (whole[0].z - int(own));
    float alpha = (far * exp2(float(whole[0].y - shift)) - surface[3].y) * surface[3].z;
    int last = int(layer[3 * l].w);
    l = max(l + int(own) - shift, coarsest);
    vec4 w = window[l];
    vec2 at = layer[3 * l + 1].xy + samples * exp2(own - layer[3 * l].y);
    for (; l > coarsest && (l > last || any(lessThan(at, vec2(0.0))) || any(greaterThan(at, w.zw))); alpha = 0.0) {
        l--;
        w = window[l];
        at = layer[3 * l + 1].xy + samples * exp2(own - layer[3 * l].y);
    }
    return Shown(l, l > coarsest ? clamp(alpha, 0.0, 1.0) : 0.0, clamp(at, vec2(0.0), w.zw));
}
#else
Shown shown(int l, vec2 samples)
{
    return Shown(l, beside() ? 0.0 : clamp(v_terrain.w, 0.0, 1.0), clamp(v_window.xy + samples, vec2(0.0), window[l].zw));
}
#endif

#ifdef NORMALS
// How the height changes with the chart's coordinates, over the radius: the layer's and the coarser one's, by the same
// alpha as the heights. No further than the window, beyond which the map holds what was there before.
vec2 change_seen(Shown s)
{
    vec2 texel = (2.0 * (window[s.layer].xy + s.at) + 0.5) * (0.5 / float(WINDOW_MASK + 1));
    vec4 n = textureLod(normals_map, vec3(texel, float(s.layer)), 0.0);
    vec2 xy = mix(n.xy, n.zw, s.alpha);
    // Slopes were kept steeper where samples are further apart than that (tc_ground_options.relief).
    float spacing = body_radius() * surface[1].x * exp2(layer[3 * s.layer].y);
    return -xy * inversesqrt(max(1.0 - dot(xy, xy), UPRIGHT)) * min(1.0, sqrt(RELIEF / spacing)) * 1.57079633;
}
#endif

Ground surface_ground()
{
    Ground g;
    int l = block_layer(), chart = int(layer[3 * l].x);
    vec3 d = direction_seen(), up = normalize(vec3(d.xy, 1.0 + d.z)), pole = body[0].xyz;
    vec2 samples = samples_seen(), from_viewer = samples * (exp2(layer[3 * l].y) * surface[0].z);
    vec2 place = clamp(from_viewer + surface[FACE(chart) + 4].zw, 0.0, 1.0);
    float told = told_height(), sine = dot(up, pole);
    vec3 east = cross(pole, up);
    float rho = length(east);
    east = rho > 1e-6 ? east / rho : vec3(1.0, 0.0, 0.0);
    vec3 north = cross(up, east);
    float drawn = (told + surface[1].z) + surface[1].y;
#if defined(NORMALS) || defined(TOLERANCE)
    Shown s = shown(l, samples);
#endif
#ifdef TOLERANCE
    g.height = shown_height(s);
#else
    g.height = drawn;
#endif
#ifdef AT_SEA
#ifdef TOLERANCE
    float above_sea = g.height - SEA_LEVEL;
#else
    float above_sea = beside() ? g.height - SEA_LEVEL : v_above_sea;
    g.height = abs(above_sea) < abs(told) ? above_sea + SEA_LEVEL : g.height;
#endif
#ifdef FLOOD
    g.above_sea = above_sea;
#endif
#endif
    g.colour = vec4(0.0);
#ifdef CONTOURS
    g.rise = beside() ? v_corner.x : interpolateAtOffset(v_terrain, vec2(0.0)).x;
#endif
#ifdef NORMALS
    // The body's functions have the axis as z.
    vec3 slope = chart_slope(chart, place, change_seen(s), up, east, north, sine);
    vec3 turned = body_slope(vec3(0.0, rho, sine), vec3(dot(slope, east), dot(slope, north) * vec2(-sine, rho)));
    vec2 fall = vec2(turned.x, rho * turned.z - sine * turned.y);
    g.up = up;
    g.normal = normalize(up - fall.x * east - fall.y * north);
    float radius = body_radius();
    g.fall = -fall * (radius / (radius + g.height));
#endif
#ifdef ZONES
    g.sine = sine;
#endif
#if defined(LIT) && defined(CLIMATE)
    g.day = smoothstep(-0.22, 0.3, dot(up, sun.xyz));
    g.snow_line = snow_line(sine);
#endif
#ifdef IMAGERY
    vec3 from_eye = body_place(d, drawn, told + surface[1].w);
#ifdef NORMALS
    Footprint f = footprint_of(from_eye, g.normal);
#else
    Footprint f = footprint_of(from_eye, up);
#endif
    float to_sphere = 1.0 / body_radius();
    g.colour = image_colour(image_at(chart, from_viewer,
                                     chart_step(chart, place, f.longer * to_sphere, up, east, north, sine),
                                     chart_step(chart, place, f.shorter * to_sphere, up, east, north, sine)));
#endif
#ifdef LEVEL_COLOURS
    g.level = layer[3 * l].y + log2(v_window.w);
#endif
#ifdef HOLES
    g.hole = v_void > 0.0;
#endif
    return g;
}

#ifdef CONTOURS
float surface_datum()
{
    return surface[1].w;
}
#endif

#ifdef HAZE
float surface_haze()
{
    float nearness = NEARNESS;
#ifdef CLOSERS
    nearness = v_window.z;
#else
    nearness = beside() ? v_window.z : nearness;
#endif
    vec3 d = direction_seen();
    return air_before(nearness, vec3(d.xy, 1.0 + d.z), (told_height() + surface[1].z) + surface[1].y);
}
#endif
