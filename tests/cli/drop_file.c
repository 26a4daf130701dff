/* drop_file.c - drop-file WINDOW FILE...: lets files fall on an X window, as a file manager does (XDND, version 5). 0:
 * the window took them. Without a file the window is asked to close, as its frame's button does. */
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ENTER, POSITION, STATUS, DROP, FINISHED, SELECTION, URI_LIST, COPY, ATOMS };
static const char *const names[ATOMS] = {"XdndEnter",    "XdndPosition",  "XdndStatus",    "XdndDrop",
                                         "XdndFinished", "XdndSelection", "text/uri-list", "XdndActionCopy"};
static Atom atom[ATOMS];

static void tell(Display *display, Window target, int what, Window source, long a, long b, long c, long d)
{
    XEvent event = {.xclient = {.type = ClientMessage,
                                .window = target,
                                .message_type = atom[what],
                                .format = 32,
                                .data.l = {(long)source, a, b, c, d}}};
    XSendEvent(display, target, False, NoEventMask, &event);
    XFlush(display);
}

/* The list of files is asked for as a selection. */
static void hand_over(Display *display, const XSelectionRequestEvent *asked, const char *list)
{
    XChangeProperty(display, asked->requestor, asked->property, asked->target, 8, PropModeReplace,
                    (const unsigned char *)list, (int)strlen(list));
    XEvent event = {.xselection = {.type = SelectionNotify,
                                   .requestor = asked->requestor,
                                   .selection = asked->selection,
                                   .target = asked->target,
                                   .property = asked->property,
                                   .time = asked->time}};
    XSendEvent(display, asked->requestor, False, NoEventMask, &event);
    XFlush(display);
}

static void ask_to_close(Display *display, Window target)
{
    const Atom protocols = XInternAtom(display, "WM_PROTOCOLS", False);
    XEvent event = {.xclient = {.type = ClientMessage, .window = target, .message_type = protocols, .format = 32}};
    event.xclient.data.l[0] = (long)XInternAtom(display, "WM_DELETE_WINDOW", False);
    XSendEvent(display, target, False, NoEventMask, &event);
    XSync(display, False);
}

/* Answers until a message comes, for five seconds at most. */
static int await(Display *display, int what, const char *list)
{
    struct pollfd connection = {.fd = ConnectionNumber(display), .events = POLLIN};
    for (int tenths = 0; tenths < 50;) {
        if (!XPending(display)) {
            tenths += poll(&connection, 1, 100) == 0;
            continue;
        }
        XEvent event;
        XNextEvent(display, &event);
        if (event.type == SelectionRequest)
            hand_over(display, &event.xselectionrequest, list);
        if (event.type == ClientMessage && event.xclient.message_type == atom[what])
            return event.xclient.data.l[1] != 0; /* accepted; GLFW tells how many bytes */
    }
    return 0;
}

int main(int argc, char **argv)
{
    static char list[16 * PATH_MAX];
    Display *display = argc > 1 ? XOpenDisplay(NULL) : NULL;
    if (!display)
        return 2;
    if (argc == 2) {
        ask_to_close(display, strtoul(argv[1], NULL, 0));
        return 0;
    }
    for (int i = 2; i < argc; i++) {
        char path[PATH_MAX];
        const size_t length = strlen(list);
        if (!realpath(argv[i], path))
            return 2;
        snprintf(list + length, sizeof list - length, "file://%s\r\n", path);
    }
    for (int i = 0; i < ATOMS; i++)
        atom[i] = XInternAtom(display, names[i], False);
    const Window target = strtoul(argv[1], NULL, 0), root = DefaultRootWindow(display);
    const Window source = XCreateSimpleWindow(display, root, 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(display, atom[SELECTION], source, CurrentTime);
    tell(display, target, ENTER, source, 5L << 24, (long)atom[URI_LIST], 0, 0);
    tell(display, target, POSITION, source, 0, 10L << 16 | 10, CurrentTime, (long)atom[COPY]);
    if (!await(display, STATUS, list))
        return 1;
    tell(display, target, DROP, source, 0, CurrentTime, 0, 0);
    return await(display, FINISHED, list) ? 0 : 1;
}
