/* views_file.c - files of views. */
#include "views_file.h"

#include "common/base/numbers.h"
#include "common/base/status.h"
#include "common/base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_FILE = 16 << 20 }; /* bytes; more is no file of views */

/* ---- Reading ----------------------------------------------------------------------------------------------------- */

tc_status tc_views_read(const char *path, const char *what, char **text_ret, tc_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    /* In pieces: a pipe has no size to ask for. */
    char *text = NULL;
    size_t length = 0, capacity = 0;
    tc_status status = TC_OK;
    while (status == TC_OK && !feof(file)) {
        if (length + 4096 > capacity) {
            capacity = capacity ? 2 * capacity : 1 << 14;
            char *more = capacity <= MAX_FILE ? realloc(text, capacity) : NULL;
            if (!more) {
                status = tc_fail(error, TC_ERR_FORMAT, "%s: too long for %s", path, what);
                break;
            }
            text = more;
        }
        length += fread(text + length, 1, capacity - length - 1, file);
        if (ferror(file))
            status = tc_fail(error, TC_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
    }
    fclose(file);
    if (status == TC_OK) {
        text[length] = '\0';
        if (strlen(text) != length)
            status = tc_fail(error, TC_ERR_FORMAT, "%s: expected text, found zero bytes", path);
    }
    if (status == TC_OK)
        *text_ret = text;
    else
        free(text);
    return status;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Takes blanks off both ends. */
static void trim(const char **begin, const char **end)
{
    while (*begin < *end && is_blank(**begin))
        ++*begin;
    while (*begin < *end && is_blank((*end)[-1]))
        --*end;
}

tc_views tc_views_of(const tc_navigation *navigation, const char *file, const char *text)
{
    return (tc_views){.navigation = navigation, .file = file, .next = text + tc_text_mark(text)};
}

/* What a line must be. */
static const char *form_of(const tc_navigation *navigation)
{
    return navigation->x_period > 0 ? navigation->bounds : navigation->form;
}

tc_status tc_views_next(tc_views *views, bool *found_ret, tc_error *error)
{
    *found_ret = false;
    while (*views->next && !*found_ret) {
        const char *begin = views->next, *line_end = begin + strcspn(begin, "\n"), *end = begin + strcspn(begin, "#\n");
        const char *name = end < line_end ? end + 1 : end, *name_end = line_end;
        views->number++;
        views->next = *line_end ? line_end + 1 : line_end;
        trim(&begin, &end);
        trim(&name, &name_end);
        if (begin == end)
            continue;
        char content[256];
        const size_t length = (size_t)(end - begin);
        const bool fits = length < sizeof content;
        snprintf(content, sizeof content, "%.*s", (int)(fits ? length : sizeof content - 1), begin);
        if (!fits || !tc_pose_parse(views->navigation, content, &views->view))
            return tc_fail(error, TC_ERR_FORMAT, "%s: line %d: expected %s, found '%.60s%s'", views->file,
                           views->number, form_of(views->navigation), content, strlen(content) > 60 ? "..." : "");
        views->name = name, views->name_length = (size_t)(name_end - name);
        *found_ret = true;
    }
    return TC_OK;
}

static bool named(const tc_views *views, const char *name)
{
    return views->name_length > 0 && strlen(name) == views->name_length &&
           memcmp(name, views->name, views->name_length) == 0;
}

tc_status tc_views_find(const tc_navigation *navigation, const char *file, const char *text, const char *name,
                        tc_pose *view_ret, tc_error *error)
{
    tc_views views = tc_views_of(navigation, file, text);
    bool more = true, found = false;
    tc_status status = TC_OK;
    while (more && status == TC_OK) { /* all lines, so that a bad one is told whichever view is asked for */
        status = tc_views_next(&views, &more, error);
        if (status == TC_OK && more && !found && named(&views, name))
            *view_ret = views.view, found = true;
    }
    if (status == TC_OK && !found)
        status = tc_fail(error, TC_ERR_USAGE, "%s: expected a view named '%s', found none", file, name);
    return status;
}

/* ---- Writing ----------------------------------------------------------------------------------------------------- */

/* N of a view of the name "view N", as that is written; 0: it has another one. */
static int64_t number_of(const tc_views *views)
{
    static const char begin[] = "view ";
    char name[TC_VIEW_NAME];
    int64_t number;
    if (views->name_length >= sizeof name)
        return 0;
    memcpy(name, views->name, views->name_length);
    name[views->name_length] = '\0';
    const char *digits = name + sizeof begin - 1;
    const bool is = strncmp(name, begin, sizeof begin - 1) == 0 && *digits >= '1' && *digits <= '9';
    return is && tc_read_integer(digits, 1, INT32_MAX, &number) ? number : 0;
}

void tc_views_new_name(const tc_navigation *navigation, const char *text, char name[TC_VIEW_NAME])
{
    /* So many numbers are looked at at once: of files that people keep, all of them. */
    enum { NUMBERS = 1 << 15 };
    int first = 1, offset = NUMBERS; /* to the lowest number that is not taken */
    for (; offset == NUMBERS; first += offset) {
        bool taken[NUMBERS] = {false}, more = true;
        tc_views views = tc_views_of(navigation, "", text);
        while (more)
            if (tc_views_next(&views, &more, NULL) != TC_OK)
                more = true; /* bad lines have no names */
            else if (more) {
                const int64_t number = number_of(&views);
                if (number >= first && number < first + NUMBERS)
                    taken[number - first] = true;
            }
        for (offset = 0; offset < NUMBERS && taken[offset];)
            offset++;
    }
    snprintf(name, TC_VIEW_NAME, "view %d", first);
}

/* Whether there is a last line that is not ended. */
static bool begun(int file, off_t size)
{
    char last = '\n';
    return size > 0 && pread(file, &last, 1, size - 1) == 1 && last != '\n';
}

/* What was written of a line is taken back where that is not all of it. */
static tc_status append(int file, const char *path, const char *view, const char *name, tc_error *error)
{
    struct stat now;
    char line[TC_POSE_TEXT + TC_VIEW_NAME + 8];
    if (fstat(file, &now) != 0 || !S_ISREG(now.st_mode))
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: expected a regular file", path);
    const int length = snprintf(line, sizeof line, "%s%s # %s\n", begun(file, now.st_size) ? "\n" : "", view, name);
    errno = ENOSPC;
    const ssize_t written = write(file, line, (size_t)length);
    if (written == length)
        return TC_OK;
    tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    if (written > 0 && ftruncate(file, now.st_size) != 0)
        return tc_fail(error, TC_ERR_IO, "%s: ends in a part of a line: %s", path, strerror(errno));
    return TC_ERR_IO;
}

tc_status tc_views_append(const char *path, const char *view, const char *name, tc_error *error)
{
    /* Not waiting for who reads a pipe. */
    int file = open(path, O_RDWR | O_APPEND | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0666);
    if (file < 0)
        return tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    tc_status status = append(file, path, view, name, error);
    if (close(file) != 0 && status == TC_OK)
        status = tc_fail(error, TC_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    return status;
}
