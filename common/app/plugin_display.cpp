/* plugin_display.cpp - draws a tc_display by Dear ImGui, and tells what was done in it; see plugin_display.h. */
#include "plugin_display.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <imgui.h>
#include <imgui_internal.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>

namespace
{

const float FONT_SIZE = 13;                        /* of ImGui's own font, whose pixels are whole then */
const float LEAST_WIDTH = 150, LEAST_HEIGHT = 110; /* of a window that has room for anything */
const float MARGIN = 8, GAP = 4, COMPASS = 56, LOW = 80, PANEL = 330, HELP = 560, WORK = 360, BAR_HEIGHT = 8;
const ImU32 SHADE = IM_COL32(0, 0, 0, 130), INK = IM_COL32(255, 255, 255, 255), WARNING = IM_COL32(255, 200, 90, 255),
            BAR = IM_COL32(90, 160, 240, 255), NEEDLE = IM_COL32(235, 70, 60, 255), TAIL = IM_COL32(215, 215, 215, 255);

enum { ENTRIES = 4, KEYS = 512 };

struct entry {
    int id; /* of its row; -1: free */
    char text[TC_DISPLAY_ENTRY];
};

} // namespace

struct tc_overlay {
    GLFWwindow *window;
    bool shown;                      /* in the last frame: events may be its */
    float scale;                     /* that font and style are made for */
    float unit;                      /* of what has a size, in the window's coordinates */
    float panel_right, panel_bottom; /* 0: none */
    int edited;                      /* row whose slider is held, -1 none; */
    double value;                    /* which is here meanwhile */
    entry entries[ENTRIES];
    unsigned taken;                      /* buttons whose press was the display's, bit by bit */
    std::bitset<KEYS> pressed, released; /* since the last frame; released too early to have been seen */
    void (*bind_framebuffer)(unsigned int target, unsigned int framebuffer);
};

namespace
{

/* ---- Beginning --------------------------------------------------------------------------------------------------- */

/* Font and style for a screen's scale, made anew when the window goes to another screen. */
void set_scale(tc_overlay *o)
{
    float x = 1, y = 1;
    int width = 1, height = 1, pixels = 1, rows = 1;
    glfwGetWindowContentScale(o->window, &x, &y);
    glfwGetWindowSize(o->window, &width, &height);
    glfwGetFramebufferSize(o->window, &pixels, &rows);
    const float scale = std::min(std::max(x, 1.0f), 8.0f),
                dense = width > 0 && pixels > 0 ? (float)pixels / (float)width : 1;
    o->unit = scale / dense;
    ImGuiIO &io = ImGui::GetIO();
    io.FontGlobalScale = 1 / dense;
    if (scale == o->scale)
        return;
    ImFontConfig config;
    config.SizePixels = std::round(FONT_SIZE * scale);
    io.Fonts->Clear();
    io.Fonts->AddFontDefault(&config);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
    ImGuiStyle style;
    ImGui::StyleColorsDark(&style);
    style.WindowRounding = style.FrameRounding = 3;
    style.Colors[ImGuiCol_WindowBg].w = 0.92f;
    style.ScaleAllSizes(o->unit);
    ImGui::GetStyle() = style;
    o->scale = scale;
}

/* ---- Texts ------------------------------------------------------------------------------------------------------- */

ImU32 faded(ImU32 colour, double opacity)
{
    ImVec4 c = ImGui::ColorConvertU32ToFloat4(colour);
    c.w *= (float)std::min(std::max(opacity, 0.0), 1.0);
    return ImGui::ColorConvertFloat4ToU32(c);
}

ImVec2 size_of(const char *text, float wrap)
{
    return ImGui::CalcTextSize(text, nullptr, false, wrap);
}

/* A text on a shade, so that it is read over snow and over night. */
void write(const tc_overlay *o, ImVec2 at, const tc_display_text *t, float wrap)
{
    const float pad = 4 * o->unit;
    const ImVec2 size = size_of(t->text, wrap);
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(ImVec2(at.x - pad, at.y - pad / 2), ImVec2(at.x + size.x + pad, at.y + size.y + pad / 2),
                        faded(SHADE, t->opacity), 3 * o->unit);
    list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), at, faded(t->warning ? WARNING : INK, t->opacity), t->text,
                  nullptr, wrap);
}

