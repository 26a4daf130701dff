/* plugin_window.c - window.h by means of GLFW 3. Becomes terraclip-window.so, so that programs without a window load
 * neither GLFW nor X11 or Wayland. */
#include "window.h"
#include "common/base/status.h"
#include "icon.h"
#include "plugin_display.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <stdlib.h>
#include <string.h>

extern const struct tc_window_plugin tc_plugin __attribute__((visibility("default"))); /* found by this name */

struct tc_window {
    GLFWwindow *glfw;
    tc_window_input events;               /* since the last poll: what was pressed, moved and dropped */
    bool captured;                        /* until Escape */
    double last_x, last_y;                /* where the pointer was last, as events tell: it may be elsewhere by now */
    char *dropped[TC_WINDOW_MAX_DROPPED]; /* owned: of events.dropped */
    int x, y, width, height;              /* of the window before it filled the screen */
    tc_overlay *overlay;                  /* its display, from the first on; NULL: none yet */
    bool displays;                        /* one was asked for */
};

/* Fails with GLFW's own reason. */
static tc_status fail_glfw(tc_error *error, const char *what)
{
    const char *reason = NULL;
    if (glfwGetError(&reason) == GLFW_NO_ERROR || !reason)
        reason = "no reason given";
    return tc_fail(error, TC_ERR_CONTEXT, "window: %s: %s", what, reason);
}

static void window_capture(tc_window *window, bool on)
{
    if (on == window->captured)
        return;
    window->captured = on;
    glfwSetInputMode(window->glfw, GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    /* Unaccelerated motion: a hand's movement turns the view by the same angle at any speed. */
    if (glfwRawMouseMotionSupported())
        glfwSetInputMode(window->glfw, GLFW_RAW_MOUSE_MOTION, on ? GLFW_TRUE : GLFW_FALSE);
    glfwGetCursorPos(window->glfw, &window->last_x, &window->last_y);
}

/* The tc_key of a GLFW key; 0 for keys that nobody asks for. */
static int translate(int key, int scancode)
{
    switch (key) {
    case GLFW_KEY_ESCAPE: return TC_KEY_ESCAPE;
    case GLFW_KEY_F1: return TC_KEY_F1;
    case GLFW_KEY_F11: return TC_KEY_F11;
    case GLFW_KEY_TAB: return TC_KEY_TAB;
    default: break;
    }
    /* These six fly, by their place, whatever they are labelled. */
    static const int flying[] = {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S, GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E};
    for (size_t i = 0; i < sizeof flying / sizeof *flying; i++)
        if (key == flying[i])
            return 0;
    const char *label = glfwGetKeyName(key, scancode);
    char c = label && label[0] && !label[1] ? label[0] : '\0';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 'A';
    if ((c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z'))
        return c;
    /* A layout without Latin letters: by position. */
    return !c && key >= GLFW_KEY_A && key <= GLFW_KEY_Z ? key : 0;
}

static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int modifiers)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    if (tc_overlay_key(window->overlay, key, scancode, action, modifiers) || action != GLFW_PRESS)
        return;
    if (key == GLFW_KEY_ESCAPE)
        window_capture(window, false);
    int translated = translate(key, scancode);
    if (translated && window->events.pressed_count < TC_WINDOW_MAX_PRESSED)
        window->events.pressed[window->events.pressed_count++] = translated;
}

/* Pixels of the framebuffer for GLFW's units of the screen. */
static void pixels_of(const tc_window *window, double *x, double *y)
{
    int width, height, pixels_x, pixels_y;
    glfwGetWindowSize(window->glfw, &width, &height);
    glfwGetFramebufferSize(window->glfw, &pixels_x, &pixels_y);
    if (width > 0 && height > 0)
        *x *= (double)pixels_x / width, *y *= (double)pixels_y / height;
}

/* Adds an event where the pointer is. Room is kept for releases. */
static void add_event(tc_window *window, tc_pointer_event event)
{
    enum { KEPT = 8 };
    tc_window_input *input = &window->events;
    event.x = window->last_x, event.y = window->last_y;
    pixels_of(window, &event.x, &event.y);
    event.seconds = glfwGetTime();
    tc_pointer_event *last = input->event_count > 0 ? &input->events[input->event_count - 1] : NULL;
    if (last && last->kind == event.kind && event.kind == TC_POINTER_MOVE)
        *last = event;
    else if (input->event_count < TC_WINDOW_MAX_EVENTS - (event.kind == TC_POINTER_RELEASE ? 0 : KEPT))
        input->events[input->event_count++] = event;
}

static void on_button(GLFWwindow *glfw, int button, int action, int modifiers)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    static const tc_pointer_button buttons[] = {[GLFW_MOUSE_BUTTON_LEFT] = TC_POINTER_LEFT,
                                                [GLFW_MOUSE_BUTTON_RIGHT] = TC_POINTER_RIGHT,
                                                [GLFW_MOUSE_BUTTON_MIDDLE] = TC_POINTER_MIDDLE};
    if (!tc_overlay_button(window->overlay, button, action, modifiers) && button <= GLFW_MOUSE_BUTTON_MIDDLE)
        add_event(window, (tc_pointer_event){.kind = action == GLFW_PRESS ? TC_POINTER_PRESS : TC_POINTER_RELEASE,
                                             .button = buttons[button]});
}

