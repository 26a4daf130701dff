// imagery.glsl - colours of pictures at a place: which levels of which chart's stack a pixel reads, and how
// (common/render/drape.c).
//
// A level is chosen by the pixel's area on the ground, from its distance and the ground's normal rather than from what is
// next to it, which across slivers of triangles and their edges is anything: by the area's shorter side where the filter
// takes care of the longer one. Towards the reach of its windows, by the distance from the viewer, a level passes over
// into the coarser one, so that nothing moves with the windows themselves.
layout(binding = 4) uniform sampler2DArray image_map; // light times alpha, alpha

const float IMAGE_FADE = 0.1; // of a window's size, in which it passes over

// A pixel's area on the ground, in the eye's axes, metres: its sides.
struct Footprint {
    vec3 longer, shorter;
};

// Of ground with this unit normal, so far from the eye.
Footprint footprint_of(vec3 from_eye, vec3 normal)
{
    float away = max(length(from_eye), 1e-6), wide = away * lens.x;
    vec3 ray = from_eye / away, aside = cross(normal, ray);
    float facing = clamp(abs(dot(normal, ray)), 0.005, 1.0), flat_on = length(aside);
    // Seen from straight above all sides are alike.
    aside = flat_on > 1e-3 ? aside / flat_on : normalize(abs(normal.z) > 0.5 ? vec3(normal.z, 0.0, -normal.x)
                                                                              : vec3(-normal.y, normal.x, 0.0));
    return Footprint(cross(aside, normal) * (wide / facing), aside * wide);
}

// What a layer holds, samples from the viewer's nearest: first x, y, last x, y.
vec4 held_by(int l)
{
    vec4 held = layer[3 * l + 2];
    return held + MAP_END * vec4(lessThan(held.xy, vec2(-0.5 * MAP_END)), -vec2(greaterThan(held.zw, vec2(0.5 * MAP_END))));
}

// Colours of a layer around `at`, samples from the viewer's nearest; the pixel's sides, the longer and the shorter one.
vec4 image_layer(int l, vec2 at, vec2 longer, vec2 shorter)
{
    vec4 first = layer[3 * l + 1], held = held_by(l);
    at = clamp(at, held.xy, held.zw);
    const float side = float(IMAGE_MASK + 1);
    float slice = float(l - LAYERS);
#ifdef IMAGE_TAPS
    // Along the longer side as often as it is longer.
    float count = clamp(ceil(length(longer) / max(length(shorter), 1e-6) - 0.5), 1.0, float(IMAGE_TAPS));
    vec4 sum = vec4(0.0);
    float i = 0.5;
    do { // as in stack.glsl
        vec2 there = clamp(at + longer * (i / count - 0.5), held.xy, held.zw);
        sum += textureLod(image_map, vec3((first.xy + there + 0.5) / side, slice), 0.0);
        i += 1.0;
    } while (i < count);
    return sum / count;
#else
    // The filter goes no further than what is held.
    vec2 room = min(at - held.xy, held.zw - at);
    float fits = min(1.0, (2.0 * min(room.x, room.y) + 1.0) / max(length(longer), 1e-6));
    return textureGrad(image_map, vec3((first.xy + at + 0.5) / side, slice), fits * longer / side, shorter / side);
#endif
}

// The place of a spot, in samples of the next coarser layer.
vec2 coarser_place(int l, vec2 place)
{
    vec4 c = layer[3 * (l - 1)];
    return c.xy + place * c.zw;
}

// Light times alpha, and alpha, at a place of a chart. longer, shorter: the pixel's sides there.
vec4 image_at(int chart, vec2 place, vec2 longer, vec2 shorter)
{
    ivec4 levels = image_stack[chart];
    Spot spot;
    if (levels.z < 0)
        return vec4(0.0);
    vec2 texels = image_scale[chart].xy, a = longer * texels, b = shorter * texels;
    float size = max(length(b), length(a) / IMAGE_ANISOTROPY), shift = max(log2(max(size, 1e-6)) + IMAGE_BIAS, 0.0);
    const float fade = IMAGE_FADE * float(IMAGE_MASK);
    if (!find_spot(Stack(levels.x, levels.y, levels.z, 2.0 / fade), place, shift, spot))
        return vec4(0.0);
    int k = levels.x - spot.layer;
    vec2 off = abs(spot.at);
    float alpha = spot.alpha;
    if (k < levels.z)
        alpha = max(alpha, clamp((max(off.x, off.y) - 0.5 * float(IMAGE_MASK) + 3.0 + fade) / fade, 0.0, 1.0));
    float scale = exp2(-float(k));
    vec4 own = vec4(0.0), coarse = vec4(0.0);
    if (alpha < 1.0)
        own = image_layer(spot.layer, spot.at, a * scale, b * scale);
    if (alpha > 0.0)
        coarse = image_layer(spot.layer - 1, coarser_place(spot.layer, place), 0.5 * a * scale, 0.5 * b * scale);
    return mix(own, coarse, alpha);
}

// As ground.glsl wants it: squares of what is shown, and how much it covers. Level ground by day keeps its colour.
vec4 image_colour(vec4 light)
{
    vec3 c = light.rgb / max(light.a, 1e-4);
    vec3 shown = mix(12.92 * c, 1.055 * pow(max(c, 1e-6), vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
#ifdef LIT
    const float USUAL = 0.615661502; // how high the sun stands by day: TC_SUN_ELEVATION
    return vec4(shown * shown / daylight(USUAL, 1.0, 1.0, 0.0), light.a);
#else
    return vec4(shown * shown, light.a);
#endif
}
