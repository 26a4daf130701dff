/* bench_seams.c - what it costs that the faces of a packed planet are coded each by itself: bench_seams [--quick]
 * [--csv FILE]
 *
 * A planet on the faces of an octahedron and of a cube, in memory, where levels are filtered across seams, and packed
 * to an rms of 0.01 m, where they are filtered up to them. For each coarser level: how far heights are apart on the
 * sides, some samples inside and further inside, beside the rms of what the halving takes away there; how much a
 * largest difference can be seen at, where the level is drawn (a level is drawn beyond 0.28 n of the next finer one's
 * cells, n = 255); second differences across the sides, which are creases; and what samples on the sides would be
 * otherwise, made from both charts' own. Then bytes: of tiles that touch sides and of others, in a pack as `terraclip
 * pack` does it by default, and how much larger details are next to a side for being predicted from one side of it.
 * Without voids. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/base/rect.h"
#include "common/field/filter.h"
#include "common/packed/file/packed_file.h"
#include "common/packed/read/tile_store.h"
#include "tests/support/made_files.h"
#include "tests/support/measure.h"
#include "tests/support/scheme_planets.h"

enum {
    BESIDE = 6, /* samples on a side and so many less one inside are told one by one */
    INSIDE = BESIDE,
    PLACES,
    WELL_INSIDE = 8,
    BORDER = 8, /* read beyond sides */
    LEAST = 32, /* cells of the coarsest level that is looked at */
    FRAME_N = 255,
    CODED = 10 /* rms of the pack by default, m */
};

static void *memory(size_t bytes)
{
    void *p = calloc(1, bytes);
    if (!p)
        exit(99);
    return p;
}

static void must(tc_status status, const tc_error *error)
{
    if (status) {
        fprintf(stderr, "bench_seams: %s\n", error->text);
        exit(1);
    }
}

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

typedef struct sums {
    double square, most, count;
} sums;

static void add(sums *s, double value)
{
    s->square += value * value, s->most = fmax(s->most, fabs(value)), s->count++;
}

static double rms(const sums *s)
{
    return s->count > 0 ? sqrt(s->square / s->count) : 0;
}

/* 0 on a side, 1 ... BESIDE - 1 samples inside, INSIDE; -1: between those. */
static int place_of(int64_t i, int64_t j, int64_t cells)
{
    int64_t d = tc_min64(tc_min64(i, cells - i), tc_min64(j, cells - j));
    return d < BESIDE ? (int)d : d >= WELL_INSIDE ? INSIDE : -1;
}

/* ---- Faces as planes --------------------------------------------------------------------------------------------- */

/* All samples of a face's level, and BORDER beyond its sides. */
typedef struct plane {
    int64_t cells;
    ptrdiff_t stride;
    float *memory, *z; /* z: of sample (0, 0) */
} plane;

static plane make_plane(int64_t cells)
{
    plane p = {.cells = cells, .stride = cells + 1 + 2 * BORDER};
    p.memory = memory((size_t)(p.stride * p.stride) * sizeof(float));
    p.z = p.memory + BORDER * p.stride + BORDER;
    return p;
}

static float at(const plane *p, int64_t i, int64_t j)
{
    return p->z[j * p->stride + i];
}

/* With what lies beyond the sides; beyond: false leaves that out. */
static plane read_plane(const tc_field *field, int level, bool beyond)
{
    plane p = make_plane(tc_field_level(field, level).width - 1);
    const tc_rect inside = {0, 0, p.cells + 1, p.cells + 1};
    if (tc_field_read(field, level, beyond ? tc_rect_grown(inside, BORDER) : inside, beyond ? p.memory : p.z, NULL,
                      p.stride))
        exit(1);
    return p;
}