/* The lines of a side, from y on down, or where `up` from y on up; returns where the next would begin. `align`: 0 they
 * begin at x, 1 they end there, a half they have it in the middle. *width: of the widest, where it is wider. */
float write_side(const tc_overlay *o, const tc_display *display, tc_display_side side, float x, float y, float align,
                 bool up, float most, float *width)
{
    const float step = GAP * o->unit;
    for (int k = 0; k < display->texts; k++) {
        const tc_display_text *t = &display->text[up ? display->texts - 1 - k : k];
        if (t->side != side)
            continue;
        const ImVec2 size = size_of(t->text, most);
        y -= up ? size.y : 0;
        write(o, ImVec2(std::floor(x - align * size.x), std::floor(y)), t, most);
        y += up ? -step : size.y + step;
        *width = std::max(*width, size.x);
    }
    return y;
}

float width_of(const tc_display *display, tc_display_side side, float most)
{
    float width = 0;
    for (int k = 0; k < display->texts; k++)
        if (display->text[k].side == side)
            width = std::max(width, size_of(display->text[k].text, most).x);
    return width;
}

/* Beside the pointer, in as many lines as there is room for. */
void tip(const tc_overlay *o, const char *text)
{
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(std::min(PANEL * o->unit, ImGui::GetIO().DisplaySize.x - 4 * MARGIN * o->unit));
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

/* ---- Scale and compass ------------------------------------------------------------------------------------------- */

/* A bar with its length above, at the bottom left; returns the y above it. */
float draw_scale(const tc_overlay *o, const tc_display *display, float x, float bottom)
{
    if (display->scale_pixels <= 0)
        return bottom;
    const float u = o->unit, dense = ImGui::GetIO().DisplayFramebufferScale.x, pad = 4 * u;
    const float length = (float)display->scale_pixels / (dense > 0 ? dense : 1), tick = 4 * u;
    const ImVec2 text = size_of(display->scale, 0);
    const float width = std::max(length, text.x), top = bottom - text.y - tick - 2 * u;
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(ImVec2(x - pad, top - pad / 2), ImVec2(x + width + pad, bottom + pad / 2), SHADE, 3 * u);
    list->AddText(ImVec2(std::floor(x + (width - text.x) / 2), std::floor(top)), INK, display->scale);
    const float from = std::floor(x + (width - length) / 2) + 0.5f, to = std::floor(from + length) + 0.5f,
                base = std::floor(bottom) - 0.5f, line = std::max(1.0f, std::floor(1.5f * u));
    list->AddLine(ImVec2(from, base), ImVec2(to, base), INK, line);
    list->AddLine(ImVec2(from, base), ImVec2(from, base - tick), INK, line);
    list->AddLine(ImVec2(to, base), ImVec2(to, base - tick), INK, line);
    return top - 2 * GAP * u;
}

/* A rose whose needle points north; whether it was clicked. */
bool draw_compass(const tc_overlay *o, const tc_display *display, float right, float top)
{
    const float u = o->unit, size = COMPASS * u, radius = size / 2 - 1;
    ImGui::SetNextWindowPos(ImVec2(right - size, top));
    ImGui::SetNextWindowSize(ImVec2(size, size));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    ImGui::Begin("##compass", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    const bool clicked = ImGui::InvisibleButton("##north", ImVec2(size, size));
    const bool hovered = ImGui::IsItemHovered();
    ImDrawList *list = ImGui::GetWindowDrawList();
    const ImVec2 middle(right - size / 2, top + size / 2);
    const float c = (float)std::cos(display->heading), s = (float)std::sin(display->heading);
    /* Of the rose, x east and y north, turned so that the heading is up. */
    auto at = [&](float x, float y) {
        return ImVec2(middle.x + radius * (x * c - y * s), middle.y - radius * (y * c + x * s));
    };
    list->AddCircleFilled(middle, radius, hovered ? IM_COL32(0, 0, 0, 180) : SHADE, 40);
    list->AddCircle(middle, radius, IM_COL32(255, 255, 255, 170), 40, std::max(1.0f, u));
    for (int k = 0; k < 8; k++) {
        const float a = (float)k * 0.785398163f, in = k % 2 ? 0.9f : 0.82f;
        list->AddLine(at(std::sin(a) * in, std::cos(a) * in), at(std::sin(a), std::cos(a)),
                      IM_COL32(255, 255, 255, 170), std::max(1.0f, u));
    }
    list->AddTriangleFilled(at(0, 0.5f), at(0.16f, 0), at(-0.16f, 0), NEEDLE);
    list->AddTriangleFilled(at(0, -0.5f), at(-0.16f, 0), at(0.16f, 0), TAIL);
    const ImVec2 letter = size_of("N", 0), north = at(0, 0.67f);
    list->AddText(ImVec2(std::floor(north.x - letter.x / 2 + 0.5f), std::floor(north.y - letter.y / 2 + 0.5f)), INK,
                  "N");
    if (hovered)
        tip(o, "north up");
    ImGui::End();
    ImGui::PopStyleVar(2);
    return clicked;
}

/* ---- What is waited for ------------------------------------------------------------------------------------------ */

/* A bar filled to a share, or a part that wanders where that is not known. */
void draw_bar(const tc_overlay *o, const tc_display_work *work, ImVec2 from, ImVec2 to)
{
    const float u = o->unit, length = to.x - from.x, wanders = 0.25f;
    float begin = 0, end = (float)std::min(work->share, 1.0);
    if (work->share < 0) {
        begin = (1 - wanders) * (float)(0.5 - 0.5 * std::cos(work->seconds * 2));
        end = begin + wanders;
    }
    ImDrawList *list = ImGui::GetForegroundDrawList();
    list->AddRectFilled(from, to, IM_COL32(70, 70, 75, 255), 2 * u);
    if (end > 0)
        list->AddRectFilled(ImVec2(from.x + begin * length, from.y), ImVec2(from.x + end * length, to.y), BAR, 2 * u);
}

/* In the middle: of which file, what, and how far. */
void draw_work(const tc_overlay *o, const tc_display_work *work)
{
    char what[TC_DISPLAY_LENGTH + 32];
    if (work->share >= 0)
        snprintf(what, sizeof what, "%s: %.0f %%", work->what, std::floor(100 * work->share));
    else
        snprintf(what, sizeof what, work->seconds < 2 ? "%s ..." : "%s ... %.0f s", work->what, work->seconds);
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float u = o->unit, pad = 2 * MARGIN * u, width = std::min(WORK * u, size.x - 2 * MARGIN * u),
                wrap = width - 2 * pad;
    const ImVec2 name = size_of(work->name, wrap), line = size_of(what, wrap);
    const float height = name.y + line.y + 2 * pad + (2 * GAP + BAR_HEIGHT) * u;
    const ImVec2 at(std::floor((size.x - width) / 2), std::floor((size.y - height) / 2));
    ImDrawList *list = ImGui::GetForegroundDrawList();
    list->AddRectFilled(at, ImVec2(at.x + width, at.y + height), IM_COL32(20, 20, 22, 235), 4 * u);
    ImVec2 pen(at.x + pad, at.y + pad);
    list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), pen, INK, work->name, nullptr, wrap);
    pen.y += name.y + GAP * u;
    draw_bar(o, work, pen, ImVec2(pen.x + wrap, pen.y + BAR_HEIGHT * u));
    pen.y += (BAR_HEIGHT + GAP) * u;
    list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), pen, INK, what, nullptr, wrap);
}

