/* viewer_internal.h - what the files of the viewer share. Internal to viewer*.c. */
#ifndef TC_VIEWER_INTERNAL_H
#define TC_VIEWER_INTERNAL_H

#include "common/base/outputs.h"
#include "common/window/clipmap.h"
#include "common/render/surface.h"
#include "common/base/clock.h"
#include "common/gl/context.h"
#include "common/view/flight.h"
#include "common/view/flight_path.h"
#include "common/view/pick.h"
#include "common/view/quality.h"
#include "common/view/throttle.h"
#include "credits.h"
#include "load.h"
#include "options.h"
#include "common/render/renderer.h"
#include "stats.h"
#include "viewer.h"
#include "window.h"
#include "display.h"

struct tc_kept_text;
struct tc_viewer_display;

enum { TC_VIEWER_LISTED = 9 }; /* views that have a key: 1 to 9 */

typedef struct tc_viewer {
    const tc_viewer_program *program;
    tc_options options;

    tc_map *map;
    tc_surface *surface;
    int surface_size;    /* as its scheme says it, */
    tc_camera sized_for; /* for a frame of such a size and angle */
    int halvings;        /* of that which the frame calls for, since the driver had no memory */
    tc_ground ground;
    double spacing;      /* metres; the smaller of the finest level's two */
    double least_height; /* metres that the eye keeps above the ground */
    bool lifted;         /* it was under it */
    bool failing;        /* a window has said that a part of the terrain cannot be read at the moment */

    struct tc_viewer_work *work; /* that is waited for; NULL: none */
    bool waited;                 /* and the window's events were not heard meanwhile */
    bool writing;                /* it is a program of its own, which ends what it writes */
    bool closed;                 /* the window was, meanwhile: the program is to end */

    tc_context *context; /* offscreen, or NULL and a window: */
    const struct tc_window_plugin *window_plugin;
    tc_window *window;
    tc_gl window_gl;
    const tc_gl *gl; /* of either */
    tc_renderer *renderer;

    tc_scene_options scene; /* as it is now: keys and what frames took change it */
    tc_throttle throttle;   /* of --target-ms, where each frame counts */
    double recent_ms;       /* that a window's frames took of late */
    tc_quality quality;     /* of a window's frames */
    struct tc_shown {
        tc_camera camera;
        tc_scene_options scene;
        const tc_renderer *renderer;
    } shown;                                     /* what its last frame was drawn of */
    tc_colour_ramp colours;                      /* of the options; count 0: none */
    tc_imagery *imagery;                         /* likewise; NULL: none */
    tc_credits terrain_credits, imagery_credits; /* of the files that they were loaded from */
    tc_surroundings around;                      /* of the map */
    tc_camera camera;
    tc_flight_path path; /* no keys: none */
    tc_outputs outputs;  /* files to be written, none of which may be read */
    tc_stats *stats;
    struct tc_viewer_display *display; /* NULL: the window has none */
    struct tc_kept_text *kept;         /* that options point to, beside the command line's */
    struct tc_listed_view {
        tc_pose view;
        char name[48];          /* cut where it is longer; "" none */
    } listed[TC_VIEWER_LISTED]; /* the first ones of the file of views */
    int listed_count;
} tc_viewer;

/* The terrain, in the charts that the scheme draws, and its pictures; and what frees both (viewer_terrain.c). */
tc_status tc_viewer_load(tc_viewer *viewer, tc_error *error);
void tc_viewer_unload(tc_viewer *viewer);
tc_status tc_viewer_load_terrain(tc_viewer *viewer, tc_error *error); /* of it only that, or */
tc_status tc_viewer_load_imagery(tc_viewer *viewer, tc_error *error); /* only the pictures */

/* ---- What takes long (viewer_work.c) ----------------------------------------------------------------------------- */

/* Does work that needs no OpenGL. Where there is, or will be, a window that a person sees, on a thread of its own:
 * meanwhile the window tells how far it is, over the last picture of `behind`, the viewer as it was (NULL: over
 * nothing). It is opened for that where it is not there yet and the work goes on for more than a moment; where it
 * cannot be opened, that fails. Who closes it ends the work: viewer->closed, and TC_ERR_IO unless all was done by then;
 * so does an interrupt. The process ends by itself where the work does not, with what it has to report. */
tc_status tc_viewer_wait(tc_viewer *viewer, tc_status (*work)(tc_viewer *, tc_error *), const tc_viewer *behind,
                         tc_error *error);

/* Hears of work what is done and its share, 0 to 1, or negative where that is not known; on any thread. False: it is to
 * stop. context: the viewer. */
bool tc_viewer_progress(void *context, const char *what, double share);

/* Writes --stats, prints --json and --explain, and what could not be shown; where nothing was drawn, that there are no
 * figures. And the end: says what failed; the exit code (viewer.c). */
tc_status tc_viewer_report(const tc_viewer *viewer, tc_error *error);
int tc_viewer_end(const tc_viewer_program *program, tc_status status, tc_error *error);