/* Lets a plane go on beyond its sides in straight lines, as the codec's filters do. */
static void extend(plane *p)
{
    const int64_t n = p->cells;
    for (int64_t j = 0; j <= n; j++)
        for (int64_t k = 1; k <= 2; k++) {
            float *row = p->z + j * p->stride;
            row[-k] = row[0] - (float)k * (row[1] - row[0]), row[n + k] = row[n] + (float)k * (row[n] - row[n - 1]);
        }
    for (int64_t i = -2; i <= n + 2; i++)
        for (int64_t k = 1; k <= 2; k++) {
            float *first = p->z + i, *last = p->z + n * p->stride + i;
            first[-k * p->stride] = first[0] - (float)k * (first[p->stride] - first[0]);
            last[k * p->stride] = last[0] + (float)k * (last[0] - last[-p->stride]);
        }
}

/* What a level says of the next finer one, of twice as many samples; to be freed. */
static float *upsample(const plane *p)
{
    const int64_t size = p->cells + 1;
    float *fine = memory((size_t)(4 * size * size) * sizeof *fine),
          *scratch = memory((size_t)(2 * size * (size + 3)) * sizeof *scratch);
    tc_upsample(p->z, p->stride, size, size, fine, scratch);
    free(scratch);
    return fine;
}

/* ---- Files ------------------------------------------------------------------------------------------------------- */

static void pack(const tc_map *source, const tc_atlas *atlas, const char *path, tc_pack_options how)
{
    const tc_field *field = source->chart[0].field;
    const int levels = tc_field_info(field)->levels;
    const tc_level size = tc_field_level(field, levels);
    const tc_rect all = {0, 0, size.width, size.height};
    float *z = memory((size_t)tc_rect_area(all) * sizeof *z);
    tc_error error;
    if (tc_field_read(field, levels, all, z, NULL, size.width))
        exit(1);
    const double metres = source->chart[0].dx * source->body.radius, degrees = 360.0 / (double)size.width;
    const tc_chart *grid = &source->chart[0];
    const double turn = 180 / M_PI;
    tc_pack_terrain terrain = {.width = size.width,
                               .height = size.height,
                               .wraps_x = true,
                               .radius = source->body.radius,
                               .spacing_x = metres,
                               .spacing_y = metres,
                               .sample_type = TC_SAMPLE_FLOAT32,
                               .unit = 1,
                               .georef = {.known = true, .geographic = true, .semi_major = source->body.radius},
                               .area_registered = true};
    const double north = grid->y0 + ((double)size.height - 0.5) * grid->dy;
    const double t[6] = {turn * (grid->x0 - 0.5 * grid->dx), degrees, 0, turn * north, 0, -turn * grid->dy};
    memcpy(terrain.georef.transform, t, sizeof t);
    tc_packer *packer = NULL;
    tc_pack_result result;
    how.atlas = atlas->name;
    must(tc_packer_create(path, &terrain, &how, &packer, &error), &error);
    must(tc_packer_put(packer, all, z, NULL, size.width, &error), &error);
    must(tc_packer_finish(packer, &result, &error), &error);
    tc_packer_destroy(packer);
    free(z);
}

/* ---- Heights ----------------------------------------------------------------------------------------------------- */

typedef struct level_sums {
    sums apart[PLACES], detail[PLACES]; /* packed less memory; what the halving takes away */
    /* Second differences across sides in memory and packed, how far these are apart; and inside. */
    sums crease, packed_crease, crease_apart, bend;
    /* On sides, less memory: the owner's sample, the mean of both charts' own, their sum less the finer level's
     * filtered along the side; the last one in the middle eighth of sides alone, too. */
    sums owner, mean, both, both_in_the_middle;
    sums own_share, its_share; /* what each chart's filter moves a sample by */
    double product;            /* of those two */
    /* What memory has less the owner's, y, by what a reader knows: both charts' difference and the second difference
     * across, a and b. Next to the sides: as packed, and with 19/1024 of b, of what a line beyond takes of it. */
    double yy, ya, yb, aa, ab, bb;
    sums next, next_corrected;
} level_sums;

