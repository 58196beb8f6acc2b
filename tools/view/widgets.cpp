/* SPDX-License-Identifier: MIT */
#include "widgets.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <cmath>
#include <cstdarg>

namespace
{
VkDevice device;
VkDescriptorPool pool;
bool glfw_runs, vulkan_runs;
bool choice_closes;

/* Texels that letters are high, in the font's own grid or multiples of it, or near enough. */
const float font_sizes[] = {13.0f, 16.0f, 20.0f, 26.0f, 32.0f, 39.0f, 52.0f};
enum { FONTS = sizeof font_sizes / sizeof *font_sizes };
ImFont *fonts[FONTS];
float unit = 1.0f;     /* coordinates of Dear ImGui per unit */
float below = 170.0f;  /* what the panel had behind the part that scrolls */
float below_begins;    /* where that part ends */
float scrolls = -1.0f; /* how far the panel could scroll */
int unsettled;         /* frames in a row that were laid out by what the one before had */

/* Texels of the framebuffer -> coordinates. */
ImVec2 place(float x, float y)
{
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    return ImVec2(scale.x > 0.0f ? x / scale.x : x, scale.y > 0.0f ? y / scale.y : y);
}

/* Texels of the framebuffer per coordinate. The sizes of window and framebuffer are asked for one
 * after the other: while a window is resized they differ by any factor for a frame, and of a style
 * scaled by that Dear ImGui aborts. What no monitor has is not believed. */
float density()
{
    static const float most = 8.0f;
    static float last = 1.0f;
    const float seen = ImGui::GetIO().DisplayFramebufferScale.y;
    if (seen >= 1.0f / most && seen <= most)
        last = seen;
    return last;
}

int nearest_font(double scale)
{
    int nearest = 0;
    for (int i = 1; i < FONTS; i++)
        if (std::fabs(font_sizes[i] - font_sizes[0] * scale) <
            std::fabs(font_sizes[nearest] - font_sizes[0] * scale))
            nearest = i;
    return nearest;
}

void set_style()
{
    ImGuiStyle style;
    ImGui::StyleColorsDark(&style);
    style.WindowRounding = 0.0f;
    style.WindowBorderSize = 0.0f;
    style.ScaleAllSizes(unit);
    ImGui::GetStyle() = style;
}

struct vulkan_failure {
    VkResult result;
};

/* Dear ImGui goes on after an error and uses what it has not got: so it is left at once. */
void on_result(VkResult result)
{
    if (result < 0)
        throw vulkan_failure{result};
}

/* After a failure nobody knows which of its objects the back end still has: they are left to the
 * device's end. */
bool draw_or_fail(struct tool_error *err, void (*draw)(void *), void *data)
{
    try {
        draw(data);
        return true;
    } catch (const vulkan_failure &failure) {
        vulkan_runs = false;
        ImGui::GetIO().BackendRendererUserData = nullptr;
        return gpu_ok(err, "drawing the panel", failure.result);
    }
}

void create_pool()
{
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1};
    VkDescriptorPoolCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    info.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
    info.maxSets = 1; /* the font */
    info.poolSizeCount = 1;
    info.pPoolSizes = &size;
    const VkResult result = vkCreateDescriptorPool(device, &info, nullptr, &pool);
    if (result != VK_SUCCESS)
        pool = VK_NULL_HANDLE;
    on_result(result);
}

struct creation {
    struct gpu *gpu;
    VkRenderPass pass;
    uint32_t image_count;
    struct tool_error *err;
    bool ok;
};

