/* display.h - what a window tells of what it shows, as data: texts by the side that they stand at, a compass, a scale,
 * the keys, and the rows of a panel. It is filled anew for every frame and drawn by the window's plugin
 * (plugin_display.cpp), which hands back what the user did in it. Neither knows anything of terrains. No memory is
 * allocated. */
#ifndef TC_DISPLAY_H
#define TC_DISPLAY_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    TC_DISPLAY_TEXTS = 32,
    TC_DISPLAY_LENGTH = 256, /* bytes of a text, UTF-8 */
    TC_DISPLAY_KEYS = 40,
    TC_DISPLAY_ROWS = 128,
    TC_DISPLAY_ENTRY = 1024 /* bytes of what is typed into a row */
};

/* Where a text stands; those of one side are lines below each other. */
typedef enum tc_display_side {
    TC_SIDE_TOP,    /* in the middle */
    TC_SIDE_LEFT,   /* at the bottom, above the scale */
    TC_SIDE_RIGHT,  /* at the bottom */
    TC_SIDE_CORNER, /* at the top right, below the compass */
    TC_DISPLAY_SIDES
} tc_display_side;

typedef struct tc_display_text {
    tc_display_side side;
    bool warning;
    double opacity; /* 0 to 1 */
    char text[TC_DISPLAY_LENGTH];
} tc_display_text;

typedef struct tc_display_key {
    const char *label, *help;
} tc_display_key;

/* ---- The panel --------------------------------------------------------------------------------------------------- */

typedef enum tc_row_kind {
    TC_ROW_HEADING,
    TC_ROW_SWITCH, /* 0 or 1 */
    TC_ROW_SLIDER, /* from least to most */
    TC_ROW_COUNT,  /* likewise, whole numbers */
    TC_ROW_CHOICE, /* the number of one of the names */
    TC_ROW_ENTRY   /* a text that is typed in and ended with Enter */
} tc_row_kind;

typedef struct tc_display_row {
    tc_row_kind kind;
    const char *label, *help; /* help: NULL none */
    double least, most;
    bool logarithmic;
    bool late;          /* takes long: changed only once the user lets go */
    const char *format; /* of a slider's or a count's value, as printf has a double's or an int's; NULL: plainly */
    const char *const *names; /* of a choice, ended by NULL */
    double value;             /* as it is now */
    int id;                   /* the panel's own */
} tc_display_row;

/* ---- What is waited for ------------------------------------------------------------------------------------------ */

typedef struct tc_display_work {
    char name[TC_DISPLAY_LENGTH]; /* "": nothing is */
    char what[TC_DISPLAY_LENGTH]; /* is being done */
    double share;                 /* of it, 0 to 1; negative: not known */
    bool alone;                   /* there is no picture yet */
    double seconds;               /* that it takes already */
} tc_display_work;

/* ---- The whole --------------------------------------------------------------------------------------------------- */

typedef struct tc_display {
    tc_display_text text[TC_DISPLAY_TEXTS];
    int texts;
    double heading;      /* radians clockwise from north, of the compass */
    double scale_pixels; /* length of the scale on the framebuffer; 0: none */
    char scale[32];      /* what it stands for */
    bool help;           /* the keys are shown */
    tc_display_key key[TC_DISPLAY_KEYS];
    int keys;
    bool panel; /* is shown */
    tc_display_row row[TC_DISPLAY_ROWS];
    int rows;
    tc_display_work work; /* in the middle */
} tc_display;

/* What the user did in it. */
typedef struct tc_display_result {
    bool north; /* the compass was clicked */
    bool panel_closed, help_closed;
    int changed;                  /* a row, by its id; -1: none */
    double value;                 /* that it is to have, */
    char entry[TC_DISPLAY_ENTRY]; /* or what was typed into it */
    bool pointed;                 /* the pointer is over the picture, not over the display: */
    double x, y;                  /* framebuffer, pixels from its top left corner */
} tc_display_result;

/* One more line. Where there is no room the line is left out; what is too long is cut between characters. */
void tc_display_say(tc_display *display, tc_display_side side, bool warning, double opacity, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* ---- Words ------------------------------------------------------------------------------------------------------- */

enum { TC_WORDS = 64 };

/* Metres as a person reads them: "3.4 m", "1250 m", "38.2 km". */
void tc_words_metres(double metres, char text[TC_WORDS]);

/* Degrees north and east, longitude within 180, to so many digits: "46.50123 N, 7.99001 W" with signs of degrees. */
void tc_words_degrees(double longitude, double latitude, int digits, char text[TC_WORDS]);

/* The longest scale of at most so many pixels whose length is 1, 2 or 5 times a power of ten; returns its pixels, 0
 * where none is to be told. */
double tc_words_scale(double metres_a_pixel, double most_pixels, char text[TC_WORDS / 2]);

/* ---- What passes ------------------------------------------------------------------------------------------------- */

/* Lines that are shown for some seconds and fade. */
enum { TC_DISPLAY_LINES = 6 };
typedef struct tc_display_lines {
    struct tc_display_line {
        char text[TC_DISPLAY_LENGTH];
        bool warning;
        double since;         /* milliseconds of tc_clock_ms() */
    } line[TC_DISPLAY_LINES]; /* old to new */
    int count;
} tc_display_lines;

/* Adds one; the oldest goes where there is no room. One that says what the last one said takes its place. */
void tc_display_lines_add(tc_display_lines *lines, bool warning, double now, const char *text);

/* Takes one away that is no longer true. */
void tc_display_lines_drop(tc_display_lines *lines, const char *text);

/* Puts those that are still to be seen at the top of the display; forgets the others. */
void tc_display_lines_show(tc_display_lines *lines, double now, tc_display *display);

#ifdef __cplusplus
}
#endif
#endif