/* Opens the viewer's window, unless it is (viewer.c). */
tc_status tc_viewer_open_window(tc_viewer *viewer, tc_error *error);

/* ---- Changes while it runs (viewer_change.c, viewer_drop.c) ------------------------------------------------------ */

/* What is asked for; its texts outlive the viewer's (tc_viewer_keep). */
typedef struct tc_viewer_wish {
    tc_options options;
    tc_scene_options scene;
} tc_viewer_wish;
tc_viewer_wish tc_viewer_wish_now(const tc_viewer *viewer);

/* Loads what has to be loaded for that, and draws it. On failure all is as it was; where not even that can be drawn any
 * more there is no renderer. */
tc_status tc_viewer_adopt(tc_viewer *viewer, const tc_viewer_wish *wish, tc_error *error);

/* A copy of a text that lives as long as the viewer; NULL: no memory. */
const char *tc_viewer_keep(tc_viewer *viewer, const char *text);
void tc_viewer_forget_kept(tc_viewer *viewer);

/* Shows a file, whatever it is: a terrain in place of the present one, seen as a whole (*opened_ret, *view_ret), or a
 * picture laid over what there is. picture: it is rather to be a picture. *error says why it is neither. */
tc_status tc_viewer_drop(tc_viewer *viewer, const char *path, bool picture, bool *opened_ret, tc_pose *view_ret,
                         tc_error *error);

/* The view that shows the whole of the terrain. */
tc_pose tc_viewer_whole(const tc_viewer *viewer);

/* The program's next scheme after one; and drawing by another one at the same view: reads the file anew where that
 * draws other charts. On failure all is as it was. */
const tc_scheme *tc_viewer_scheme_after(const tc_viewer *viewer, const tc_scheme *scheme);
tc_status tc_viewer_change_scheme(tc_viewer *viewer, const tc_scheme *scheme, tc_error *error);

/* Puts the camera where the view says; above the ground of a planet. */
void tc_viewer_place(tc_viewer *viewer, const tc_pose *view);

/* Whether a place beside a flat map lies in a sea that is given, whose height that is. */
bool tc_viewer_at_sea(const tc_viewer *viewer, double x, double y, double *z_ret);

/* The map as a whole, for navigation. */
tc_flight_box tc_viewer_box(const tc_viewer *viewer);

/* Says once that the eye was so many metres under the ground, where it was. */
void tc_viewer_say_lifted(tc_viewer *viewer, double below);

/* Where the eye starts, above the ground, once the terrain and the frame are there: by a path, which is read, a view, a
 * place to look at, or with all of the terrain in sight. What looks like a mistake is said (viewer_look.c). */
tc_status tc_viewer_first_view(tc_viewer *viewer, tc_pose *view_ret, tc_error *error);
/* What is looked at, in frames of the camera's size (viewer_place.c). */
tc_scenery tc_viewer_scenery(const tc_viewer *viewer);

/* With --views: reads that file, and the view that --view @NAME asks for; and adds a view to it, or prints it where
 * there is no such file or nothing can be added, which is said (viewer_views.c). */
tc_status tc_viewer_begin_views(tc_viewer *viewer, tc_error *error);
void tc_viewer_keep_view(tc_viewer *viewer, tc_pose *view);

/* View number `number`, from 1, of that file as it is now, told by its name; false where there is none, which is told.
 */
bool tc_viewer_listed_view(tc_viewer *viewer, int number, tc_pose *view_ret);

/* Whether what is drawn is kept, as pictures or a film: then it takes the time that it needs. */
bool tc_viewer_keeps(const tc_options *options);

/* Whether there is to be a window that a person sees. */
bool tc_viewer_interactive(const tc_options *options);

/* The surface and what draws it, as large as frame and machine call for, or smaller where the driver has no memory for
 * that; in place of those that there are (viewer_scene.c). */
tc_status tc_viewer_make_surface(tc_viewer *viewer, tc_error *error);

/* Frees what draws and then the surface, where there are any. */
void tc_viewer_destroy_scene(tc_viewer *viewer);

/* The way of drawing that was asked for, or the program's first one. */
const tc_scheme *tc_viewer_scheme(const tc_viewer *viewer);

/* Draws a frame of viewer->camera. Where the frame has become so much larger or smaller that another size of the mesh
 * is called for, or the driver has no memory for it, the surface is made anew. finish: as in tc_renderer_frame(). */
tc_status tc_viewer_frame(tc_viewer *viewer, bool finish, tc_frame_stats *frame_ret, tc_error *error);

/* What is shown around the map as it is: sets viewer->around. */
tc_status tc_viewer_look_around(tc_viewer *viewer, tc_error *error);

/* With --date: the sun over the map as it is, of the scene. Where it is not known for the map all is as it was
 * (viewer_sun.c). */
tc_status tc_viewer_settle_sun(tc_viewer *viewer, tc_error *error);

/* The sun that there is, as from the place of the eye. */
tc_sun tc_viewer_sun(const tc_viewer *viewer);

