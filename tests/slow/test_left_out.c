/* test_left_out.c - of what a scene does not need there is no trace: no texture, no uniform, no shader text, no draw,
 * no thread, no library. Scenes that need everything show that the check would find each of them. */
#include "tests/support/test.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/packed/read/prefetch.h"
#include "common/app/explain.h"
#include "common/input/plugin.h"
#include "common/app/load.h"
#include "tests/support/lean_scenes.h"
#include "tests/support/made_files.h"

enum { WIDTH = 160, HEIGHT = 120 };

static tc_context *context;

/* ---- Parts of programs ------------------------------------------------------------------------------------------ */

/* How a part shows: words in what the compiler sees, samplers, textures. 0, NULL: not that way. Levels finer than the
 * data show in the windows. */
static const struct trace {
    const char *name, *text, *sampler;
    GLenum texture, or_texture;
} traces[LEAN_PARTS] = {
    {"light", "float ambient", NULL, 0, 0},
    {"sky", "v_ray", NULL, 0, 0},
    {"haze", "surface_haze", NULL, 0, 0},
    {"holes", "bool hole", "voids_map", GL_R8, 0},
    {"land", "0.135, 0.115, 0.095", NULL, 0, 0},
    {"water", "bool sea", NULL, 0, 0},
    {"level colours", "hues", NULL, 0, 0},
    {"samples", "#define MULTISAMPLED", "samples_map", 0, 0},
    {"closers", "#define INTERPOLATED flat", NULL, 0, 0},
    {"sphere", "#define APRON", NULL, 0, 0},
    {"imagery", "image_colour", "image_map", GL_SRGB8_ALPHA8, 0},
    {"synthesis", NULL, NULL, 0, 0},
    {"normals", "vec3 normal", "normals_map", GL_RGBA8_SNORM, GL_RGBA16_SNORM},
    {"fine normals", "#define FINE_NORMALS", NULL, GL_RGBA16_SNORM, 0},
    {"angles", "shade_degrees", NULL, 0, 0},
    {"hillshade", "float hillshade", NULL, 0, 0},
    {"contours", "contoured", NULL, 0, 0},
    {"tolerance", "#define TOLERANCE", NULL, 0, 0},
    {"exaggeration", "#define EXAGGERATED", NULL, 0, 0},
    {"walls", "vec3 v_wall", NULL, 0, 0},
    {"sea around", "0.85 / heights.y", NULL, 0, 0},
    {"stars", "vec3 starlight", NULL, 0, 0},
    {"climate", "vec3 zoned", NULL, 0, 0},
};

static bool multisampled(const gl_record *r)
{
    for (int i = 0; i < GL_RECORD_OBJECTS; i++)
        if (r->textures[i].samples > 1)
            return true;
    return false;
}

/* Whether windows are finer than the ground's data. */
static bool finer_than_data(const scene *s, const lean_scene *l)
{
    const tc_clipmap *c = tc_renderer_used(s->renderer).windows->clipmap[0];
    return tc_clipmap_field_level(c, tc_clipmap_levels(c)) > lean_data_levels(l->ground);
}

/* The parts that a scene shows; a part must show in all its ways or in none. Land without light and smooth edges where
 * no place in a normal map needs them leave only the define. */
static unsigned shown(const tc_gl *gl, const gl_record *r, const scene *s, const lean_scene *l)
{
    unsigned parts = 0;
    for (int i = 0; i < LEAN_PARTS; i++) {
        const struct trace *t = &traces[i];
        bool rock = 1u << i == LEAN_LAND && !(l->needs & LEAN_LIGHT);
        bool text = t->text ? gl_record_has_text(r, rock ? "#define NATURAL_LAND" : t->text) : finer_than_data(s, l);
        bool sampler = t->sampler ? gl_record_has_uniform(gl, r, t->sampler) : text;
        bool texture = t->texture
                           ? gl_record_texture(r, t->texture) || (t->or_texture && gl_record_texture(r, t->or_texture))
                           : text;
        if (1u << i == LEAN_SAMPLES)
            texture = multisampled(r);
        if (text != sampler || text != texture)
            fail_msg("%s: %s shows by text %d, sampler %d, texture %d", l->name, t->name, text, sampler, texture);
        parts |= text ? 1u << i : 0;
    }
    return parts;
}

