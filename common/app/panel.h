/* panel.h - what of a viewer can be set while it runs: rows of a display's panel (display.h), one line of a table each.
 */
#ifndef TC_PANEL_H
#define TC_PANEL_H

#include "display.h"
#include "viewer_internal.h"

enum { TC_PANEL_SCHEMES = 15 };

/* What rows point to; zero is empty. */
typedef struct tc_panel {
    const char *scheme[TC_PANEL_SCHEMES + 1], *shade[TC_SHADES + 1];
    const char *terrain;                  /* that the pictures belong to */
    const char *picture[TC_MOST_IMAGERY]; /* laid over it now or before, by their paths */
    int pictures;
    char view_text[TC_VIEWER_LISTED][64];
    const char *view[TC_VIEWER_LISTED + 2];
} tc_panel;

/* The rows that there are for what is shown now, with their values; returns how many. */
int tc_panel_rows(tc_panel *panel, const tc_viewer *viewer, tc_display_row rows_ret[TC_DISPLAY_ROWS]);

/* Sets a row, by its id. On failure all is as it was. Entries are files, which the caller shows: true for them. */
tc_status tc_panel_set(const tc_panel *panel, tc_viewer *viewer, int id, double value, tc_error *error);
bool tc_panel_is_file(int id, bool *picture_ret);

/* The key that a row stands for, with that value: of a view that is flown to; 0: none. */
int tc_panel_key(int id, double value);

#endif