typedef struct subject {
    const char *planet;
    const tc_atlas *atlas;
    const tc_map *map, *packed;
    tc_field *own[TC_MAP_CHARTS]; /* charts of the file, not joined */
    double spacing;               /* metres between the finest samples */
    measure_options *options;
} subject;

static double across(const plane *p, int side, int64_t t)
{
    const bool along_y = side == TC_WEST || side == TC_EAST;
    const int64_t s = side == TC_EAST || side == TC_NORTH ? p->cells : 0, i = along_y ? s : t, j = along_y ? t : s;
    const int64_t x = along_y, y = !along_y;
    return (double)at(p, i - x, j - y) - 2 * (double)at(p, i, j) + (double)at(p, i + x, j + y);
}

static void compare_face(const plane *map, const plane *packed, const plane *finer, level_sums *l)
{
    const int64_t n = map->cells;
    float *up = upsample(map);
    for (int64_t j = 0; j <= 2 * n; j++)
        for (int64_t i = 0; i <= 2 * n; i++) {
            const int place = place_of(i / 2, j / 2, n);
            if (place >= 0)
                add(&l->detail[place], (double)at(finer, i, j) - (double)up[j * 2 * (n + 1) + i]);
        }
    free(up);
    for (int64_t j = 0; j <= n; j++)
        for (int64_t i = 0; i <= n; i++) {
            const int place = place_of(i, j, n);
            if (place >= 0)
                add(&l->apart[place], (double)at(packed, i, j) - (double)at(map, i, j));
            if (place == INSIDE) {
                add(&l->bend, (double)at(map, i - 1, j) - 2 * (double)at(map, i, j) + (double)at(map, i + 1, j));
                add(&l->bend, (double)at(map, i, j - 1) - 2 * (double)at(map, i, j) + (double)at(map, i, j + 1));
            }
        }
    for (int side = 0; side < TC_SIDES; side++)
        for (int64_t t = BORDER; t <= n - BORDER; t++) {
            const double truth = across(map, side, t), its = across(packed, side, t);
            add(&l->crease, truth), add(&l->packed_crease, its), add(&l->crease_apart, its - truth);
            const bool along_y = side == TC_WEST || side == TC_EAST;
            const int64_t one = side == TC_EAST || side == TC_NORTH ? n - 1 : 1, i = along_y ? one : t,
                          j = along_y ? t : one;
            const double off = (double)at(packed, i, j) - (double)at(map, i, j);
            add(&l->next, off), add(&l->next_corrected, off + 19. / 1024 * its);
        }
}

/* Samples of a side that is another chart's: what both charts have there, and the finer level's filtered along it. */
static void compare_side(const subject *s, int face, int side, const plane own[], const plane *map, const plane *packed,
                         const plane *finer, level_sums *l)
{
    const int64_t n = map->cells;
    const tc_seam seam = s->map->chart[face].class->seam(face, side, n);
    const bool along_y = side == TC_WEST || side == TC_EAST;
    const int64_t last = side == TC_EAST || side == TC_NORTH;
    if (seam.chart > face)
        return;
    float *line = memory((size_t)(2 * n + 1) * sizeof *line), *along = memory((size_t)(n + 1) * sizeof *along);
    float *scratch = memory(tc_downsample_scratch(2 * n + 1, 1) * sizeof *scratch);
    for (int64_t t = 0; t <= 2 * n; t++)
        line[t] = along_y ? at(finer, 2 * n * last, t) : at(finer, t, 2 * n * last);
    tc_downsample(line, 2 * n + 1, 1, false, 0, 1, along, scratch);
    for (int64_t t = BORDER; t <= n - BORDER; t++) {
        const int64_t i = along_y ? n * last : t, j = along_y ? t : n * last;
        const double truth = (double)at(map, i, j), e = (double)along[t], mine = (double)at(&own[face], i, j);
        const double its = (double)at(&own[seam.chart], seam.m[0] * i + seam.m[1] * j + seam.dx,
                                      seam.m[2] * i + seam.m[3] * j + seam.dy);
        const double y = truth - its, a = mine - its, b = across(packed, side, t);
        l->yy += y * y, l->ya += y * a, l->yb += y * b, l->aa += a * a, l->ab += a * b, l->bb += b * b;
        add(&l->owner, its - truth), add(&l->mean, 0.5 * (mine + its) - truth), add(&l->both, mine + its - e - truth);
        if (16 * llabs(2 * t - n) <= 2 * n)
            add(&l->both_in_the_middle, mine + its - e - truth);
        add(&l->own_share, mine - e), add(&l->its_share, its - e), l->product += (mine - e) * (its - e);
    }
    free(line), free(along), free(scratch);
}