static void assert_parts(const char *scene_name, unsigned found, unsigned expected)
{
    for (int i = 0; i < LEAN_PARTS; i++)
        if ((found ^ expected) >> i & 1)
            fail_msg("%s: %s %s", scene_name, traces[i].name,
                     expected >> i & 1 ? "is needed and not there" : "is there without need");
}

/* ---- Telling ---------------------------------------------------------------------------------------------------- */

static bool told(const tc_left_out *list, const char *start)
{
    for (int i = 0; i < list->count; i++)
        if (strncmp(list->lines[i], start, strlen(start)) == 0)
            return true;
    return false;
}

/* What is told of a scene is what it needs. */
static void assert_told(const lean_scene *l, const tc_renderer *renderer)
{
    static const char *const lines[LEAN_PARTS] = {
        [0] = "lighting",   [1] = "sky",           [3] = "void mask", [4] = "rock",
        [5] = "water",      [6] = "level colours", [7] = "smooth",    [10] = "imagery",
        [11] = "synthesis", [12] = "normal map",   [16] = "contours", [18] = "exaggeration",
        [19] = "walls",     [20] = "sea around",   [21] = "stars",    [22] = "climate"};
    static tc_left_out list;
    tc_explain_left_out(renderer, &list);
    assert_true(list.count > 0 && list.lines[list.count] == NULL);
    for (int i = 0; i < LEAN_PARTS; i++)
        if (lines[i] && told(&list, lines[i]) == (l->needs >> i & 1))
            fail_msg("%s: of %s it is told what is not so", l->name, traces[i].name);
    assert_int_equal(told(&list, "morph"), l->options.frame.no_morph);
    assert_int_equal(told(&list, "haze") || told(&list, "sky and haze"), !(l->needs & LEAN_HAZE));
    assert_int_equal(told(&list, "crack closers"), l->ground == LEAN_POND);
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    assert_non_null(file);
    tc_explain_uses(renderer, file);
    fclose(file);
    for (const char *line = text; *line; line = strchr(line, '\n') + 1)
        assert_memory_equal(line, "uses: ", 6);
    assert_int_equal(strstr(text, "normals: RGBA") != NULL, (l->needs & LEAN_NORMALS) != 0);
    assert_int_equal(strstr(text, "fine normals: RGBA16_SNORM") != NULL, (l->needs & LEAN_FINE_NORMALS) != 0);
    const unsigned mapped = LEAN_ANGLES | LEAN_HILLSHADE | LEAN_CONTOURS;
    assert_int_equal(strstr(text, "shade.glsl") != NULL, (l->needs & mapped) != 0);
    assert_int_equal(strstr(text, ", LIT") != NULL, (l->needs & LEAN_LIGHT) != 0);
    assert_int_equal(strstr(text, "texture: voids") != NULL, (l->needs & LEAN_HOLES) != 0);
    assert_int_equal(strstr(text, "synthesis: ") != NULL, (l->needs & LEAN_DETAIL) != 0);
    free(text);
}

/* ---- Scenes ----------------------------------------------------------------------------------------------------- */

static void programs_hold_what_is_needed(void **state)
{
    (void)state;
    unsigned all = 0, none = 0;
    for (int k = 0; k < LEAN_SCENES; k++) {
        const lean_scene *l = &lean_scenes[k];
        gl_record r = {.add = NULL};
        tc_gl gl = gl_record_begin(tc_context_gl(context), &r);
        scene s = lean_create(&gl, l, &l->options, NULL);
        tc_camera c = lean_camera(l, WIDTH, HEIGHT);
        tc_frame_stats f = scene_draw(&s, &c, true);
        assert_true(r.draws > 0 && f.triangles > 0);
        unsigned parts = shown(&gl, &r, &s, l);
        assert_parts(l->name, parts, l->needs);
        all |= parts, none |= ~parts;
        /* Colours are in all of them; so the check for samplers and textures is no check of nothing. */
        assert_true(gl_record_has_uniform(&gl, &r, "heights_map") && gl_record_has_uniform(&gl, &r, "ramp_map"));
        assert_non_null(gl_record_texture(&r, GL_RG32F));
        assert_non_null(gl_record_texture(&r, l->needs & LEAN_ANGLES ? GL_RGBA16 : GL_RGBA8));
        assert_int_equal(gl_record_has_text(&r, "in_instance"), !lean_sphere(l->ground));
        assert_told(l, s.renderer);
        scene_destroy(&s);
        assert_int_equal(gl_record_bytes(&r), 0);
        gl_record_end(&r);
    }
    assert_int_equal(all, (1u << LEAN_PARTS) - 1); /* each was found, */
    assert_int_equal(none & all, all);             /* and each was left out somewhere */
}