void create_back_end(void *data)
{
    creation *c = static_cast<creation *>(data);
    struct gpu *gpu = c->gpu;
    create_pool();
    ImGui_ImplVulkan_InitInfo info = {};
    info.Instance = gpu->instance;
    info.PhysicalDevice = gpu->physical_device;
    info.Device = gpu->device;
    info.QueueFamily = gpu->queue_family;
    info.Queue = gpu->queue;
    info.DescriptorPool = pool;
    info.MinImageCount = 2;
    info.ImageCount = c->image_count < 2 ? 2 : c->image_count;
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    info.CheckVkResultFn = on_result;
    vulkan_runs = ImGui_ImplVulkan_Init(&info, c->pass);
    VkCommandBuffer cmd = gpu_begin(gpu, c->err);
    if (!cmd)
        return;
    ImGui_ImplVulkan_CreateFontsTexture(cmd);
    c->ok = gpu_submit(gpu, cmd, c->err);
    ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void render(void *cmd)
{
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), static_cast<VkCommandBuffer>(cmd));
}
} // namespace

bool widgets_create(void *glfw_window, struct gpu *gpu, VkRenderPass pass, uint32_t image_count,
                    struct tool_error *err)
{
    device = gpu->device;
    pool = VK_NULL_HANDLE;
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr; /* nothing is written that nobody asked for */
    ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
    for (int i = 0; i < FONTS; i++) {
        ImFontConfig config;
        config.SizePixels = font_sizes[i];
        fonts[i] = ImGui::GetIO().Fonts->AddFontDefault(&config);
    }
    set_style();
    creation c = {gpu, pass, image_count, err, false};
    glfw_runs = ImGui_ImplGlfw_InitForVulkan(static_cast<GLFWwindow *>(glfw_window), true);
    if (glfw_runs && draw_or_fail(err, create_back_end, &c) && c.ok)
        return true;
    fail(err, EXIT_DEVICE, "cannot draw the panel");
    widgets_destroy();
    return false;
}

void widgets_destroy(void)
{
    if (!ImGui::GetCurrentContext())
        return;
    if (vulkan_runs)
        ImGui_ImplVulkan_Shutdown();
    if (glfw_runs)
        ImGui_ImplGlfw_Shutdown();
    vulkan_runs = glfw_runs = false;
    ImGui::DestroyContext();
    vkDestroyDescriptorPool(device, pool, nullptr);
}

double widgets_scale(double scale)
{
    return font_sizes[nearest_font(scale)] / font_sizes[0];
}

void widgets_begin_frame(double scale, const struct button_event *event)
{
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGuiIO &io = ImGui::GetIO();
#if IMGUI_VERSION_NUM < 18700 /* later ones take events one by one themselves */
    static bool is_down;
    if (event) {
        is_down = event->down;
        io.MousePos = place(static_cast<float>(event->x), static_cast<float>(event->y));
    }
    io.MouseDown[0] = is_down;
#else
    (void)event;
#endif
    const int font = nearest_font(scale);
    const float dense = density();
    const float wanted = font_sizes[font] / font_sizes[0] / dense;
    io.FontDefault = fonts[font];
    io.FontGlobalScale = 1.0f / dense;
    if (wanted < unit || wanted > unit) {
        below *= wanted / unit;
        unit = wanted;
        set_style();
    }
    ImGui::NewFrame();
}

bool widgets_end_frame(VkCommandBuffer cmd, struct tool_error *err)
{
    choice_closes = false;
    ImGui::Render();
    return !cmd || draw_or_fail(err, render, cmd);
}