/* ---- Help -------------------------------------------------------------------------------------------------------- */

bool draw_help(const tc_overlay *o, const tc_display *display)
{
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float u = o->unit, width = std::min(HELP * u, size.x - 2 * MARGIN * u);
    bool open = true;
    ImGui::SetNextWindowPos(ImVec2(std::floor(size.x / 2), std::floor(size.y / 2)), ImGuiCond_Always,
                            ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, size.y - 2 * MARGIN * u));
    ImGui::Begin("Keys and mouse", &open,
                 ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav);
    if (ImGui::BeginTable("##keys", 2)) {
        ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed);
        ImGui::TableSetupColumn("help", ImGuiTableColumnFlags_WidthStretch);
        for (int k = 0; k < display->keys; k++) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(display->key[k].label);
            ImGui::TableNextColumn();
            ImGui::TextWrapped("%s", display->key[k].help);
        }
        ImGui::EndTable();
    }
    ImGui::End();
    return open;
}

/* ---- The panel --------------------------------------------------------------------------------------------------- */

/* What a row is to be: reported at once, or where it takes long once the user lets go. */
void edit(tc_overlay *o, const tc_display_row *row, bool changed, double value, tc_display_result *result)
{
    const bool held = ImGui::IsItemActive();
    if (changed || (held && o->edited == row->id))
        o->edited = row->id, o->value = changed ? value : o->value;
    if (o->edited == row->id && (row->late ? ImGui::IsItemDeactivated() : changed) && o->value != row->value)
        result->changed = row->id, result->value = o->value;
    if (o->edited == row->id && !held)
        o->edited = -1;
}