/* A part forced into a scene that does not need it is found by the same look. */
static void what_is_there_without_need_is_found(void **state)
{
    (void)state;
    static const struct {
        const char *define;
        unsigned part;
    } faults[] = {{"HAZE", LEAN_HAZE}, {"WATER", LEAN_WATER}};
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        const lean_scene *l = &lean_scenes[0];
        gl_record r = {.add = faults[i].define};
        tc_gl gl = gl_record_begin(tc_context_gl(context), &r);
        scene s = lean_create(&gl, l, &l->options, NULL);
        tc_camera c = lean_camera(l, WIDTH, HEIGHT);
        scene_draw(&s, &c, true);
        assert_int_equal(shown(&gl, &r, &s, l), l->needs | faults[i].part);
        scene_destroy(&s);
        gl_record_end(&r);
    }
}

/* ---- Levels, charts, draws -------------------------------------------------------------------------------------- */

static const lean_scene *named(const char *name)
{
    for (int k = 0; k < LEAN_SCENES; k++)
        if (strcmp(lean_scenes[k].name, name) == 0)
            return &lean_scenes[k];
    fail_msg("no scene %s", name);
    return NULL;
}

/* What a frame of a scene leaves in its textures, its windows and its draws. */
typedef struct extent {
    int layers, of, charts, updated;
    tc_frame_stats frame;
    int draws;
} extent;

static extent extent_of(const char *name)
{
    const lean_scene *l = named(name);
    gl_record r = {.add = NULL};
    tc_gl gl = gl_record_begin(tc_context_gl(context), &r);
    scene s = lean_create(&gl, l, &l->options, NULL);
    tc_camera c = lean_camera(l, WIDTH, HEIGHT);
    extent e = {0};
    scene_draw(&s, &c, true);
    r.draws = 0;
    e.frame = scene_draw(&s, &c, false);
    e.draws = r.draws;
    e.layers = gl_record_texture(&r, GL_RG32F)->depth;
    assert_int_equal(gl_record_texture(&r, GL_RGBA8_SNORM)->depth, e.layers);
    const tc_windows *windows = tc_renderer_used(s.renderer).windows;
    for (int chart = 0; chart < windows->charts; chart++) {
        e.charts += tc_renderer_used(s.renderer).textures->layers.held[chart] > 0;
        e.of += tc_clipmap_levels(windows->clipmap[chart]);
        for (int level = 2; level <= tc_clipmap_levels(windows->clipmap[chart]); level++) {
            tc_rect clip = tc_clipmap_level(windows->clipmap[chart], level)->clip;
            e.updated += clip.x1 > clip.x0;
        }
    }
    scene_destroy(&s);
    gl_record_end(&r);
    return e;
}

