/* synth_planet.c - a planet out of a seed.
 *
 * Every sample is worked out by itself, from its place on the unit sphere: noise is evaluated in space, so that neither
 * the map's edges nor its poles exist for it. From coarse to fine: plates (plates.c) and warped noise say how far
 * inland a place is; a curve like the Earth's hypsometry makes that a height, with shelves, slopes and abyssal plains;
 * where plates meet there are chains of mountains and island arcs with trenches before them, where they part there are
 * ridges; old worn mountains and hills lie in between, ice upon what is near the poles. Roughness goes with what the
 * ground is, as in Musgrave's multifractals (Ebert et al., "Texturing and Modeling", 3rd ed., ch. 16).
 *
 * Everything is + - * / and sqrt on IEEE numbers, in an order that does not depend on threads. libm's sine and cosine
 * differ between machines, so that there is one here. */
#include "synth_planet.h"

#include "common/base/parallel.h"
#include "common/base/rect.h"
#include "common/base/status.h"
#include "noise.h"
#include "plates.h"

#include <math.h>
#include <stdlib.h>

/* What each random number is for. Numbers stay what they are, or a seed's planet would change. */
enum purpose {
    SHARE = 1,
    PLATES,
    WARP,
    CONTINENT = WARP + 3,
    WIDTH,
    RANGE,
    CREST,
    OLD,
    OLD_MASK,
    HILLS,
    PLAIN,
    FABRIC,
    FAULT,
    RAGGED,
    SEAMOUNT,
    ICE,
    CAP = 40,
    PURPOSES = 48
};

enum { KNOTS = 10, COARSE_OCTAVES = 5, SHARES = 8192 };

/* Height, metres, by how far inland (the sea's is negative). Of all places 9 in 10 lie within an interval of 1. */
static const float knots[KNOTS][2] = {
    {-0.80f, -5600}, {-0.36f, -5250}, {-0.20f, -4700}, {-0.095f, -2600}, {-0.055f, -260},
    {-0.03f, -120},  {0, 0},          {0.10f, 190},    {0.28f, 480},     {0.70f, 1000},
};

struct tc_synth_planet {
    int64_t size;
    int threads;
    uint32_t seed[PURPOSES];
    tc_plates plates;
    double cap[2][3];    /* where the ice caps' middles are, unit vectors near the poles */
    float cap_radius[2]; /* of the land beneath them, radians */
    float sea, spread;   /* of the continents' raw values: sea level, and a unit of inland */
    float slope[KNOTS];  /* of the curve at its knots */
    double *east;        /* cosine and sine of each column's longitude */
};

/* A place and what is known of it. */
struct place {
    double p[3], q[3], r[3]; /* on the unit sphere; bent; bent less, since bent noise has a grain */
    float inland, land;      /* land: 0..1, 0 on the deep sea floor */
    float belt;              /* 0..1: young mountains */
    float lift;              /* metres that plates add to the ground */
    float ranges;            /* 0..1: crests within belts */
    float ridge;             /* 0..1: young sea floor */
};

/* ---- Angles ----------------------------------------------------------------------------------------------------- */

/* Cosine and sine of number / count of a turn. */
static void turn(int64_t number, int64_t count, double *cosine, double *sine)
{
    number = (number % count + count) % count;
    int64_t quarter = 4 * number / count, rest = 4 * number - quarter * count;
    bool beyond = 2 * rest > count; /* the half of the quarter that is nearer to its end */
    double x = 1.5707963267948966 * ((double)(beyond ? count - rest : rest) / (double)count), x2 = x * x;
    double s = x * (1 - x2 / 6 * (1 - x2 / 20 * (1 - x2 / 42 * (1 - x2 / 72 * (1 - x2 / 110 * (1 - x2 / 156))))));
    double c = 1 - x2 / 2 * (1 - x2 / 12 * (1 - x2 / 30 * (1 - x2 / 56 * (1 - x2 / 90 * (1 - x2 / 132)))));
    if (beyond) {
        double swap = s;
        s = c;
        c = swap;
    }
    *cosine = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
    *sine = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
}

/* ---- Noise ------------------------------------------------------------------------------------------------------ */

/* Octaves from a frequency, cycles a radian, on to what samples can show: a lattice cell of 3/2 samples. */
static int octaves_from(int64_t size, double frequency)
{
    double finest = (double)size / (6.2831853 * 1.5);
    int octaves = 0;
    for (; frequency <= finest && octaves < 16; frequency *= 2)
        octaves++;
    return octaves;
}

