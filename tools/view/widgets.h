/* SPDX-License-Identifier: MIT
 *
 * Dear ImGui, seen from C: its back ends for GLFW and Vulkan, and the few widgets that the panel is
 * made of. */
#ifndef VKAO_VIEW_WIDGETS_H_
#define VKAO_VIEW_WIDGETS_H_

#include "window.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* After the window's own callbacks are set: they are called first. Errors, also of the end of a
 * frame: EXIT_DEVICE, EXIT_MEMORY; then nothing but widgets_destroy may follow. */
bool widgets_create(void *glfw_window, struct gpu *gpu, VkRenderPass pass, uint32_t image_count,
                    struct tool_error *err);
void widgets_destroy(void);
/* Sizes that text can have: the nearest to `scale` texels of the framebuffer per unit, a unit being
 * a texel of a monitor of 96 dpi. */
double widgets_scale(double scale);
/* A frame sees one press or release of the left button, where it happened: what came while the
 * frame before was computed is then not lost, and clicks on what was there. NULL: there is none. */
void widgets_begin_frame(double scale, const struct button_event *event);
/* Inside the render pass; ends the frame. cmd may be VK_NULL_HANDLE to drop what was drawn. */
bool widgets_end_frame(VkCommandBuffer cmd, struct tool_error *err);
/* Wherever the mouse is: whether a slider is being dragged, or a list is open. */
bool widgets_hold_mouse(void);
/* Whether a text field is open, as of the last frame. */
bool widgets_want_keyboard(void);
/* Closes the list that is open; false if none is. */
bool widgets_close_choice(void);

/* In texels of the framebuffer. */
void ui_begin_panel(float width, float height);
/* False if widgets stand where those of the frame before wanted them: another frame is to be drawn.
 */
bool ui_end_panel(void);
/* Widgets in between scroll; those behind them stand at the end of the panel, if that is high
 * enough. */
void ui_begin_scroll(void);
void ui_end_scroll(void);
bool ui_section(const char *label, bool open);
void ui_text(const char *format, ...) TOOL_PRINTF(1, 2);
enum ui_tone { UI_PLAIN, UI_DIM, UI_GOOD, UI_WARNING, UI_BAD };
void ui_paragraph(enum ui_tone tone, const char *text);
void ui_same_line(void);
void ui_separator(void);
bool ui_button(const char *label);
bool ui_radio(const char *label, bool on);
bool ui_checkbox(const char *label, bool *on);
bool ui_slider_float(const char *label, float *value, float low, float high, bool logarithmic);
bool ui_slider_uint(const char *label, uint32_t *value, uint32_t low, uint32_t high,
                    bool logarithmic);
bool ui_color(const char *label, float rgb[3]);
/* Curves of 256 bins each: one of grey, or three of red, green and blue. height: units. */
void ui_histogram(uint32_t (*bins)[256], uint32_t curves, float height);
/* A list to choose from: ui_begin_choice, an ui_choice for each word if it returned true, then
 * ui_end_choice. */
bool ui_begin_choice(const char *label, const char *now);
bool ui_choice(const char *word, bool chosen, bool enabled);
void ui_end_choice(void);
/* Of the widget before it, also if that is greyed. */
void ui_help(const char *text);
bool ui_clicked_right(void);
void ui_begin_disabled(bool disabled);
void ui_end_disabled(void);
/* A box in the middle of width x height texels of the framebuffer, over the panel. */
void ui_begin_box(float width, float height);
void ui_end_box(void);
/* How many lines of text so many texels hold. */
size_t ui_lines(float height);
/* A word on the picture, on a dark ground, between two columns of texels of the framebuffer and
 * never beyond them: at the right one, at the left one, in the middle, or from the left one on and
 * above row y. At a column it takes one line. False, and nothing is drawn, if there is no room. */
enum ui_place { UI_LEFT_OF, UI_RIGHT_OF, UI_AROUND, UI_ABOVE };
bool ui_label(float from, float to, float y, enum ui_place place, const char *text);
/* Text over everything, in the middle of width x height texels. */
void ui_overlay(float width, float height, const char *text);

#ifdef __cplusplus
}
#endif
#endif
