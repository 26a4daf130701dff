/* window.h - a window with an OpenGL 4.5 core context, its keys and its mouse: the table that the plugin
 * terraclip-window.so (GLFW) exports. It knows nothing of terrains; what keys mean is the viewer's affair.
 *
 * The mouse: what it does is reported as events, in their order. A viewer may capture it (the pointer hides and its
 * motion is endless): then motion is reported as look_x and look_y instead, and Escape lets it go. */
#ifndef TC_WINDOW_H
#define TC_WINDOW_H

#include "common/terraclip.h"
#include "common/view/pointer.h"
#include "display.h"

typedef struct tc_window tc_window;

/* Keys: letters and digits are their upper-case ASCII, as the user's keyboard layout labels them. */
typedef enum tc_key {
    TC_KEY_ESCAPE = 256, /* also where it let the mouse go */
    TC_KEY_F1,
    TC_KEY_F11,
    TC_KEY_TAB
} tc_key;

/* Zero is the default. */
typedef struct tc_window_options {
    const char *title;
    const char *program; /* by which a desktop finds the window's entry, and its icon; NULL: none */
    int width, height;   /* of the framebuffer, pixels; the window system may decide otherwise. 0: 1280 x 720 */
    bool hidden;         /* never shown: for drawing offscreen by means of a display */
} tc_window_options;

enum { TC_WINDOW_MAX_PRESSED = 32, TC_WINDOW_MAX_EVENTS = 64, TC_WINDOW_MAX_DROPPED = 8 };

/* What has happened since the last poll, and what is held now. */
typedef struct tc_window_input {
    int pressed[TC_WINDOW_MAX_PRESSED]; /* keys that went down, in order; more than fit are dropped */
    int pressed_count;
    double right, forward, up; /* -1, 0 or 1: D - A, W - S, E - Q held, by position on the keyboard, not by label */
    double turn, tilt;         /* -1, 0 or 1: arrow keys held, right and up positive */
    bool fast;                 /* a shift key is held */
    double look_x, look_y;     /* captured mouse motion in pixels, right and down positive */
    bool was_captured;         /* the mouse was, before any of the keys went down, */
    bool captured;             /* and is, after all that has happened */
    tc_pointer_event events[TC_WINDOW_MAX_EVENTS]; /* of the mouse, in order; motion alone is joined into one. More than
                                                    * fit are dropped, but no release is */
    int event_count;
    const char *dropped[TC_WINDOW_MAX_DROPPED]; /* files dropped on the window; valid until the next poll */
    int dropped_count;
    int dropped_left_out; /* files beside those: more than fit */
    int width, height;    /* framebuffer in pixels; 0 while iconified */
    bool close;           /* the user asked to close the window */
} tc_window_input;

struct tc_window_plugin {
    /* Opens a window and makes its context current on this thread. One window at a time in a process, on its main
     * thread. TC_ERR_CONTEXT where there is no display or no OpenGL 4.5. */
    tc_status (*open)(const tc_window_options *options, tc_window **window_ret, tc_error *error);
    void (*close)(tc_window *window);
    /* Address of an OpenGL function of the current context, for tc_gl_load. */
    void *(*get_proc)(const char *name);
    /* Handles what is pending. wait_seconds > 0: first waits that long for something to happen. */
    void (*poll)(tc_window *window, double wait_seconds, tc_window_input *input_ret);
    /* Draws a display over what was drawn, and tells what the user did in it. What he does in it, the input does not
     * tell, as long as it is shown for each frame. False: it cannot be drawn here. */
    bool (*show)(tc_window *window, const tc_display *display, tc_display_result *result_ret);
    /* Shows what was drawn, in step with the screen where the driver can. */
    void (*swap)(tc_window *window);
    void (*set_title)(tc_window *window, const char *title);
    void (*toggle_full_screen)(tc_window *window);
    /* Captures the mouse, or lets it go. */
    void (*capture)(tc_window *window, bool on);
};

#endif