static void print_level(const subject *s, int coarser, const level_sums *l)
{
    /* The finer level's cells times 0.28 n are the nearest that this one is drawn. */
    const double nearest = 0.28 * FRAME_N * ldexp(s->spacing, coarser - 1),
                 pixels = 480 / (2 * tan(M_PI / 6)) / nearest;
    double most = 0;
    printf("%s, %s, m - %d: packed from memory, rms (largest), beside those of the detail, m\n", s->planet,
           s->atlas->name, coarser);
    for (int k = 0; k < PLACES; k++) {
        const char *const where = k == INSIDE ? "inside" : k == 0 ? "on sides" : "beside";
        printf("    %-8s %d %9.3f (%8.2f) %9.3f (%8.1f)  %.3f\n", where, k, rms(&l->apart[k]), l->apart[k].most,
               rms(&l->detail[k]), l->detail[k].most, rms(&l->apart[k]) / rms(&l->detail[k]));
        most = fmax(most, l->apart[k].most);
        if (s->options->csv)
            fprintf(s->options->csv, "%s,%s,%d,%s,%d,%.5f,%.4f,%.5f,%.4f\n", s->planet, s->atlas->name, coarser,
                    k == INSIDE ? "inside" : "beside", k, rms(&l->apart[k]), l->apart[k].most, rms(&l->detail[k]),
                    l->detail[k].most);
    }
    printf(
        "    seen from where it is drawn at the nearest: rms on sides %.4f px, largest %.3f px; detail inside %.4f px,"
        " %.3f px\n",
        rms(&l->apart[0]) * pixels, most * pixels, rms(&l->detail[INSIDE]) * pixels, l->detail[INSIDE].most * pixels);
    printf("    second differences across sides: memory %.2f (largest %.1f), packed %.2f (%.1f), apart %.3f (%.2f);"
           " inside %.2f (%.1f)\n",
           rms(&l->crease), l->crease.most, rms(&l->packed_crease), l->packed_crease.most, rms(&l->crease_apart),
           l->crease_apart.most, rms(&l->bend), l->bend.most);
    printf("    on sides: owner's %.3f, mean of both %.3f, sum less the finer level along it %.3f (%.3f in the middle);"
           " correlation of what both filters do %.3f\n",
           rms(&l->owner), rms(&l->mean), rms(&l->both), rms(&l->both_in_the_middle),
           l->product / sqrt(l->own_share.square * l->its_share.square));
    const double rest = l->yy - (l->ya * l->ya * l->bb - 2 * l->ya * l->yb * l->ab + l->yb * l->yb * l->aa) /
                                    (l->aa * l->bb - l->ab * l->ab);
    printf(
        "    the best linear function of both charts' and of second differences %.3f; next to sides %.3f, with 19/1024"
        " of those %.3f\n",
        sqrt(rest / l->owner.count), rms(&l->next), rms(&l->next_corrected));
}

/* Returned: about the bits of a strip of corrections, of the samples on sides and next to them, that would leave an rms
 * of CODED: as many as Gaussian ones take, and a quarter of a bit more. */
