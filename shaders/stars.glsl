// stars.glsl - stars on a sphere that does not turn with the eye: always the same ones. They are of no sky that there is.
uvec3 star_hash(uvec3 v) // PCG3D (Jarzynski, Olano 2020)
{
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z, v.y += v.z * v.x, v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z, v.y += v.z * v.x, v.z += v.x * v.y;
    return v;
}

// Light from a direction, of length 1 in space's axes; a pixel's width, radians. Each cell of a cube's sides has a star or
// none, so far within that its light stays there. It falls off over a pixel, so that what a star gives does not hang on
// where between pixels it is. Few are bright: twice as bright ones are 2.3 times as rare.
vec3 starlight(vec3 d, float pixel)
{
    const float CELLS = 52.0, SHARE = 0.66; // of a side's middle
    vec3 size = abs(d);
    int axis = size.x > max(size.y, size.z) ? 0 : size.y > size.z ? 1 : 2;
    vec3 p = axis == 0 ? d.yzx : axis == 1 ? d.zxy : d.xyz; // the longest last
    vec2 at = (p.xy / abs(p.z) * 0.5 + 0.5) * CELLS, cell = clamp(floor(at), 0.0, CELLS - 1.0);
    uvec3 h = star_hash(uvec3(uvec2(cell), uint(axis * 2 + (p.z < 0.0 ? 1 : 0))));
    // Cells are smaller towards a side's corners, by the third power of how far away they are.
    vec2 side = (cell + 0.5) / CELLS * 2.0 - 1.0;
    if (float(h.z >> 8u & 4095u) >= SHARE * 4096.0 * pow(1.0 + dot(side, side), -1.5))
        return vec3(0.0);
    vec2 middle = 0.3 + 0.4 * vec2(h.xy >> 16u) / 65535.0;
    vec3 star = normalize(vec3(((cell + middle) / CELLS * 2.0 - 1.0), sign(p.z)));
    float away = distance(star, normalize(p)) / min(pixel, 0.1 / CELLS);
    float rare = float(h.z >> 20u) / 4096.0 + 0.0025, bright = min(0.045 * pow(rare, -0.83), 2.5);
    float warm = float(h.x & 255u) / 255.0;
    vec3 hue = mix(vec3(1.0, 0.78, 0.58), vec3(0.72, 0.84, 1.0), warm);
    return bright * mix(vec3(1.0), hue, 0.7) * exp(-1.6 * away * away);
}

// To those, of an eye's directions.
vec3 stars_at(vec3 ray)
{
    return starlight(normalize(ray.x * space[0].xyz + ray.y * space[1].xyz + ray.z * space[2].xyz), max(lens.x, lens.y));
}
