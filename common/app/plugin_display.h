/* plugin_display.h - the display of a window, drawn by Dear ImGui over what is in the framebuffer: for
 * plugin_window.c. What events it takes are not the terrain's. Where there is no overlay (NULL), or it was not shown in
 * the last frame, it takes none. */
#ifndef TC_PLUGIN_DISPLAY_H
#define TC_PLUGIN_DISPLAY_H

#include "display.h"

#ifdef __cplusplus
extern "C" {
#endif

struct GLFWwindow;
typedef struct tc_overlay tc_overlay;

/* With the window's context current. NULL: it cannot be made. */
tc_overlay *tc_overlay_create(struct GLFWwindow *window);
void tc_overlay_destroy(tc_overlay *overlay);

/* Draws into framebuffer 0. OpenGL's state is as before, but for the framebuffer bound. */
void tc_overlay_show(tc_overlay *overlay, const tc_display *display, tc_display_result *result_ret);

/* A frame begins: what is not shown again takes no more events. */
void tc_overlay_next(tc_overlay *overlay);

/* Events as GLFW has them. True: it is the display's alone. */
bool tc_overlay_key(tc_overlay *overlay, int key, int scancode, int action, int modifiers);
bool tc_overlay_character(tc_overlay *overlay, unsigned int character);
bool tc_overlay_button(tc_overlay *overlay, int button, int action, int modifiers);
bool tc_overlay_wheel(tc_overlay *overlay, double x, double y);
void tc_overlay_focus(tc_overlay *overlay, int focused);
void tc_overlay_enter(tc_overlay *overlay, int entered);

/* Whether what is held on the keyboard is meant for it. */
bool tc_overlay_typing(const tc_overlay *overlay);

#ifdef __cplusplus
}
#endif
#endif
