/* SPDX-License-Identifier: BSD-3-Clause */
/* Dear ImGui behind viewer/gui.h: the only file that knows it. Nothing in here throws: ImGui itself
 * is built without exceptions. */
#include <imgui.h>
#include <backends/imgui_impl_opengl3.h>

#include "viewer/bindings.h"
#include "viewer/gui.h"

/* A plain face that is easy to read; where it is not installed ImGui's own serves. */
static const char *const FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
static const float FONT_SIZE = 13;

/* Two frames in the same moment: ImGui wants time to have gone on. */
static const float LEAST_SECONDS = 1.0f / 4096;

static void set_style(double scale)
{
    ImGuiStyle &style = ImGui::GetStyle();
    ImGui::StyleColorsDark();
    style.WindowRounding = 4;
    style.FrameRounding = 3;
    style.WindowBorderSize = 0;
    style.WindowPadding = ImVec2(10, 8);
    style.ItemSpacing = ImVec2(8, 5);
    /* Opaque: figures and marks of the picture lie below. */
    style.Colors[ImGuiCol_WindowBg] = style.Colors[ImGuiCol_PopupBg] =
        ImVec4(0.09f, 0.10f, 0.11f, 1);
    style.Colors[ImGuiCol_TitleBgActive] = style.Colors[ImGuiCol_TitleBg] =
        style.Colors[ImGuiCol_TitleBgCollapsed] = ImVec4(0.14f, 0.18f, 0.24f, 1);
    style.Colors[ImGuiCol_PlotHistogram] = ImVec4(0.90f, 0.60f, 0.15f, 1);
    style.Colors[ImGuiCol_TextDisabled] = ImVec4(0.63f, 0.66f, 0.70f, 1);
    style.ScaleAllSizes((float)scale);
}

static void set_keys(ImGuiIO &io)
{
    io.KeyMap[ImGuiKey_Tab] = KEY_TAB;
    io.KeyMap[ImGuiKey_LeftArrow] = KEY_LEFT;
    io.KeyMap[ImGuiKey_RightArrow] = KEY_RIGHT;
    io.KeyMap[ImGuiKey_UpArrow] = KEY_UP;
    io.KeyMap[ImGuiKey_DownArrow] = KEY_DOWN;
    io.KeyMap[ImGuiKey_Home] = KEY_HOME;
    io.KeyMap[ImGuiKey_End] = KEY_END;
    io.KeyMap[ImGuiKey_Delete] = KEY_DELETE;
    io.KeyMap[ImGuiKey_Backspace] = KEY_BACKSPACE;
    io.KeyMap[ImGuiKey_Enter] = KEY_ENTER;
    io.KeyMap[ImGuiKey_Escape] = KEY_ESCAPE;
}

/* The library asserts that a font can be read: so it is tried first. */
static bool readable(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file != nullptr)
        fclose(file);
    return file != nullptr;
}

bool gui_create(double scale)
{
    ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr; /* nothing is left behind on disk */
    io.LogFilename = nullptr;
    set_style(scale);
    set_keys(io);
    if (readable(FONT))
        io.Fonts->AddFontFromFileTTF(FONT, FONT_SIZE * (float)scale);
    else
        io.FontGlobalScale = (float)scale;
    return ImGui_ImplOpenGL3_Init("#version 330 core");
}