double shown(const tc_overlay *o, const tc_display_row *row)
{
    return o->edited == row->id ? o->value : row->value;
}

void draw_switch(tc_overlay *o, const tc_display_row *row, tc_display_result *result)
{
    (void)o;
    bool on = row->value != 0;
    if (ImGui::Checkbox(row->label, &on))
        result->changed = row->id, result->value = on ? 1 : 0;
}

void draw_slider(tc_overlay *o, const tc_display_row *row, tc_display_result *result)
{
    double value = shown(o, row);
    const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (row->logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    const bool changed = ImGui::SliderScalar("##slider", ImGuiDataType_Double, &value, &row->least, &row->most,
                                             row->format ? row->format : "%.3g", flags);
    edit(o, row, changed, value, result);
}

void draw_count(tc_overlay *o, const tc_display_row *row, tc_display_result *result)
{
    int value = (int)shown(o, row);
    const bool changed = ImGui::SliderInt("##count", &value, (int)row->least, (int)row->most,
                                          row->format ? row->format : "%d", ImGuiSliderFlags_AlwaysClamp);
    edit(o, row, changed, value, result);
}

void draw_choice(tc_overlay *o, const tc_display_row *row, tc_display_result *result)
{
    (void)o;
    int count = 0;
    while (row->names[count])
        count++;
    const int now = (int)row->value;
    if (!ImGui::BeginCombo("##choice", now >= 0 && now < count ? row->names[now] : ""))
        return;
    for (int k = 0; k < count; k++)
        if (ImGui::Selectable(row->names[k], k == now) && k != now)
            result->changed = row->id, result->value = k;
    ImGui::EndCombo();
}

void draw_entry(tc_overlay *o, const tc_display_row *row, tc_display_result *result)
{
    entry *e = o->entries;
    while (e < o->entries + ENTRIES - 1 && e->id != row->id && e->id >= 0)
        e++;
    e->id = row->id;
    if (!ImGui::InputTextWithHint("##entry", row->help ? row->help : "", e->text, sizeof e->text,
                                  ImGuiInputTextFlags_EnterReturnsTrue) ||
        !*e->text)
        return;
    result->changed = row->id;
    memcpy(result->entry, e->text, sizeof result->entry);
    e->text[0] = '\0';
}

typedef void draw_row(tc_overlay *, const tc_display_row *, tc_display_result *);
const struct {
    draw_row *draw;
    bool labelled; /* its label stands before it */
} row_kinds[] = {{nullptr, false},   {draw_switch, false}, {draw_slider, true},
                 {draw_count, true}, {draw_choice, true},  {draw_entry, true}}; /* as tc_row_kind */

bool draw_panel(tc_overlay *o, const tc_display *display, tc_display_result *result)
{
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float u = o->unit, width = std::min(PANEL * u, size.x - 2 * MARGIN * u);
    bool open = true;
    ImGui::SetNextWindowPos(ImVec2(MARGIN * u, MARGIN * u));
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, size.y - 2 * MARGIN * u));
    ImGui::Begin("Settings", &open,
                 ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav);
    for (int k = 0; k < display->rows; k++) {
        const tc_display_row *row = &display->row[k];
        if (row->kind == TC_ROW_HEADING) {
            ImGui::Spacing();
            ImGui::TextDisabled("%s", row->label);
            continue;
        }
        ImGui::PushID(row->id);
        if (row_kinds[row->kind].labelled) {
            ImGui::AlignTextToFramePadding();
            ImGui::TextUnformatted(row->label);
            ImGui::SameLine(0.4f * width);
            ImGui::SetNextItemWidth(-1);
        }
        row_kinds[row->kind].draw(o, row, result);
        if (row->help && row->kind != TC_ROW_ENTRY && ImGui::IsItemHovered())
            tip(o, row->help);
        ImGui::PopID();
    }
    o->panel_right = ImGui::GetWindowPos().x + ImGui::GetWindowSize().x;
    o->panel_bottom = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y;
    ImGui::End();
    return open;
}

