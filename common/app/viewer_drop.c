/* viewer_drop.c - shows a file that came while the window was open. What it is decides what becomes of it: what has
 * heights is opened in place of the terrain, what has colours is laid over it. Both are tried, since many a format
 * holds either. */
#include "viewer_internal.h"
#include "common/base/status.h"
#include "interrupt.h"

#include <string.h>

/* As it would be opened by its name alone; what was said of how the first file is read was said of that. */
static tc_viewer_wish terrain_wish(const tc_viewer *v, const char *path)
{
    tc_viewer_wish wish = tc_viewer_wish_now(v);
    const tc_source_options *first = &v->options.source;
    wish.options.terrain = path;
    wish.options.imagery_count = 0;
    wish.options.globe = (tc_globe_choice){.flattening = 0};
    wish.options.source = (tc_source_options){
        .has_voids = first->has_voids, .voids = first->voids, .void_constant = first->void_constant};
    return wish;
}

static tc_status open_terrain(tc_viewer *v, const char *path, tc_error *error)
{
    tc_viewer_wish wish = terrain_wish(v, path);
    tc_status status = tc_viewer_adopt(v, &wish, error);
    if (status == TC_ERR_UNSUPPORTED && v->renderer && wish.options.scheme) { /* it may have another scheme's charts */
        tc_error unused;
        wish.options.scheme = NULL;
        if (tc_viewer_adopt(v, &wish, &unused) == TC_OK)
            status = TC_OK;
    }
    return status;
}

static tc_status lay_picture(tc_viewer *v, const char *path, tc_error *error)
{
    tc_viewer_wish wish = tc_viewer_wish_now(v);
    if (wish.options.imagery_count == TC_MOST_IMAGERY)
        return tc_fail(error, TC_ERR_USAGE, "%s: expected at most %d pictures", path, TC_MOST_IMAGERY);
    wish.options.imagery[wish.options.imagery_count++] = path;
    return tc_viewer_adopt(v, &wish, error);
}

tc_status tc_viewer_drop(tc_viewer *v, const char *path, bool picture, bool *opened_ret, tc_pose *view_ret,
                         tc_error *error)
{
    tc_error no_terrain = {.text = ""}, no_picture = {.text = ""};
    const char *kept = tc_viewer_keep(v, path);
    *opened_ret = false;
    if (!kept)
        return tc_fail(error, TC_ERR_MEMORY, "%s: not enough memory", path);
    tc_status status = tc_outputs_spare(&v->outputs, kept, error);
    if (status != TC_OK || (picture && lay_picture(v, kept, &no_picture) == TC_OK))
        return status;
    status = v->renderer ? open_terrain(v, kept, &no_terrain) : TC_ERR_MEMORY;
    if (status == TC_OK) {
        *opened_ret = true;
        *view_ret = tc_viewer_whole(v);
        v->failing = false;
        return TC_OK;
    }
    if (!picture && v->renderer && !tc_interrupted() && lay_picture(v, kept, &no_picture) == TC_OK)
        return TC_OK;
    /* What says nothing of a format is no reason. */
    const tc_error *reason = picture && no_picture.text[0] ? &no_picture : &no_terrain;
    return tc_fail(error, status, "%s", reason->text);
}
