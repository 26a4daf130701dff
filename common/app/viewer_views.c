/* viewer_views.c - the file of views that --views names: where --view @NAME is found, and what V in the window adds to.
 */
#include "viewer_internal.h"
#include "common/base/outfile.h"
#include "common/base/status.h"
#include "common/view/views_file.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const WHAT = "a file of views";

/* Of a window, in which views may be added: now it is known whether they can be. */
static tc_status check_writable(const char *path, tc_error *error)
{
    struct stat old;
    if (stat(path, &old) != 0)
        return tc_outfile_probe(path, error);
    if (!S_ISREG(old.st_mode))
        return tc_fail(error, TC_ERR_IO, "%s: expected a regular file, to which views can be added, found another",
                       path);
    return access(path, W_OK) == 0 ? TC_OK : tc_fail(error, TC_ERR_IO, "%s: cannot be written", path);
}

/* The first views of the text; lines that are none are passed over. */
static void list(tc_viewer *v, const char *text)
{
    tc_error unused;
    tc_views views = tc_views_of(v->program->navigation, v->options.views, text);
    bool more = true;
    v->listed_count = 0;
    while (more && v->listed_count < TC_VIEWER_LISTED) {
        const bool bad = tc_views_next(&views, &more, &unused) != TC_OK;
        more |= bad;
        if (bad || !more)
            continue;
        struct tc_listed_view *listed = &v->listed[v->listed_count++];
        listed->view = views.view;
        snprintf(listed->name, sizeof listed->name, "%.*s", (int)views.name_length, views.name);
    }
}

/* As the file is now. */
static tc_status list_again(tc_viewer *v, tc_error *error)
{
    char *text = NULL;
    v->listed_count = 0;
    if (!v->options.views)
        return tc_fail(error, TC_ERR_USAGE, "--views FILE has views to fly to; there is none");
    tc_status status = tc_views_read(v->options.views, WHAT, &text, error);
    if (status == TC_OK)
        list(v, text);
    free(text);
    return status;
}

bool tc_viewer_listed_view(tc_viewer *v, int number, tc_pose *view_ret)
{
    tc_error error;
    tc_status status = list_again(v, &error);
    if (status == TC_OK && number > v->listed_count)
        status = tc_fail(&error, TC_ERR_USAGE, "%s: no view %d", v->options.views, number);
    if (status != TC_OK) {
        tc_viewer_tell(v, TC_TOLD_FAILURE, "%s", error.text);
        return false;
    }
    const struct tc_listed_view *listed = &v->listed[number - 1];
    *view_ret = listed->view;
    tc_viewer_tell(v, TC_TOLD_DONE, "view %d%s%s", number, *listed->name ? ": " : "", listed->name);
    return true;
}

tc_status tc_viewer_begin_views(tc_viewer *v, tc_error *error)
{
    const char *path = v->options.views, *name = v->options.view_name;
    if (!path)
        return TC_OK;
    tc_status status = tc_viewer_interactive(&v->options) ? check_writable(path, error) : TC_OK;
    if (status != TC_OK || (!name && access(path, F_OK) != 0))
        return status;
    char *text;
    status = tc_views_read(path, WHAT, &text, error);
    if (status != TC_OK)
        return status;
    const tc_navigation *navigation = v->program->navigation;
    if (name) {
        status = tc_views_find(navigation, path, text, name, &v->options.view, error);
    } else {
        tc_views views = tc_views_of(navigation, path, text);
        for (bool more = true; more && status == TC_OK;)
            status = tc_views_next(&views, &more, error);
    }
    if (status == TC_OK)
        list(v, text);
    free(text);
    return status;
}

/* Adds a view under a new name; what is wrong with lines that are there is said, and stays. What is no text is left
 * alone: it is another file than it was. */
static tc_status add(const tc_viewer *v, const char *view, char name[TC_VIEW_NAME], tc_error *error)
{
    const char *path = v->options.views;
    const tc_navigation *navigation = v->program->navigation;
    char *text = NULL;
    tc_status status = access(path, F_OK) == 0 ? tc_views_read(path, WHAT, &text, error) : TC_OK;
    if (status != TC_OK)
        return status;
    tc_error bad;
    tc_views views = tc_views_of(navigation, path, text ? text : "");
    for (bool more = true; more && status == TC_OK;)
        status = tc_views_next(&views, &more, &bad);
    if (status != TC_OK)
        fprintf(stderr, "%s: warning: %s\n", v->program->name, bad.text);
    tc_views_new_name(navigation, text ? text : "", name);
    free(text);
    return tc_views_append(path, view, name, error);
}

void tc_viewer_keep_view(tc_viewer *v, tc_pose *view)
{
    char text[TC_POSE_TEXT], name[TC_VIEW_NAME];
    tc_error error;
    tc_pose_format(v->program->navigation, view, v->spacing, text);
    tc_status status = v->options.views ? add(v, text, name, &error) : TC_OK;
    if (v->options.views && status == TC_OK) {
        tc_error unused;
        list_again(v, &unused);
        tc_viewer_tell(v, TC_TOLD_DONE, "%s: %s", v->options.views, name);
        return;
    }
    if (status != TC_OK)
        tc_viewer_tell(v, TC_TOLD_FAILURE, "%s", error.text);
    printf("--view %s\n", text);
    fflush(stdout);
}