/* ---- Events ------------------------------------------------------------------------------------------------------ */

/* Whether the pointer is over something that takes its buttons, where it is now: ImGui itself only knows where it was
 * in the last frame. */
bool over(const tc_overlay *o)
{
    if (!o || !o->shown || glfwGetInputMode(o->window, GLFW_CURSOR) == GLFW_CURSOR_DISABLED)
        return false;
    double x, y;
    glfwGetCursorPos(o->window, &x, &y);
    for (const ImGuiWindow *w : ImGui::GetCurrentContext()->Windows)
        if (w->Active && !w->Hidden && !(w->Flags & ImGuiWindowFlags_NoMouseInputs) &&
            w->Rect().Contains(ImVec2((float)x, (float)y)))
            return true;
    return ImGui::GetCurrentContext()->OpenPopupStack.Size > 0;
}

/* The keys that came and went between two frames, of which ImGui would not know. */
void let_go(tc_overlay *o)
{
    for (int key = 0; key < KEYS; key++)
        if (o->released[(size_t)key])
            ImGui_ImplGlfw_KeyCallback(o->window, key, 0, GLFW_RELEASE, 0);
    o->pressed.reset(), o->released.reset();
}

} // namespace

/* ---- As C knows it ----------------------------------------------------------------------------------------------- */

tc_overlay *tc_overlay_create(GLFWwindow *window)
{
    tc_overlay *o = new (std::nothrow) tc_overlay();
    if (!o)
        return nullptr;
    o->window = window, o->edited = -1;
    for (entry &e : o->entries)
        e.id = -1;
    GLFWglproc bind = glfwGetProcAddress("glBindFramebuffer");
    memcpy(&o->bind_framebuffer, &bind, sizeof bind);
    ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = io.LogFilename = nullptr; /* nothing is written */
    if (!o->bind_framebuffer || !ImGui_ImplGlfw_InitForOpenGL(window, false)) {
        ImGui::DestroyContext();
        delete o;
        return nullptr;
    }
    ImGui_ImplOpenGL3_Init("#version 330 core");
    return o;
}

void tc_overlay_destroy(tc_overlay *o)
{
    if (!o)
        return;
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    delete o;
}