static double measure_heights(const subject *s)
{
    double strip = 0;
    const int levels = tc_field_info(s->map->chart[0].field)->levels, charts = s->map->charts;
    const int64_t cells = tc_field_level(s->map->chart[0].field, levels).width - 1;
    for (int coarser = 1; (cells >> coarser) << coarser == cells && cells >> coarser >= LEAST; coarser++) {
        const int level = levels - coarser;
        level_sums l = {0};
        plane own[TC_MAP_CHARTS];
        for (int k = 0; k < charts; k++)
            own[k] = read_plane(s->own[k], level, false);
        for (int k = 0; k < charts; k++) {
            plane map = read_plane(s->map->chart[k].field, level, true),
                  packed = read_plane(s->packed->chart[k].field, level, true),
                  finer = read_plane(s->map->chart[k].field, level + 1, false);
            compare_face(&map, &packed, &finer, &l);
            for (int side = 0; side < TC_SIDES; side++)
                compare_side(s, k, side, own, &map, &packed, &finer, &l);
            free(map.memory), free(packed.memory), free(finer.memory);
        }
        for (int k = 0; k < charts; k++)
            free(own[k].memory);
        print_level(s, coarser, &l);
        for (int k = 0; k <= 1; k++) /* both charts have those on a side */
            strip += l.apart[k].count / (k == 0 ? 2 : 1) * (0.25 + fmax(0, log2(rms(&l.apart[k]) / CODED)));
    }
    return strip;
}

/* ---- Bytes ------------------------------------------------------------------------------------------------------- */

/* Details by distance from the side, of finer samples: predicted across sides from memory's coarser level, and from the
 * file's own one up to them. What bits that costs, if a detail twice as large costs one. */
static void measure_details(const subject *s)
{
    const int levels = tc_field_info(s->map->chart[0].field)->levels, charts = s->map->charts;
    const int64_t cells = tc_field_level(s->map->chart[0].field, levels).width - 1;
    double bits = 0, samples = 0, next_to = 0;
    for (int coarser = 1; (cells >> coarser) << coarser == cells && cells >> coarser >= LEAST; coarser++) {
        const int64_t n = cells >> (coarser - 1);
        sums over[PLACES] = {{0}}, up_to[PLACES] = {{0}};
        for (int k = 0; k < charts; k++)
            for (int own = 0; own <= 1; own++) {
                const tc_field *field = own ? s->own[k] : s->map->chart[k].field;
                plane coarse = read_plane(field, levels - coarser, !own),
                      fine = read_plane(field, levels - coarser + 1, false);
                if (own)
                    extend(&coarse);
                float *up = upsample(&coarse);
                for (int64_t j = 0; j <= n; j++)
                    for (int64_t i = j % 2 ? 0 : 1; i <= n; i += j % 2 ? 1 : 2) {
                        const int place = place_of(i, j, n);
                        if (place >= 0)
                            add(own ? &up_to[place] : &over[place],
                                (double)at(&fine, i, j) - (double)up[j * (n + 2) + i]);
                    }
                free(up), free(coarse.memory), free(fine.memory);
            }
        if (coarser == 1)
            printf("%s, %s: finest details, rms predicted from one side / across, m:", s->planet, s->atlas->name);
        for (int k = 0; k < PLACES; k++) {
            if (coarser == 1)
                printf(" %.2f/%.2f", rms(&up_to[k]), rms(&over[k]));
            if (k != INSIDE)
                bits += over[k].count * log2(rms(&up_to[k]) / rms(&over[k]));
        }
        samples += (double)charts * (double)(n + 1) * (double)(n + 1);
        next_to += (double)charts * 4 * 3 * (double)n;
    }
    printf("\n    bits more for that, over all samples: %.5f a sample; samples within 2 of a side: %.2f %%\n",
           bits / samples, 100 * next_to / samples);
}