/* Crests along the zero lines of noise, rougher the higher; about -1..2, no mean. */
static float ridged(uint32_t seed, const double p[3], double frequency, int octaves, float gain)
{
    double at[3];
    tc_first_octave3(p, frequency, at);
    float sum = 0, amplitude = 1, weight = 1;
    for (int k = 0; k < octaves; k++) {
        float n = tc_noise3(seed + (uint32_t)k * 0x632BE5ABu, at[0], at[1], at[2]);
        float crest = 1 - 2.2f * (n < 0 ? -n : n);
        crest = crest < 0 ? 0 : crest * crest;
        sum += amplitude * weight * (crest - 0.36f);
        weight = 0.35f + 1.5f * crest > 1 ? 1 : 0.35f + 1.5f * crest;
        amplitude *= gain;
        tc_next_octave3(at);
    }
    return sum;
}

/* 1 at 0, 0 from 1 on, smooth. */
static float bump(float x)
{
    float t = 1 - x * x;
    return t > 0 ? t * t : 0;
}

static float mix(float a, float b, float t)
{
    return a + t * (b - a);
}

/* ---- Continents ------------------------------------------------------------------------------------------------- */

static void bend(const tc_synth_planet *planet, struct place *at)
{
    for (int k = 0; k < 3; k++) {
        float by = tc_fbm3(planet->seed[WARP + k], at->p, 1.9, 6, 0.52f);
        at->q[k] = at->p[k] + 0.24 * by;
        at->r[k] = at->p[k] + 0.09 * by;
    }
}

/* Around the poles there is land, and around it sea. */
static float with_caps(const tc_synth_planet *planet, const double p[3], float raw)
{
    for (int c = 0; c < 2; c++) {
        const double *m = planet->cap[c];
        double d2 = (p[0] - m[0]) * (p[0] - m[0]) + (p[1] - m[1]) * (p[1] - m[1]) + (p[2] - m[2]) * (p[2] - m[2]);
        if (d2 > 1)
            continue;
        float d = sqrtf((float)d2), radius = planet->cap_radius[c];
        d += 0.34f * tc_fbm3(planet->seed[CAP], p, 3.4, 6, 0.55f);
        float target = planet->sea + 0.42f - 0.8f * tc_smoothstep(radius - 0.12f, radius + 0.14f, d);
        float loose = 0.1f + 0.5f * tc_smoothstep(0, 0.3f, sqrtf((float)d2)); /* the pole itself is always land */
        raw = mix(raw, target + loose * (raw - planet->sea), 1 - tc_smoothstep(radius + 0.12f, radius + 0.38f, d));
    }
    return raw;
}

static float continents(const tc_synth_planet *planet, const double q[3], float plates, int octaves)
{
    return 0.34f * plates + tc_fbm3(planet->seed[CONTINENT], q, 1.35, octaves, 0.54f);
}

/* Some coasts are more ragged than others. */
static float ragged(const tc_synth_planet *planet, const struct place *at)
{
    if (at->inland < -0.2f || at->inland > 0.25f)
        return 0;
    float how = tc_smoothstep(-0.3f, 0.45f, tc_fbm3(planet->seed[RAGGED], at->q, 4.1, 3, 0.5f));
    float fade = bump(at->inland / (at->inland < 0 ? 0.2f : 0.25f));
    return fade * (0.02f + 0.13f * how) *
           tc_fbm3(planet->seed[RAGGED] + 5, at->r, 15, octaves_from(planet->size, 15), 0.65f);
}

/* Height by how far inland, cubic between knots. */
static float hypsometry(const tc_synth_planet *planet, float inland)
{
    if (inland <= knots[0][0])
        return knots[0][1];
    int k = 0;
    while (k < KNOTS - 2 && inland > knots[k + 1][0])
        k++;
    float width = knots[k + 1][0] - knots[k][0], t = (inland - knots[k][0]) / width;
    t = t > 1 ? 1 : t;
    float u = 1 - t;
    return u * u * ((1 + 2 * t) * knots[k][1] + t * width * planet->slope[k]) +
           t * t * ((1 + 2 * u) * knots[k + 1][1] - u * width * planet->slope[k + 1]);
}

/* ---- Where plates meet ------------------------------------------------------------------------------------------ */

