/* views_file.h - files of views: text, one view a line as --view has it, and a name behind a #.
 *
 *     4000,6000,3000,120,-10 # over the lake
 *
 * Names are any text without ends of lines, without blanks around; a view need not have one, and of several of one name
 * the first counts. Lines without a view, empty ones and comments, are passed over. Paths of flights (flight_path.h)
 * are such files, and pass over names. No GL. */
#ifndef TC_VIEWS_FILE_H
#define TC_VIEWS_FILE_H

#include "flight.h"

/* The whole of a text file, which the caller frees. what: "a path file". TC_ERR_IO where it cannot be read,
 * TC_ERR_FORMAT for what is no text, or too long. */
tc_status tc_views_read(const char *path, const char *what, char **text_ret, tc_error *error);

/* Reads a file's text view by view. */
typedef struct tc_views {
    const tc_navigation *navigation;
    const char *file;   /* as errors call it */
    const char *next;   /* what has not been read yet */
    int number;         /* of the line that was read last */
    tc_pose view;       /* of it */
    const char *name;   /* in the text; not ended by a 0 but of a length, */
    size_t name_length; /* 0: none */
} tc_views;

/* The first view is the next one then. */
tc_views tc_views_of(const tc_navigation *navigation, const char *file, const char *text);

/* On to the next view: *found_ret is false where there is none any more. TC_ERR_FORMAT names a line that is none. */
tc_status tc_views_next(tc_views *views, bool *found_ret, tc_error *error);

/* The view of that name. TC_ERR_USAGE where there is none, TC_ERR_FORMAT where any line is bad. */
tc_status tc_views_find(const tc_navigation *navigation, const char *file, const char *text, const char *name,
                        tc_pose *view_ret, tc_error *error);

/* A name that no view of the text has: "view 1" and on. */
enum { TC_VIEW_NAME = 32 };
void tc_views_new_name(const tc_navigation *navigation, const char *text, char name_ret[TC_VIEW_NAME]);

/* Adds a line to a file, which is made where there is none: at once and whole, or not at all. view: as tc_pose_format()
 * writes it. TC_ERR_IO where that fails, or the file is no regular one. */
tc_status tc_views_append(const char *path, const char *view, const char *name, tc_error *error);

#endif