static void measure_tiles(const subject *s, const char *path, double strip)
{
    double bytes[2] = {0}, samples[2] = {0}, finest_bytes[2] = {0}, finest_samples[2] = {0};
    tc_error error;
    for (int k = 0; k < s->map->charts; k++) {
        tc_byte_source source;
        tc_packed_file file = {0};
        must(tc_file_source(path, &source, &error), &error);
        must(tc_packed_file_open_bytes(path, &source, k, &file, &error), &error);
        const tc_container *c = &file.container;
        for (int l = c->base + 1; l <= c->levels; l++) {
            const tc_level *size = &c->level[l - 1];
            const tc_pages pages = tc_level_pages(size);
            const int64_t side = 2 * TC_TILE;
            for (int64_t ty = 0; ty < pages.tiles_y; ty++)
                for (int64_t tx = 0; tx < pages.tiles_x; tx++) {
                    tc_tile_entry entry;
                    if (tc_packed_file_entry(&file, l, tx, ty, &entry))
                        exit(1);
                    const tc_rect t = {tx * side, ty * side, tc_min64((tx + 1) * side, size->width),
                                       tc_min64((ty + 1) * side, size->height)};
                    /* A tile may have but the side itself: then the one before ends at it. */
                    const int touches = t.x0 == 0 || t.y0 == 0 || t.x1 >= size->width - 1 || t.y1 >= size->height - 1;
                    bytes[touches] += tc_tile_bytes(&entry), samples[touches] += (double)tc_rect_area(t);
                    if (l == c->levels)
                        finest_bytes[touches] += tc_tile_bytes(&entry),
                            finest_samples[touches] += (double)tc_rect_area(t);
                }
        }
        tc_packed_file_close(&file);
    }
    printf("%s, %s: bits a sample of the finest level's tiles that touch sides, %.0f %% of it, %.3f; of others %.3f;"
           " of all levels' %.3f, %.3f; a strip of corrections %.2f %% of %.0f bytes\n",
           s->planet, s->atlas->name, 100 * finest_samples[1] / (finest_samples[0] + finest_samples[1]),
           8 * finest_bytes[1] / finest_samples[1], 8 * finest_bytes[0] / fmax(finest_samples[0], 1),
           8 * bytes[1] / samples[1], 8 * bytes[0] / fmax(samples[0], 1), 100 * strip / 8 / (bytes[0] + bytes[1]),
           bytes[0] + bytes[1]);
}

/* ---- All --------------------------------------------------------------------------------------------------------- */

static void measure_planet(void *context, const scheme_planet *p)
{
    for (int k = 0; k < p->atlases; k++) {
        if (!p->own[k].atlas->class->seam)
            continue;
        subject s = {.planet = p->name, .atlas = p->own[k].atlas, .map = p->own[k].map, .options = context};
        const tc_field *field = s.map->chart[0].field;
        tc_error error;
        tc_map *packed;
        s.spacing =
            tc_chart_face_spacing(s.map->body.radius, tc_field_level(field, tc_field_info(field)->levels).width - 1);
        const char *path = made_path("seams.tclip");
        pack(p->source, s.atlas, path, (tc_pack_options){.mode = TC_PACK_RMS, .error = 0.01});
        must(tc_map_open(path, NULL, &packed, &error), &error);
        s.packed = packed;
        for (int n = 0; n < s.map->charts; n++) {
            tc_byte_source source;
            must(tc_file_source(path, &source, &error), &error);
            must(tc_packed_open_chart(path, &source, n, &(tc_open_options){0}, NULL, &s.own[n], &error), &error);
        }
        const double strip = measure_heights(&s);
        measure_details(&s);
        for (int n = 0; n < s.map->charts; n++)
            tc_field_destroy(s.own[n]);
        tc_map_destroy(packed);
        pack(p->source, s.atlas, path, (tc_pack_options){.mode = TC_PACK_RMS, .error = CODED, .max_error = 4 * CODED});
        measure_tiles(&s, path, strip);
        fflush(stdout);
    }
}

int main(int argc, char **argv)
{
    measure_options options = measure_begin(
        argc, argv, "planet,atlas,coarser,where,samples,apart_rms_m,apart_max_m,detail_rms_m,detail_max_m");
    scheme_planets(options.quick, measure_planet, &options);
    made_folder_remove();
    return measure_end(&options);
}