void tc_overlay_show(tc_overlay *o, const tc_display *display, tc_display_result *result)
{
    *result = tc_display_result();
    result->changed = -1;
    o->shown = true;
    set_scale(o);
    ImGuiIO &io = ImGui::GetIO();
    const bool captured = glfwGetInputMode(o->window, GLFW_CURSOR) == GLFW_CURSOR_DISABLED;
    io.ConfigFlags = captured ? ImGuiConfigFlags_NoMouse : 0;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const float u = o->unit, margin = MARGIN * u, width = io.DisplaySize.x, height = io.DisplaySize.y;
    o->panel_right = o->panel_bottom = 0;
    if (width >= LEAST_WIDTH * u && height >= LEAST_HEIGHT * u) {
        const float most = width - 2 * margin;
        result->north = !display->work.alone && draw_compass(o, display, width - margin, margin);
        result->panel_closed = display->panel && !draw_panel(o, display, result);
        result->help_closed = display->help && !draw_help(o, display);
        float unused = 0, left = 0;
        /* Beside a panel that reaches down there. */
        const float x = o->panel_bottom > height - LOW * u ? o->panel_right + margin : margin;
        const float left_top =
            write_side(o, display, TC_SIDE_LEFT, x, draw_scale(o, display, x, height - margin), 0, true, most, &left);
        left = std::max(left, (float)display->scale_pixels);
        const bool beside = x + left + width_of(display, TC_SIDE_RIGHT, most) + 3 * margin <= width;
        write_side(o, display, TC_SIDE_RIGHT, width - margin, beside ? height - margin : left_top, 1, true, most,
                   &unused);
        const float compass = COMPASS * u + 2 * margin, room = width - compass - o->panel_right - 2 * margin;
        write_side(o, display, TC_SIDE_CORNER, width - margin, compass, 1, false, most, &unused);
        if (room > 100 * u)
            write_side(o, display, TC_SIDE_TOP, o->panel_right + margin + room / 2, margin, 0.5f, false, room, &unused);
        if (display->work.name[0])
            draw_work(o, &display->work);
    }
    ImGui::Render();
    if (io.DisplaySize.x > 0 && io.DisplaySize.y > 0) {
        o->bind_framebuffer(0x8D40 /* GL_FRAMEBUFFER */, 0);
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    }
    let_go(o);
    result->pointed = !captured && glfwGetWindowAttrib(o->window, GLFW_HOVERED) && !over(o);
    if (result->pointed) {
        glfwGetCursorPos(o->window, &result->x, &result->y);
        result->x *= (double)io.DisplayFramebufferScale.x, result->y *= (double)io.DisplayFramebufferScale.y;
    }
}

void tc_overlay_next(tc_overlay *o)
{
    if (o)
        o->shown = false;
}

bool tc_overlay_key(tc_overlay *o, int key, int scancode, int action, int modifiers)
{
    if (!o || key < 0 || key >= KEYS)
        return false;
    const bool typing = tc_overlay_typing(o);
    if (action == GLFW_RELEASE && o->pressed[(size_t)key])
        o->released.set((size_t)key);
    else
        ImGui_ImplGlfw_KeyCallback(o->window, key, scancode, action, modifiers);
    if (action == GLFW_PRESS)
        o->pressed.set((size_t)key);
    return typing && action != GLFW_RELEASE;
}

bool tc_overlay_character(tc_overlay *o, unsigned int character)
{
    if (!tc_overlay_typing(o))
        return false;
    ImGui_ImplGlfw_CharCallback(o->window, character);
    return true;
}

bool tc_overlay_button(tc_overlay *o, int button, int action, int modifiers)
{
    if (!o || (!o->shown && !o->taken))
        return false;
    ImGui_ImplGlfw_MouseButtonCallback(o->window, button, action, modifiers);
    const unsigned bit = 1u << button;
    const bool taken = action == GLFW_PRESS ? over(o) : (o->taken & bit) != 0;
    o->taken = taken && action == GLFW_PRESS ? o->taken | bit : o->taken & ~bit;
    return taken;
}

bool tc_overlay_wheel(tc_overlay *o, double x, double y)
{
    if (!over(o))
        return false;
    ImGui_ImplGlfw_ScrollCallback(o->window, x, y);
    return true;
}

void tc_overlay_focus(tc_overlay *o, int focused)
{
    if (o)
        ImGui_ImplGlfw_WindowFocusCallback(o->window, focused);
}

void tc_overlay_enter(tc_overlay *o, int entered)
{
    if (o)
        ImGui_ImplGlfw_CursorEnterCallback(o->window, entered);
}

bool tc_overlay_typing(const tc_overlay *o)
{
    return o && o->shown && ImGui::GetActiveID() != 0;
}