static void on_motion(GLFWwindow *glfw, double x, double y)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    if (window->captured) {
        window->events.look_x += x - window->last_x;
        window->events.look_y += y - window->last_y;
    }
    window->last_x = x;
    window->last_y = y;
    if (!window->captured)
        add_event(window, (tc_pointer_event){.kind = TC_POINTER_MOVE});
}

static void on_wheel(GLFWwindow *glfw, double x, double y)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    if (!tc_overlay_wheel(window->overlay, x, y))
        add_event(window, (tc_pointer_event){.kind = TC_POINTER_WHEEL, .wheel = y});
}

static void on_character(GLFWwindow *glfw, unsigned int character)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    tc_overlay_character(window->overlay, character);
}

static void on_enter(GLFWwindow *glfw, int entered)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    tc_overlay_enter(window->overlay, entered);
}

static void on_focus(GLFWwindow *glfw, int focused)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    tc_overlay_focus(window->overlay, focused);
}

static void on_drop(GLFWwindow *glfw, int count, const char **paths)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    tc_window_input *input = &window->events;
    for (int i = 0; i < count; i++) {
        char *path = input->dropped_count < TC_WINDOW_MAX_DROPPED ? strdup(paths[i]) : NULL;
        input->dropped_left_out += !path;
        if (path)
            input->dropped[input->dropped_count] = window->dropped[input->dropped_count] = path, input->dropped_count++;
    }
}

/* Forgets what was reported. */
static void forget_events(tc_window *window)
{
    for (int i = 0; i < window->events.dropped_count; i++)
        free(window->dropped[i]);
    memset(&window->events, 0, sizeof window->events);
}

static void window_close(tc_window *window)
{
    if (!window)
        return;
    tc_overlay_destroy(window->overlay);
    forget_events(window);
    glfwDestroyWindow(window->glfw);
    glfwTerminate();
    free(window);
}

/* By which desktops know the program: the name of its entry (share/applications). */
static void hint_program(const char *program)
{
    glfwWindowHintString(GLFW_X11_CLASS_NAME, program);
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, program);
#ifdef GLFW_WAYLAND_APP_ID
    glfwWindowHintString(GLFW_WAYLAND_APP_ID, program);
#endif
}

/* Where the window system has none of its own for the program. */
static void set_icon(GLFWwindow *glfw)
{
    enum { SMALL = 32, LARGE = 64 };
    uint8_t small[SMALL * SMALL][4], large[LARGE * LARGE][4];
    tc_icon_draw(SMALL, small);
    tc_icon_draw(LARGE, large);
    const GLFWimage images[] = {{SMALL, SMALL, *small}, {LARGE, LARGE, *large}};
    glfwSetWindowIcon(glfw, 2, images); /* Wayland has no such thing, and says so: nothing to fail for */
    glfwGetError(NULL);
}

static tc_status window_open(const tc_window_options *options, tc_window **window_ret, tc_error *error)
{
    if (!glfwInit())
        return fail_glfw(error, "no display");
    tc_window *window = calloc(1, sizeof *window);
    if (!window) {
        glfwTerminate();
        return tc_fail(error, TC_ERR_MEMORY, "window: not enough memory");
    }
    int width = options->width > 0 ? options->width : 1280, height = options->height > 0 ? options->height : 720;
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, options->hidden ? GLFW_FALSE : GLFW_TRUE);
    if (options->program)
        hint_program(options->program);
    /* Finished frames are copied in: the window itself needs neither depth nor samples. */
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    window->glfw = glfwCreateWindow(width, height, options->title ? options->title : "", NULL, NULL);
    if (!window->glfw) {
        tc_status status = fail_glfw(error, "no window with OpenGL 4.5 core");
        glfwTerminate();
        free(window);
        return status;
    }
    if (!options->hidden)
        set_icon(window->glfw);
    glfwSetWindowUserPointer(window->glfw, window);
    glfwSetKeyCallback(window->glfw, on_key);
    glfwSetMouseButtonCallback(window->glfw, on_button);
    glfwSetCursorPosCallback(window->glfw, on_motion);
    glfwSetScrollCallback(window->glfw, on_wheel);
    glfwSetDropCallback(window->glfw, on_drop);
    glfwSetCharCallback(window->glfw, on_character);
    glfwSetCursorEnterCallback(window->glfw, on_enter);
    glfwSetWindowFocusCallback(window->glfw, on_focus);
    glfwGetCursorPos(window->glfw, &window->last_x, &window->last_y);
    glfwMakeContextCurrent(window->glfw);
    glfwSwapInterval(1);
    *window_ret = window;
    return TC_OK;
}