/* Draws heights so many times as high as they are, from now on, at the same view, which is lifted where it would be
 * below the ground. Where that cannot be, all is as it was; but where viewer->renderer is then NULL, nothing can be
 * drawn any more. */
tc_status tc_viewer_exaggerate(tc_viewer *viewer, double factor, tc_error *error);

/* Likewise with the sea there. */
tc_status tc_viewer_flood(tc_viewer *viewer, tc_sea sea, tc_error *error);

/* With --target-ms: hears what a frame took, and how coarse the next one is to be drawn. */
void tc_viewer_throttle(tc_viewer *viewer, double frame_ms);

/* A window's frames (viewer_quality.c): how well they are drawn; whether the next one, dt seconds after the last, is to
 * be drawn at all, and what one took, milliseconds; and one at its best. */
bool tc_viewer_coarsens(const tc_viewer *viewer); /* its frames may be throttled */
void tc_viewer_quality_begin(tc_viewer *viewer);
bool tc_viewer_quality_before(tc_viewer *viewer, double dt);
void tc_viewer_quality_drawn(tc_viewer *viewer, const tc_frame_stats *frame);
tc_status tc_viewer_best_frame(tc_viewer *viewer, tc_error *error);

/* Draws one frame of viewer->camera, waits for it and counts it as a measured one. */
tc_status tc_viewer_measured_frame(tc_viewer *viewer, tc_frame_stats *frame_ret, tc_error *error);

/* Draws until a frame has all that its view needs; that frame is finished and counted as a measured one. */
tc_status tc_viewer_resident_frame(tc_viewer *viewer, tc_error *error);

/* Writes the last frame; rgb has room for it. */
tc_status tc_viewer_write_frame(tc_viewer *viewer, const char *path, uint8_t *rgb, tc_error *error);

/* One picture, a flight written or a flight measured (viewer_offscreen.c); the loop of a window (viewer_window.c). */
tc_status tc_viewer_picture(tc_viewer *viewer, tc_error *error);
tc_status tc_viewer_flight(tc_viewer *viewer, tc_error *error);
tc_status tc_viewer_window(tc_viewer *viewer, tc_error *error);

/* ---- What is told (viewer_tell.c, viewer_display.c) -------------------------------------------------------------- */

typedef enum tc_told {
    TC_TOLD_DONE,    /* what a key did: the line alone */
    TC_TOLD_WARNING, /* with the program's name; neither of them with -q */
    TC_TOLD_FAILURE  /* likewise, always */
} tc_told;

/* Tells the user one line: on the terminal, and for some seconds in the window. */
void tc_viewer_tell(tc_viewer *viewer, tc_told how, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Tells of files that fell on the window beside as many as it takes at once. */
void tc_viewer_tell_left_out(tc_viewer *viewer, const tc_window_input *input);

/* What is told after each frame: in the title, warnings of what cannot be read, and figures once a second. */
typedef struct tc_telling {
    bool figures; /* are told; on the terminal */
    double title_since, figures_since, damage_since;
    int64_t damaged; /* tiles, as it was said last */
} tc_telling;
void tc_viewer_tell_figures(tc_telling *telling, bool on);
void tc_viewer_tell_frame(tc_viewer *viewer, tc_telling *telling, const tc_frame_stats *frame);

/* A file's name without its folders, for a line. */
const char *tc_viewer_file_name(const char *path);

/* What a key's label and help are, by number (viewer_window.c); false: there are no more. */
bool tc_viewer_key(int k, const char **label_ret, const char **help_ret);

/* A display for the viewer's window, where the options have one. */
tc_status tc_viewer_display_open(tc_viewer *viewer, tc_error *error);
void tc_viewer_display_close(tc_viewer *viewer);

/* A line for it, where there is one. */
void tc_viewer_display_line(tc_viewer *viewer, bool warning, const char *text);

/* Draws it over the frame just drawn, before it is shown. */
void tc_viewer_display_show(tc_viewer *viewer, const tc_frame_stats *frame);

/* Draws it over what is there with what is waited for, alone. */
void tc_viewer_display_work(tc_viewer *viewer, const tc_display_work *work);

/* Does what the user did in it and with files that fell on the window, once the frame is shown. True: there is another
 * terrain, to be seen by *view_ret. *key_ret: the key of what was clicked (compass: N, a view: its number); 0: none.
 * There may be no renderer any more. */
bool tc_viewer_display_act(tc_viewer *viewer, const tc_window_input *input, tc_pose *view_ret, int *key_ret);

/* Keys. Help: false where there is no display, and it is to be printed. Dismiss closes what is open, help first; false:
 * nothing is. */
bool tc_viewer_display_help(tc_viewer *viewer);
void tc_viewer_display_panel(tc_viewer *viewer);
void tc_viewer_display_toggle(tc_viewer *viewer);
bool tc_viewer_display_dismiss(tc_viewer *viewer);

/* Milliseconds that filling and drawing the last frame's display took on this thread. */
double tc_viewer_display_ms(const tc_viewer *viewer);

/* Prints what the keys and the mouse do (viewer_window.c). */
void tc_viewer_print_keys(FILE *file);

#endif