void gui_destroy(void)
{
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

void gui_event(const Event *event)
{
    ImGuiIO &io = ImGui::GetIO();
    switch (event->kind) {
    case EVENT_KEY:
        if (event->code > 0 && event->code < IM_ARRAYSIZE(io.KeysDown))
            io.KeysDown[event->code] = event->down;
        io.KeyShift = (event->mods & MOD_SHIFT) != 0;
        io.KeyCtrl = (event->mods & MOD_CONTROL) != 0;
        io.KeyAlt = (event->mods & MOD_ALT) != 0;
        break;
    case EVENT_CHARACTER:
        io.AddInputCharacter((unsigned)event->code);
        break;
    case EVENT_BUTTON:
        io.MousePos = ImVec2((float)event->x, (float)event->y);
        io.MouseDown[event->code] = event->down;
        break;
    case EVENT_MOVE:
        io.MousePos = ImVec2((float)event->x, (float)event->y);
        break;
    case EVENT_WHEEL:
        io.MouseWheel += (float)event->y;
        break;
    case EVENT_CLOSE:
    case EVENT_SCALE:
        break;
    }
}

bool gui_has_mouse(void) { return ImGui::GetIO().WantCaptureMouse; }
bool gui_has_keys(void) { return ImGui::GetIO().WantTextInput; }

void gui_begin(int width, int height, double seconds)
{
    ImGuiIO &io = ImGui::GetIO();
    io.DisplaySize = ImVec2((float)width, (float)height);
    io.DeltaTime = (float)seconds > LEAST_SECONDS ? (float)seconds : LEAST_SECONDS;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
}

void gui_end(void)
{
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

/* --- panels ----------------------------------------------------------------------------------- */

void gui_fold(bool fold) { ImGui::SetNextWindowCollapsed(fold); }
double gui_title_height(void) { return (double)ImGui::GetFrameHeight(); }

bool gui_panel(const char *title, double x, double y, double width, double room)
{
    ImGui::SetNextWindowPos(ImVec2((float)x, (float)y));
    ImGui::SetNextWindowSize(ImVec2((float)width, 0));
    ImGui::SetNextWindowSizeConstraints(ImVec2((float)width, 0), ImVec2((float)width, (float)room));
    return ImGui::Begin(title, nullptr,
                        ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                            ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                            ImGuiWindowFlags_NoFocusOnAppearing);
}

double gui_panel_end(double *need)
{
    const ImGuiStyle &style = ImGui::GetStyle();
    if (need != nullptr && !ImGui::IsWindowCollapsed())
        *need = (double)(ImGui::GetCursorPosY() - style.ItemSpacing.y + style.WindowPadding.y);
    const double below = (double)ImGui::GetWindowPos().y + (double)ImGui::GetWindowHeight();
    ImGui::End();
    return below;
}

bool gui_overlay(const char *title, double width, double height)
{
    const ImVec2 room = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(0.5f * room.x, 0.5f * room.y), 0, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2((float)width, (float)height));
    return ImGui::Begin(title, nullptr,
                        ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                            ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                            ImGuiWindowFlags_NoCollapse);
}

void gui_notice(const char *text)
{
    const ImVec2 room = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(0.5f * room.x, room.y - 12), 0, ImVec2(0.5f, 1));
    ImGui::Begin("##notice", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::TextUnformatted(text);
    ImGui::End();
}

void gui_text(const char *text) { ImGui::TextUnformatted(text); }
void gui_dim(const char *text) { ImGui::TextDisabled("%s", text); }

void gui_heading(const char *text)
{
    ImGui::Spacing();
    ImGui::TextColored(ImVec4(0.95f, 0.72f, 0.30f, 1), "%s", text);
}

void gui_row(const char *name, double column, const char *text)
{
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine((float)column * 0.55f * ImGui::GetFontSize());
    ImGui::TextUnformatted(text);
}

void gui_bar(double share, const char *text)
{
    ImGui::ProgressBar((float)(share < 0 ? 0 : share > 1 ? 1 : share), ImVec2(-1, 0), "");
    const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
    const ImVec2 size = ImGui::CalcTextSize(text);
    const ImVec2 at(0.5f * (lo.x + hi.x - size.x), 0.5f * (lo.y + hi.y - size.y));
    ImGui::GetWindowDrawList()->AddText(ImVec2(at.x + 1, at.y + 1), IM_COL32(0, 0, 0, 200), text);
    ImGui::GetWindowDrawList()->AddText(at, IM_COL32(255, 255, 255, 255), text);
}

void gui_columns(int count) { ImGui::Columns(count, nullptr, false); }
void gui_next_column(void) { ImGui::NextColumn(); }
void gui_same_line(void) { ImGui::SameLine(); }
bool gui_button(const char *name) { return ImGui::Button(name); }
bool gui_check(const char *name, bool *value) { return ImGui::Checkbox(name, value); }

static void leave_room_for_name(void)
{
    ImGui::SetNextItemWidth(-7 * ImGui::GetFontSize());
}

bool gui_choice(const char *name, int *chosen, const char *const *names, int count)
{
    leave_room_for_name();
    return ImGui::Combo(name, chosen, names, count);
}

bool gui_slider(const char *name, double *value, double low, double high, const char *format,
                bool logarithmic)
{
    leave_room_for_name();
    return ImGui::SliderScalar(name, ImGuiDataType_Double, value, &low, &high, format,
                               logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
}

bool gui_colour(const char *name, double rgb[3])
{
    float c[3] = { (float)rgb[0], (float)rgb[1], (float)rgb[2] };
    const bool changed = ImGui::ColorEdit3(name, c, ImGuiColorEditFlags_NoInputs |
                                                    ImGuiColorEditFlags_NoLabel |
                                                    ImGuiColorEditFlags_PickerHueWheel);
    for (int k = 0; changed && k < 3; k++)
        rgb[k] = (double)c[k];
    return changed;
}

/* --- marks ------------------------------------------------------------------------------------ */

static ImU32 colour_of(GuiInk ink) { return IM_COL32(ink.r, ink.g, ink.b, ink.a); }

void gui_mark_box(double x0, double y0, double x1, double y1, GuiInk ink, bool filled)
{
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    const ImVec2 lo((float)(x0 < x1 ? x0 : x1), (float)(y0 < y1 ? y0 : y1));
    const ImVec2 hi((float)(x0 < x1 ? x1 : x0), (float)(y0 < y1 ? y1 : y0));
    if (filled)
        list->AddRectFilled(lo, hi, colour_of(ink));
    else
        list->AddRect(lo, hi, colour_of(ink), 0, 0, 1.5f);
}

void gui_mark_line(double x0, double y0, double x1, double y1, GuiInk ink)
{
    ImGui::GetBackgroundDrawList()->AddLine(ImVec2((float)x0, (float)y0),
                                            ImVec2((float)x1, (float)y1), colour_of(ink), 1.5f);
}

void gui_mark_dot(double x, double y, double radius, GuiInk ink)
{
    ImGui::GetBackgroundDrawList()->AddCircleFilled(ImVec2((float)x, (float)y), (float)radius,
                                                    colour_of(ink));
}

void gui_mark_text(double x, double y, GuiSide side, const char *text, GuiInk ink)
{
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::CalcTextSize(text);
    const float left = (float)x - 0.5f * (float)side * size.x, top = (float)y - 0.5f * size.y;
    list->AddText(ImVec2(left + 1, top + 1), IM_COL32(0, 0, 0, 220), text);
    list->AddText(ImVec2(left, top), colour_of(ink), text);
}