bool widgets_hold_mouse(void)
{
    return (ImGui::IsAnyItemActive() && !widgets_want_keyboard()) ||
           ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

bool widgets_want_keyboard(void)
{
    /* Not WantCaptureKeyboard: it is still set when a key follows the release of a slider. */
    return ImGui::GetIO().WantTextInput;
}

bool widgets_close_choice(void)
{
    choice_closes =
        ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    return choice_closes;
}

void ui_begin_panel(float width, float height)
{
    ImGui::SetNextWindowPos(ImVec2(0.0f, 0.0f));
    ImGui::SetNextWindowSize(place(width, height));
    ImGui::SetNextWindowBgAlpha(1.0f);
    ImGui::Begin("vkao", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
    ImGui::PushItemWidth(place(width, 0.0f).x * 0.5f);
    /* Tab is a key of the viewer: it opens no text field. */
    ImGui::PushAllowKeyboardFocus(false);
}

bool ui_end_panel(void)
{
    enum { MOST = 8 }; /* one that never settles is not drawn for ever */
    const float now = ImGui::GetCursorPosY() - below_begins, scrolls_now = ImGui::GetScrollMaxY();
    const bool same = std::fabs(now - below) < 0.5f && std::fabs(scrolls_now - scrolls) < 0.5f;
    below = now;
    scrolls = scrolls_now;
    unsettled = same ? 0 : unsettled + 1;
    ImGui::PopAllowKeyboardFocus();
    ImGui::PopItemWidth();
    ImGui::End();
    return unsettled == 0 || unsettled > MOST;
}

void ui_begin_scroll(void)
{
    const float left = ImGui::GetContentRegionAvail().y - below, least = 120.0f * unit;
    ImGui::BeginChild("scroll", ImVec2(0.0f, left > least ? left : least));
    ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.54f);
    ImGui::PushAllowKeyboardFocus(false);
}

void ui_end_scroll(void)
{
    ImGui::PopAllowKeyboardFocus();
    ImGui::PopItemWidth();
    ImGui::EndChild();
    below_begins = ImGui::GetCursorPosY();
}

bool ui_section(const char *label, bool open)
{
    return ImGui::CollapsingHeader(label, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

void ui_text(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    ImGui::TextV(format, args);
    va_end(args);
}

void ui_paragraph(enum ui_tone tone, const char *text)
{
    const ImVec4 colors[] = {{1.0f, 1.0f, 1.0f, 1.0f},
                             {0.6f, 0.6f, 0.6f, 1.0f},
                             {0.5f, 0.9f, 0.5f, 1.0f},
                             {1.0f, 0.8f, 0.3f, 1.0f},
                             {1.0f, 0.5f, 0.4f, 1.0f}};
    ImGui::PushStyleColor(ImGuiCol_Text, colors[tone]);
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

void ui_same_line(void)
{
    ImGui::SameLine();
}

void ui_separator(void)
{
    ImGui::Separator();
}

bool ui_button(const char *label)
{
    return ImGui::Button(label);
}

bool ui_radio(const char *label, bool on)
{
    return ImGui::RadioButton(label, on);
}

bool ui_checkbox(const char *label, bool *on)
{
    return ImGui::Checkbox(label, on);
}

bool ui_slider_float(const char *label, float *value, float low, float high, bool logarithmic)
{
    ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp;
    if (logarithmic)
        flags |= ImGuiSliderFlags_Logarithmic;
    return ImGui::SliderFloat(label, value, low, high, "%.4g", flags);
}

bool ui_slider_uint(const char *label, uint32_t *value, uint32_t low, uint32_t high,
                    bool logarithmic)
{
    ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp;
    if (logarithmic)
        flags |= ImGuiSliderFlags_Logarithmic;
    return ImGui::SliderScalar(label, ImGuiDataType_U32, value, &low, &high, "%u", flags);
}

bool ui_color(const char *label, float rgb[3])
{
    return ImGui::ColorEdit3(label, rgb, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoPicker);
}

void ui_histogram(uint32_t (*bins)[256], uint32_t curves, float height)
{
    static const ImU32 grey[] = {IM_COL32(200, 200, 200, 200)};
    static const ImU32 colors[] = {IM_COL32(220, 60, 60, 120), IM_COL32(60, 200, 60, 120),
                                   IM_COL32(80, 110, 255, 120)};
    ImDrawList *list = ImGui::GetWindowDrawList();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 size(ImGui::GetContentRegionAvail().x, height * unit);
    uint32_t most = 1;
    for (uint32_t c = 0; c < curves; c++)
        for (int i = 1; i < 255; i++)
            most = bins[c][i] > most ? bins[c][i] : most;
    ImGui::Dummy(size);
    list->AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), IM_COL32(0, 0, 0, 255));
    for (uint32_t c = 0; c < curves; c++) {
        for (int i = 0; i < 256; i++) {
            const float share = static_cast<float>(bins[c][i]) / static_cast<float>(most);
            const float tall = size.y * (share < 1.0f ? share : 1.0f);
            list->AddRectFilled(
                ImVec2(at.x + size.x * static_cast<float>(i) / 256, at.y + size.y - tall),
                ImVec2(at.x + size.x * static_cast<float>(i + 1) / 256, at.y + size.y),
                curves == 1 ? grey[0] : colors[c]);
        }
    }
}

bool ui_begin_choice(const char *label, const char *now)
{
    const bool open = ImGui::BeginCombo(label, now);
    if (open && choice_closes)
        ImGui::CloseCurrentPopup();
    return open;
}

bool ui_choice(const char *word, bool chosen, bool enabled)
{
    return ImGui::Selectable(word, chosen, enabled ? 0 : ImGuiSelectableFlags_Disabled);
}

void ui_end_choice(void)
{
    ImGui::EndCombo();
}

void ui_help(const char *text)
{
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 28.0f);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool ui_clicked_right(void)
{
    return ImGui::IsItemClicked(ImGuiMouseButton_Right);
}

void ui_begin_disabled(bool disabled)
{
    ImGui::BeginDisabled(disabled);
}

void ui_end_disabled(void)
{
    ImGui::EndDisabled();
}

void ui_begin_box(float width, float height)
{
    const ImVec2 all = place(width, height);
    const float most = 420.0f * unit, edge = 16.0f * unit;
    const float wide = all.x - edge < most ? all.x - edge : most;
    ImGui::SetNextWindowPos(ImVec2(all.x / 2, all.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2(wide, 0.0f));
    ImGui::SetNextWindowFocus();
    ImGui::SetNextWindowBgAlpha(1.0f);
    ImGui::Begin("files", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushAllowKeyboardFocus(false);
}

void ui_end_box(void)
{
    ImGui::PopAllowKeyboardFocus();
    ImGui::End();
}

size_t ui_lines(float height)
{
    return static_cast<size_t>(place(0.0f, height).y / ImGui::GetTextLineHeightWithSpacing());
}

bool ui_label(float from, float to, float y, enum ui_place where, const char *text)
{
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    const float gap = 6.0f * unit, edge = 4.0f * unit, ledge = 2.0f * unit;
    const bool is_of_line = where == UI_LEFT_OF || where == UI_RIGHT_OF;
    const ImVec2 at = place(from, y), end = place(to, y);
    const float room = end.x - at.x - 2.0f * gap, wrap = is_of_line ? -1.0f : room;
    const ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, wrap);
    if (room < (is_of_line ? size.x : ImGui::GetFontSize()))
        return false;
    const float left = where == UI_LEFT_OF  ? end.x - gap - size.x
                       : where == UI_AROUND ? (at.x + end.x - size.x) / 2
                                            : at.x + gap;
    const float top = where == UI_ABOVE    ? at.y - size.y - gap
                      : where == UI_AROUND ? at.y - size.y / 2
                                           : at.y + gap;
    list->AddRectFilled(ImVec2(left - edge, top - ledge),
                        ImVec2(left + size.x + edge, top + size.y + ledge), IM_COL32(0, 0, 0, 180));
    list->AddText(nullptr, 0.0f, ImVec2(left, top), IM_COL32(255, 255, 255, 255), text, nullptr,
                  wrap);
    return true;
}

void ui_overlay(float width, float height, const char *text)
{
    ImDrawList *list = ImGui::GetForegroundDrawList();
    const float edge = 12.0f * unit;
    const ImVec2 all = place(width, height);
    const float wrap = all.x - 2 * edge;
    const ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, wrap);
    const float left = (all.x - size.x) / 2, top = (all.y - size.y) / 2;
    list->AddRectFilled(ImVec2(left - edge, top - edge),
                        ImVec2(left + size.x + edge, top + size.y + edge), IM_COL32(0, 0, 0, 230));
    list->AddText(nullptr, 0.0f, ImVec2(left, top), IM_COL32(255, 255, 255, 255), text, nullptr,
                  wrap);
}