/* Ridges of the sea floor, and rifts. */
static void part(const tc_synth_planet *planet, struct place *at, const tc_plate_edge *edge, float parting)
{
    /* Ridges are offset along faults that run across them: by noise that hardly varies across the boundary. */
    double flat[3], along[3];
    for (int k = 0; k < 3; k++)
        flat[k] = at->r[k] - 0.97 * edge->distance * edge->normal[k];
    tc_first_octave3(flat, 5, along);
    float offset = 0, jump = 0.06f;
    for (uint32_t k = 0; k < 2; k++) {
        float n = tc_noise3(planet->seed[FAULT] + edge->number + 7919 * k, along[0], along[1], along[2]);
        offset += jump * (tc_smoothstep(-0.08f, 0.08f, n) - 0.5f);
        jump = 0.035f;
        tc_next_octave3(along);
    }
    float away = fabsf(edge->distance + offset), inner = tc_smoothstep(0.05f, 0.25f, at->inland);
    /* Sea floor sinks with the root of its age. */
    float t = 1 - sqrtf(away * 2.6f + 0.0002f);
    at->ridge += parting * (1 - at->land) * (t > 0 ? t : 0);
    at->lift += parting * (1 - at->land) * (700 * bump(away / 0.028f) - 1000 * bump(away / 0.01f));
    /* A rift where a continent parts. */
    float vary = tc_fbm3(planet->seed[WIDTH] + edge->number, at->q, 4.3, 3, 0.5f);
    float rift = parting * inner * tc_smoothstep(-0.15f, 0.25f, vary);
    away = fabsf(edge->distance);
    at->lift += rift * (600 * bump(away / 0.06f) - 750 * bump(away / (0.012f + 0.01f * vary)));
}

static void add_edge(const tc_synth_planet *planet, struct place *at, const tc_plate_edge *edge)
{
    float d = edge->distance, closing = edge->weight * tc_smoothstep(-0.02f, 0.5f, edge->approach);
    float parting = edge->weight * tc_smoothstep(-0.02f, 0.3f, -edge->approach), sea = 1 - at->land;
    float away = d < 0 ? -d : d;
    if (parting > 0 && away < 0.6f)
        part(planet, at, edge, parting);
    if (!(closing > 0) || away > 0.5f)
        return;
    /* A trench on the side that goes under, unless both are land. */
    at->lift -= 3300 * closing * sea * sea * bump((d - 0.016f) / 0.022f);

    /* Mountains or an arc of islands on the other, wide where it is land and wider where both are. */
    float vary = tc_fbm3(planet->seed[WIDTH] + edge->number, at->q, 4.3, 3, 0.5f);
    float both = at->land * tc_smoothstep(-0.3f, 0.2f, edge->land[1]);
    float width = mix(0.030f, mix(0.085f, 0.13f, both), at->land) * (1 + 1.3f * vary);
    float belt = closing * bump((d + 0.8f * width) / width);
    if (belt > 0) {
        /* Crests run along the boundary: space is compressed across it. */
        double s[3], compress = 1.6 * d;
        for (int k = 0; k < 3; k++)
            s[k] = at->q[k] + compress * edge->normal[k];
        float crest = ridged(planet->seed[RANGE] + edge->number, s, 9, 4, 0.5f);
        at->ranges += belt * tc_smoothstep(-0.7f, 0.9f, crest);
        at->belt += belt;
    }
    /* A high plateau behind a range between two continents. */
    float high = both * closing * tc_smoothstep(-0.03f, -0.09f, d) * tc_smoothstep(-0.24f, -0.15f, d + 0.1f * vary);
    at->lift += 3300 * high * tc_smoothstep(-0.1f, 0.25f, vary);
}

/* ---- A place ---------------------------------------------------------------------------------------------------- */

/* Old worn mountains along some zero lines of noise, 0..1. */
static float worn(const tc_synth_planet *planet, const struct place *at)
{
    float line = tc_fbm3(planet->seed[OLD], at->q, 2.3, 3, 0.45f);
    float mask = tc_fbm3(planet->seed[OLD_MASK], at->q, 2.1, 2, 0.5f);
    return bump(line / 0.13f) * tc_smoothstep(-0.12f, 0.25f, mask);
}