static void what_is_out_of_sight_is_not_there(void **state)
{
    (void)state;
    extent ground = extent_of("ground"), high = extent_of("high");
    assert_true(ground.layers == ground.of && ground.of > 3);
    assert_int_equal(ground.updated, ground.of - 1);
    assert_int_equal(ground.frame.levels_fine, 0);
    assert_true(high.layers == 1 && high.updated == 0 && high.frame.levels_fine == high.of - 1);
    assert_true(ground.frame.blocks < ground.frame.blocks_unculled / 2);
    extent space = extent_of("planet-space"), low = extent_of("planet-ground"), pole = extent_of("planet-pole");
    extent all = extent_of("planet-everything");
    assert_int_equal(space.charts, 3);
    assert_int_equal(low.charts, 1);
    assert_int_equal(pole.charts, 1);
    assert_int_equal(all.charts, 3);
    assert_true(pole.layers < low.layers && low.layers < low.of);
    assert_true(low.frame.levels_beyond > 0 && pole.frame.levels_beyond > 0 && all.frame.levels_beyond == 0);
    assert_true(space.frame.levels_fine > low.frame.levels_fine);
    assert_true(low.frame.blocks < low.frame.blocks_unculled / 2);
    assert_int_equal(all.frame.blocks, all.frame.blocks_unculled);
    const extent *const each[] = {&ground, &high, &space, &low, &pole, &all};
    for (int i = 0; i < 6; i++)
        assert_int_equal(each[i]->draws, each[i]->frame.draws);
}

/* Textures grow on the way; a picture does not depend on it, and the same way once more makes none. */
static void growing_changes_no_picture(void **state)
{
    (void)state;
    static const char *const ways[2][4] = {{"high", "ground", "no-holes", "high"},
                                           {"planet-space", "planet-ground", "planet-pole", "planet-space"}};
    for (int way = 0; way < 2; way++) {
        gl_record r = {.add = NULL}, other = {.add = NULL};
        tc_gl gl = gl_record_begin(tc_context_gl(context), &r);
        const lean_scene *first = named(ways[way][way ? 2 : 0]); /* from where least is seen */
        scene s = lean_create(&gl, first, &(tc_scene_options){.budget = -1}, NULL);
        tc_camera c = lean_camera(first, WIDTH, HEIGHT);
        scene_draw(&s, &c, true);
        int made = r.textures_made, before = gl_record_texture(&r, GL_RG32F)->depth;
        for (int turn = 0; turn < 2; turn++) {
            for (int k = 0; k < 4; k++) {
                const lean_scene *l = named(ways[way][k]);
                c = lean_camera(l, WIDTH, HEIGHT);
                gl_record_on(&r);
                scene_draw(&s, &c, true);
                if (turn > 0)
                    continue;
                uint8_t *travelled = scene_pixels(&s, &c);
                tc_gl fresh = gl_record_begin(tc_context_gl(context), &other);
                scene alone = lean_create(&fresh, l, &(tc_scene_options){.budget = -1}, NULL);
                scene_draw(&alone, &c, true);
                uint8_t *direct = scene_pixels(&alone, &c);
                assert_memory_equal(travelled, direct, (size_t)WIDTH * HEIGHT * 3);
                free(travelled);
                free(direct);
                scene_destroy(&alone);
                gl_record_end(&other);
            }
            if (turn == 0) {
                assert_true(r.textures_made > made);
                assert_true(gl_record_texture(&r, GL_RG32F)->depth > before);
                made = r.textures_made;
            }
        }
        assert_int_equal(r.textures_made, made);
        gl_record_on(&r);
        scene_destroy(&s);
        assert_int_equal(gl_record_bytes(&r), 0);
        gl_record_end(&r);
    }
}

/* ---- Threads and libraries -------------------------------------------------------------------------------------- */

/* Threads of this process, or those of a name. */
static int threads(const char *name)
{
    DIR *tasks = opendir("/proc/self/task");
    assert_non_null(tasks);
    int count = 0;
    for (struct dirent *e; (e = readdir(tasks));) {
        char path[300], comm[32] = "";
        if (e->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "/proc/self/task/%s/comm", e->d_name);
        FILE *file = fopen(path, "r");
        if (!file)
            continue; /* gone meanwhile */
        if (fgets(comm, sizeof comm, file))
            comm[strcspn(comm, "\n")] = '\0';
        count += !name || strcmp(comm, name) == 0;
        fclose(file);
    }
    closedir(tasks);
    return count;
}

/* One that has been waited for may be listed a moment longer. */
static void assert_threads(const char *name, int expected)
{
    for (int tries = 0; threads(name) != expected && tries < 1000; tries++)
        usleep(1000);
    assert_int_equal(threads(name), expected);
}

