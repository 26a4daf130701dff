/* plugin_window.c - window.h by means of GLFW 3. Becomes terraclip-window.so, so that programs without a window load
 * neither GLFW nor X11 or Wayland. */
#include "window.h"
#include "common/base/status.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <stdlib.h>
#include <string.h>

extern const struct tc_window_plugin tc_plugin __attribute__((visibility("default"))); /* found by this name */

struct tc_window {
    GLFWwindow *glfw;
    tc_window_input events;  /* since the last poll: pressed, look and wheel */
    bool captured;           /* by a click, until Escape */
    bool held;               /* by the right button, while it is down */
    bool drags, dragging;    /* the left button does, and is down */
    double last_x, last_y;   /* where the captured pointer was */
    int x, y, width, height; /* of the window before it filled the screen */
};

/* Fails with GLFW's own reason. */
static tc_status fail_glfw(tc_error *error, const char *what)
{
    const char *reason = NULL;
    if (glfwGetError(&reason) == GLFW_NO_ERROR || !reason)
        reason = "no reason given";
    return tc_fail(error, TC_ERR_CONTEXT, "window: %s: %s", what, reason);
}

/* Hides or shows the pointer as captured and held ask for. */
static void apply_capture(tc_window *window)
{
    bool capture = window->captured || window->held;
    int mode = capture ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL;
    if (glfwGetInputMode(window->glfw, GLFW_CURSOR) == mode)
        return;
    glfwSetInputMode(window->glfw, GLFW_CURSOR, mode);
    /* Unaccelerated motion: a hand's movement turns the view by the same angle at any speed. */
    if (glfwRawMouseMotionSupported())
        glfwSetInputMode(window->glfw, GLFW_RAW_MOUSE_MOTION, capture ? GLFW_TRUE : GLFW_FALSE);
    glfwGetCursorPos(window->glfw, &window->last_x, &window->last_y);
}

/* The tc_key of a GLFW key; 0 for keys that nobody asks for. */
static int translate(int key, int scancode)
{
    switch (key) {
    case GLFW_KEY_ESCAPE: return TC_KEY_ESCAPE;
    case GLFW_KEY_F1: return TC_KEY_F1;
    case GLFW_KEY_F11: return TC_KEY_F11;
    default: break;
    }
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
    (void)modifiers;
    tc_window *window = glfwGetWindowUserPointer(glfw);
    if (action != GLFW_PRESS)
        return;
    if (key == GLFW_KEY_ESCAPE && (window->captured || window->held)) {
        window->captured = window->held = false;
        apply_capture(window);
        return;
    }
    int translated = translate(key, scancode);
    if (translated && window->events.pressed_count < TC_WINDOW_MAX_PRESSED)
        window->events.pressed[window->events.pressed_count++] = translated;
}

static void on_button(GLFWwindow *glfw, int button, int action, int modifiers)
{
    (void)modifiers;
    tc_window *window = glfwGetWindowUserPointer(glfw);
    if (button == GLFW_MOUSE_BUTTON_LEFT && window->drags) {
        window->dragging = action == GLFW_PRESS;
        glfwGetCursorPos(glfw, &window->last_x, &window->last_y);
        return;
    }
    if (button == GLFW_MOUSE_BUTTON_LEFT && action == GLFW_PRESS)
        window->captured = true;
    if (button == GLFW_MOUSE_BUTTON_RIGHT)
        window->held = action == GLFW_PRESS;
    apply_capture(window);
}

static void on_motion(GLFWwindow *glfw, double x, double y)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    bool looking = window->captured || window->held;
    if (!looking && !window->dragging)
        return;
    double *right = looking ? &window->events.look_x : &window->events.drag_x;
    double *down = looking ? &window->events.look_y : &window->events.drag_y;
    *right += x - window->last_x;
    *down += y - window->last_y;
    window->last_x = x;
    window->last_y = y;
}

static void on_wheel(GLFWwindow *glfw, double x, double y)
{
    (void)x;
    tc_window *window = glfwGetWindowUserPointer(glfw);
    window->events.wheel += y;
}

static void on_focus(GLFWwindow *glfw, int focused)
{
    tc_window *window = glfwGetWindowUserPointer(glfw);
    if (!focused) { /* the button's release goes to another window */
        window->held = window->dragging = false;
        apply_capture(window);
    }
}

static void window_close(tc_window *window)
{
    if (!window)
        return;
    glfwDestroyWindow(window->glfw);
    glfwTerminate();
    free(window);
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
    /* Finished frames are copied in: the window itself needs neither depth nor samples. */
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    window->drags = options->drag;
    window->glfw = glfwCreateWindow(width, height, options->title ? options->title : "", NULL, NULL);
    if (!window->glfw) {
        tc_status status = fail_glfw(error, "no window with OpenGL 4.5 core");
        glfwTerminate();
        free(window);
        return status;
    }
    glfwSetWindowUserPointer(window->glfw, window);
    glfwSetKeyCallback(window->glfw, on_key);
    glfwSetMouseButtonCallback(window->glfw, on_button);
    glfwSetCursorPosCallback(window->glfw, on_motion);
    glfwSetScrollCallback(window->glfw, on_wheel);
    glfwSetWindowFocusCallback(window->glfw, on_focus);
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
    return glfwGetKey(window->glfw, key) == GLFW_PRESS ? 1 : 0;
}

static void window_poll(tc_window *window, double wait_seconds, tc_window_input *input_ret)
{
    memset(&window->events, 0, sizeof window->events);
    if (wait_seconds > 0)
        glfwWaitEventsTimeout(wait_seconds);
    else
        glfwPollEvents();
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
    *input_ret = *input;
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
    .swap = window_swap,
    .set_title = window_set_title,
    .toggle_full_screen = window_toggle_full_screen,
};