static float dry_ground(const tc_synth_planet *planet, const struct place *at, float z)
{
    float old = worn(planet, at) * at->land;
    float hills = tc_smoothstep(-0.15f, 0.4f, tc_fbm3(planet->seed[HILLS], at->q, 3.7, 4, 0.55f));
    float coast = tc_smoothstep(-0.01f, 0.06f, at->inland);
    float belt = at->belt > 1 ? 1 : at->belt, ranges = at->ranges > 1 ? 1 : at->ranges;

    float detail = ridged(planet->seed[CREST], at->r, 19, octaves_from(planet->size, 19), 0.74f);
    float plain = tc_fbm3(planet->seed[PLAIN], at->r, 13, octaves_from(planet->size, 13), 0.64f);
    /* Arcs are less high above a deeper ground. */
    float rise =
        mix(1.35f, 1, at->land) * mix(1, 0.62f, at->land) * (700 * belt + 5200 * ranges * (0.35f + 0.65f * belt));
    float rough = 2100 * ranges * (0.3f + 0.7f * belt) + 600 * belt + coast * (750 * old + 220 * hills);
    z += rise + at->lift + coast * (800 * old + 300 * hills);
    return z + rough * detail + (coast * (60 + 260 * hills) + 300 * belt) * plain;
}

static float sea_floor(const tc_synth_planet *planet, const struct place *at)
{
    float deep = 1 - tc_smoothstep(-0.2f, -0.08f, at->inland);
    if (!(deep > 0))
        return 0;
    float fabric = tc_fbm3(planet->seed[FABRIC], at->r, 11, octaves_from(planet->size, 11), 0.62f);
    float mount = tc_fbm3(planet->seed[SEAMOUNT], at->p, 17, 3, 0.45f);
    float chain = tc_smoothstep(0, 0.4f, tc_fbm3(planet->seed[SEAMOUNT] + 9, at->q, 2.6, 2, 0.5f));
    float cone = tc_smoothstep(0.36f, 0.8f, mount);
    return deep * (3000 * at->ridge + (220 + 900 * at->ridge) * fabric + 9000 * chain * cone * cone);
}

/* Ice lies on land near the poles, domed by its own flow. */
static float with_ice(const tc_synth_planet *planet, const struct place *at, float plates, float z)
{
    float polar = (float)(at->p[2] * at->p[2]);
    if (polar < 0.7f)
        return z;
    polar += 0.12f * tc_fbm3(planet->seed[ICE], at->p, 4, 4, 0.5f);
    float depth = tc_smoothstep(0.84f, 0.93f, polar);
    if (!(depth > 0) || at->inland <= 0)
        return z;
    /* The dome knows the continent's outline only. */
    float smooth = with_caps(planet, at->p, continents(planet, at->q, plates, 3)) - planet->sea;
    smooth = smooth < 0 ? 0 : smooth / planet->spread;
    depth *= mix(at->inland, smooth, tc_smoothstep(0, 0.15f, at->inland));
    float surface = 3300 * sqrtf(depth / (depth + 0.22f)) - 60;
    surface += 40 * tc_fbm3(planet->seed[ICE] + 7, at->p, 9, 4, 0.45f);
    /* Peaks stand out; what is below is filled. */
    float above = z - surface, soft = 250 * tc_smoothstep(0, 0.05f, depth);
    return surface + 0.5f * (above + sqrtf(above * above + soft * soft));
}

static float height_at(const tc_synth_planet *planet, const double p[3])
{
    struct place at = {.p = {p[0], p[1], p[2]}};
    bend(planet, &at);
    tc_plate_site site;
    tc_plates_at(&planet->plates, at.q, &site);
    int octaves = octaves_from(planet->size, 1.35);
    float raw = continents(planet, at.q, site.land, octaves < COARSE_OCTAVES ? COARSE_OCTAVES : octaves);
    at.inland = (with_caps(planet, p, raw) - planet->sea) / planet->spread;
    at.inland += ragged(planet, &at);
    at.land = tc_smoothstep(-0.14f, 0, at.inland);
    float z = hypsometry(planet, at.inland);
    for (int i = 0; i < site.edges; i++)
        add_edge(planet, &at, &site.edge[i]);
    z = dry_ground(planet, &at, z) + sea_floor(planet, &at);
    z = z > 5500 ? 5500 + (z - 5500) / (1 + (z - 5500) * (1 / 4000.0f)) : z;
    z = z < -6500 ? -6500 + (z + 6500) / (1 - (z + 6500) * (1 / 4500.0f)) : z;
    return with_ice(planet, &at, site.land, z);
}