static void *window_get_proc(const char *name)
{
    GLFWglproc function = glfwGetProcAddress(name);
    void *pointer;
    memcpy(&pointer, &function, sizeof pointer);
    return pointer;
}

static double held(const tc_window *window, int key)
{
    return glfwGetKey(window->glfw, key) == GLFW_PRESS && !tc_overlay_typing(window->overlay) ? 1 : 0;
}

static void window_poll(tc_window *window, double wait_seconds, tc_window_input *input_ret)
{
    forget_events(window);
    const bool was_captured = window->captured;
    if (wait_seconds > 0)
        glfwWaitEventsTimeout(wait_seconds);
    else
        glfwPollEvents();
    tc_overlay_next(window->overlay);
    tc_window_input *input = &window->events;
    input->right = held(window, GLFW_KEY_D) - held(window, GLFW_KEY_A);
    input->forward = held(window, GLFW_KEY_W) - held(window, GLFW_KEY_S);
    input->up = held(window, GLFW_KEY_E) - held(window, GLFW_KEY_Q);
    input->turn = held(window, GLFW_KEY_RIGHT) - held(window, GLFW_KEY_LEFT);
    input->tilt = held(window, GLFW_KEY_UP) - held(window, GLFW_KEY_DOWN);
    input->fast = held(window, GLFW_KEY_LEFT_SHIFT) + held(window, GLFW_KEY_RIGHT_SHIFT) > 0;
    glfwGetFramebufferSize(window->glfw, &input->width, &input->height);
    if (glfwGetWindowAttrib(window->glfw, GLFW_ICONIFIED))
        input->width = input->height = 0;
    input->close = glfwWindowShouldClose(window->glfw);
    input->was_captured = was_captured;
    input->captured = window->captured;
    *input_ret = *input;
}

static bool window_show(tc_window *window, const tc_display *display, tc_display_result *result_ret)
{
    if (!window->overlay && !window->displays)
        window->overlay = tc_overlay_create(window->glfw);
    window->displays = true;
    if (window->overlay)
        tc_overlay_show(window->overlay, display, result_ret);
    return window->overlay != NULL;
}

static void window_swap(tc_window *window)
{
    glfwSwapBuffers(window->glfw);
}

static void window_set_title(tc_window *window, const char *title)
{
    glfwSetWindowTitle(window->glfw, title);
}

/* The monitor that holds the window's centre, else the first. */
static GLFWmonitor *monitor_of(const tc_window *window)
{
    int count = 0;
    GLFWmonitor **monitors = glfwGetMonitors(&count);
    int cx = window->x + window->width / 2, cy = window->y + window->height / 2;
    for (int i = 0; i < count; i++) {
        int x, y;
        glfwGetMonitorPos(monitors[i], &x, &y);
        const GLFWvidmode *mode = glfwGetVideoMode(monitors[i]);
        if (mode && cx >= x && cy >= y && cx < x + mode->width && cy < y + mode->height)
            return monitors[i];
    }
    return count > 0 ? monitors[0] : NULL;
}

static void window_toggle_full_screen(tc_window *window)
{
    if (glfwGetWindowMonitor(window->glfw)) {
        glfwSetWindowMonitor(window->glfw, NULL, window->x, window->y, window->width, window->height, GLFW_DONT_CARE);
        return;
    }
    glfwGetWindowPos(window->glfw, &window->x, &window->y);
    glfwGetWindowSize(window->glfw, &window->width, &window->height);
    GLFWmonitor *monitor = monitor_of(window);
    const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
    if (!mode)
        return;
    /* The screen's present mode: no switching, no black moment. */
    glfwSetWindowMonitor(window->glfw, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
    glfwSwapInterval(1);
}

const struct tc_window_plugin tc_plugin = {
    .open = window_open,
    .close = window_close,
    .get_proc = window_get_proc,
    .poll = window_poll,
    .show = window_show,
    .swap = window_swap,
    .set_title = window_set_title,
    .toggle_full_screen = window_toggle_full_screen,
    .capture = window_capture,
};