static bool mapped(const char *library)
{
    FILE *file = fopen("/proc/self/maps", "r");
    assert_non_null(file);
    char line[4096];
    bool found = false;
    while (fgets(line, sizeof line, file))
        found = found || strstr(line, library);
    fclose(file);
    return found;
}

static void draw_a_flight(scene *s, const lean_scene *l, bool finish)
{
    tc_camera c = lean_camera(l, WIDTH, HEIGHT);
    for (int i = 0; i < 20; i++, c.x += 300) {
        tc_frame_stats f;
        assert_int_equal(tc_renderer_frame(s->renderer, &c, finish, &f, NULL), TC_OK);
    }
}

static void threads_are_started_when_needed(void **state)
{
    (void)state;
    const lean_scene *memory = named("ground"), *packed = named("packed");
    int before = threads(NULL);
    lean_free_all(); /* made anew: by several threads, none of which stays */
    lean_atlas(memory->ground);
    lean_atlas(packed->ground);
    assert_threads(NULL, before);
    scene s = lean_create(tc_context_gl(context), memory, &memory->options, NULL);
    draw_a_flight(&s, memory, false);
    assert_int_equal(threads(TC_PREFETCH_NAME), 0);
    scene_destroy(&s);
    s = lean_create(tc_context_gl(context), packed, &packed->options, NULL);
    draw_a_flight(&s, packed, true); /* waits for what it needs */
    assert_int_equal(threads(TC_PREFETCH_NAME), 0);
    scene_destroy(&s);
    lean_free_all(); /* nothing of it is decoded */
    s = lean_create(tc_context_gl(context), packed, &packed->options, NULL);
    draw_a_flight(&s, packed, false); /* as a window does */
    const long spare = sysconf(_SC_NPROCESSORS_ONLN) - 1;
    assert_in_range(threads(TC_PREFETCH_NAME), 1, spare > 1 ? spare : 1);
    scene_destroy(&s);
    lean_free_all();
    assert_threads(TC_PREFETCH_NAME, 0);
}

static void opens(const char *path)
{
    tc_map *map;
    tc_error error;
    if (tc_map_load(path, &(tc_source_options){.spacing = 30}, NULL, &map, &error) != TC_OK)
        fail_msg("%s", error.text);
    tc_map_destroy(map);
}

static void libraries_are_loaded_when_needed(void **state)
{
    (void)state;
    static int16_t samples[1201 * 1201];
    make_hgt(made_path("N46E008.hgt"), 1201, samples);
    opens(made_path("N46E008.hgt"));
    lean_atlas(LEAN_PACKED);
    const tc_scene_options options = {0};
    scene s = lean_create(tc_context_gl(context), named("packed"), &options, NULL);
    draw_a_flight(&s, named("packed"), true);
    scene_destroy(&s);
    assert_false(mapped("libgdal") || mapped("OpenImageIO") || mapped("libglfw"));
    assert_false(tc_plugin_loaded("gdal") || tc_plugin_loaded("oiio") || tc_plugin_loaded("window"));
    static const float heights[8 * 8] = {1};
    make_tiff(made_path("a.tif"),
              &(made_tiff){.width = 8, .height = 8, .bits = 32, .format = MADE_FLOAT, .samples = heights});
    opens(made_path("a.tif"));
    assert_true(mapped("libgdal") && tc_plugin_loaded("gdal"));
    assert_false(mapped("libOpenImageIO") || mapped("libglfw"));
    make_exr(made_path("a.exr"), 8, 8, heights);
    opens(made_path("a.exr"));
    assert_true(mapped("libOpenImageIO") && tc_plugin_loaded("oiio"));
    assert_false(mapped("libglfw"));
}

/* ---- All -------------------------------------------------------------------------------------------------------- */

static int set_up(void **state)
{
    (void)state;
    context = scene_context();
    return context ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    lean_free_all();
    tc_context_destroy(context);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(programs_hold_what_is_needed),
        cmocka_unit_test(what_is_there_without_need_is_found),
        cmocka_unit_test(what_is_out_of_sight_is_not_there),
        cmocka_unit_test(growing_changes_no_picture),
        cmocka_unit_test(threads_are_started_when_needed),
        /* The last: they stay. */
        cmocka_unit_test(libraries_are_loaded_when_needed),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