/* ---- The whole -------------------------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Sea level, so that the seed's share of places, evenly spread, is land, whatever the size. */
static bool settle_sea(tc_synth_planet *planet)
{
    float *raw = malloc(SHARES * sizeof *raw);
    if (!raw)
        return false;
    for (int i = 0; i < SHARES; i++) {
        double c, s, z = (2 * i + 1.0) / SHARES - 1, r = sqrt(1 - z * z);
        turn((int64_t)i * 618034, 1000000, &c, &s); /* the golden section of a turn */
        struct place at = {.p = {r * c, r * s, z}};
        bend(planet, &at);
        tc_plate_site site;
        tc_plates_at(&planet->plates, at.q, &site);
        raw[i] = continents(planet, at.q, site.land, COARSE_OCTAVES);
    }
    qsort(raw, SHARES, sizeof *raw, by_value);
    float share = 0.33f + 0.08f * (float)(planet->seed[SHARE] >> 8) * (1.0f / 16777216);
    planet->sea = raw[(int)((1 - share) * SHARES)];
    planet->spread = raw[SHARES * 19 / 20] - raw[SHARES / 20];
    free(raw);
    return true;
}

static void settle_curve(tc_synth_planet *planet)
{
    /* Harmonic means of the slopes on both sides: no overshoot. */
    for (int k = 0; k < KNOTS; k++) {
        int a = k > 0 ? k - 1 : 0, b = k < KNOTS - 2 ? k : KNOTS - 2;
        float before = (knots[a + 1][1] - knots[a][1]) / (knots[a + 1][0] - knots[a][0]);
        float after = (knots[b + 1][1] - knots[b][1]) / (knots[b + 1][0] - knots[b][0]);
        planet->slope[k] = 2 * before * after / (before + after);
    }
}

static void settle_caps(tc_synth_planet *planet)
{
    for (int c = 0; c < 2; c++) {
        double *m = planet->cap[c];
        for (int k = 0; k < 2; k++)
            m[k] = 0.12 * ((double)planet->seed[CAP + 1 + 2 * c + k] * (1.0 / 4294967296.0) - 0.5);
        m[2] = sqrt(1 - m[0] * m[0] - m[1] * m[1]);
        m[2] = c ? -m[2] : m[2];
        planet->cap_radius[c] = 0.27f + 0.1f * (float)(planet->seed[CAP + 5 + c] >> 8) * (1.0f / 16777216);
    }
}

tc_status tc_synth_planet_open(int64_t size, uint64_t seed, int threads, tc_synth_planet **planet_ret, tc_error *error)
{
    *planet_ret = NULL;
    if (size < TC_SYNTH_PLANET_MIN || size > TC_SYNTH_PLANET_MAX || size % 2 != 0)
        return tc_fail(error, TC_ERR_USAGE,
                       "size: expected an even number of %d..%d samples around a planet, found %lld",
                       TC_SYNTH_PLANET_MIN, TC_SYNTH_PLANET_MAX, (long long)size);
    tc_synth_planet *planet = calloc(1, sizeof *planet);
    if (planet)
        planet->east = malloc((size_t)size * 2 * sizeof *planet->east);
    if (!planet || !planet->east) {
        tc_synth_planet_close(planet);
        return tc_fail(error, TC_ERR_MEMORY, "not enough memory for a planet of %lld columns", (long long)size);
    }
    planet->size = size;
    planet->threads = threads;
    for (int k = 0; k < PURPOSES; k++)
        planet->seed[k] = (uint32_t)tc_hash64(seed, (uint64_t)k);
    tc_plates_make(&planet->plates, tc_hash64(seed, PLATES));
    for (int64_t i = 0; i < size; i++)
        turn(2 * i + 1 - size, 2 * size, &planet->east[2 * i], &planet->east[2 * i + 1]);
    settle_curve(planet);
    settle_caps(planet);
    if (!settle_sea(planet)) {
        tc_synth_planet_close(planet);
        return tc_fail(error, TC_ERR_MEMORY, "not enough memory for a planet");
    }
    *planet_ret = planet;
    return TC_OK;
}

void tc_synth_planet_close(tc_synth_planet *planet)
{
    if (planet)
        free(planet->east);
    free(planet);
}

struct rows {
    const tc_synth_planet *planet;
    int64_t y0;
    float *z;
};

static void make_row(void *context, int64_t j)
{
    const struct rows *rows = context;
    int64_t size = rows->planet->size;
    double c, s;
    turn(2 * (rows->y0 + j) + 1 - size / 2, 2 * size, &c, &s);
    for (int64_t i = 0; i < size; i++) {
        const double *east = rows->planet->east + 2 * i;
        rows->z[j * size + i] = height_at(rows->planet, (double[3]){c * east[0], c * east[1], s});
    }
}

void tc_synth_planet_rows(const tc_synth_planet *planet, int64_t y0, int64_t rows, float *z)
{
    struct rows work = {planet, y0, z};
    tc_parallel_for(planet->threads, rows, make_row, &work);
}
