/* SPDX-License-Identifier: MIT
 *
 * The state of the viewer, and the steps of one frame. */
#ifndef VKAO_VIEW_VIEWER_H_
#define VKAO_VIEW_VIEWER_H_

#include "arguments.h"
#include "browse.h"
#include "compute.h"
#include "display.h"
#include "history.h"
#include "live.h"
#include "probe.h"
#include "settings.h"
#include "source.h"
#include "swapchain.h"
#include "tone.h"
#include "window.h"

enum side { SIDE_A, SIDE_B, SIDES };
enum drag { DRAG_NONE, DRAG_PAN, DRAG_WIPE, DRAG_ORBIT };
enum { PANEL_WIDTH = 330, PANEL_HEIGHT = 640 }; /* units, see widgets_scale */

/* Where the image is on the screen, in texels of the framebuffer. */
struct placing {
    bool fit;
    double zoom; /* screen texels per image texel */
    double x, y; /* of the image's upper left corner */
};

struct status {
    bool bad;
    bool
        is_new; /* no key was pressed since; then it stands on the picture if the panel is hidden */
    char text[1400];
};

struct viewer {
    const struct arguments *arguments;
    struct report report;
    struct text warnings; /* of the frame that is shown, a line each */
    struct gpu gpu;
    struct window window;
    VkSurfaceKHR surface;
    struct swapchain swapchain;
    struct display display;
    struct probe probe;
    vkao_context *context;
    VkQueryPool timestamps; /* VK_NULL_HANDLE if the queue has none */
    bool panel_is_ready;

    struct source source; /* files, or */
    struct live *live;    /* a scene; NULL: files */

    struct setting settings[SIDES];
    struct history history;
    bool bias_is_given[SIDES];
    float bias_settled[SIDES]; /* by the steps of the frame's depth; 0 = not yet */
    enum side active;
    enum view_kind view;
    bool wipe;
    double wipe_at; /* screen, texels */
    bool wipe_is_placed;
    double gain;     /* of the difference */
    double exposure; /* of the composite, stops */
    /* View z that the depth view shows as black and white, scene units; automatic: as it follows
     * from the files. */
    struct depth_shown {
        bool is_automatic;
        double near, far;
    } depth_shown;

    struct computation results[SIDES][FRAMES_IN_FLIGHT]; /* of files: only the first of each */
    bool stale[SIDES]; /* parameters have changed since it was recorded */
    bool stamped[SIDES][FRAMES_IN_FLIGHT];
    struct stage_times times[SIDES];
    struct histogram {
        bool is_wanted, is_known; /* the panel shows it; it is that of the picture */
        uint32_t curves;          /* 1 of grey, 3 of colour */
        uint32_t bins[3][256];    /* texels by the byte that they show */
        uint32_t count;           /* texels */
    } histogram;
    double error[SIDES]; /* RMS difference to the reference; < 0: not known */
    struct probe_result probed;

    bool show_panel, show_help;
    struct browser browser;
    double scale; /* of the panel: texels per unit */
    struct placing placing;
    enum drag drag;
    double drag_x, drag_y;
    bool drag_is_left; /* begun with that button */
    struct status status;
    struct tool_error failure; /* ends the run; EXIT_OK: none */
    uint64_t frames_drawn;
    unsigned frames_wanted; /* to draw before waiting for events */
    bool quit;
    bool save_wanted; /* of the frame that is drawn next */
    char title[512];
};

/* Opens everything that the arguments say. Errors as the exit codes. On failure viewer_close is to
 * be called too. */
bool viewer_open(struct viewer *viewer, const struct arguments *arguments, struct tool_error *err);
/* viewer_run.c: until somebody quits or the frames asked for are drawn. */
bool viewer_run(struct viewer *viewer, struct tool_error *err);
void viewer_close(struct viewer *viewer);

/* --- Steps --- */

/* viewer_input.c: acts on keys, mouse and dropped files. */
void viewer_handle_input(struct viewer *viewer);
/* Whether the mouse at a column of the window is on the picture, and not the panel's. By where it
 * is now: the panel knows where it was in the last frame, which may be long ago. */
bool viewer_has_mouse(const struct viewer *viewer, double x);
/* Opens the list of files, or what is chosen in it. */
void viewer_browse(struct viewer *viewer);
void viewer_choose_file(struct viewer *viewer);
/* viewer_frame.c: draws and presents one frame; with a path it is written there as a PNG. False
 * without an error in err: there was nothing to draw into. */
bool viewer_draw(struct viewer *viewer, const char *capture, struct tool_error *err);
/* measure.c: what is asked of the pictures that the last frame showed; waits for the device only if
 * there is something to ask. */
bool viewer_measure(struct viewer *viewer, struct tool_error *err);
/* panel.c: widgets of one frame. */
void viewer_panel(struct viewer *viewer);
/* save.c: writes command line, EXR and PNG of what the last frame showed. */
bool viewer_save(struct viewer *viewer, struct tool_error *err);
/* The command line alone, into the clipboard. */
bool viewer_copy_command(struct viewer *viewer, struct tool_error *err);

/* --- What the steps share --- */

void viewer_say(struct viewer *viewer, const char *format, ...) TOOL_PRINTF(2, 3);
/* What is wrong with files, old and new, is said in the panel, and the window goes on; a device
 * that is lost ends it. */
void viewer_say_error(struct viewer *viewer, const struct tool_error *err);
/* Of a struct report: adds a warning to a struct text, as a line. */
void viewer_hear(void *text, const char *warning);
/* Ends the run with the first error that was not said. */
void viewer_fail(struct viewer *viewer, const struct tool_error *err);
/* Loads a frame of the sequence; what is wrong with it is said in the panel. */
bool viewer_load(struct viewer *viewer, size_t frame, size_t view);
bool viewer_has_image(const struct viewer *viewer);
/* Of the image shown, its padding left out; and where that begins in the images. */
VkExtent2D viewer_image_extent(const struct viewer *viewer);
VkOffset2D viewer_image_offset(const struct viewer *viewer);
/* By the monitor and the size of the window, unless the command line says it; each frame. */
void viewer_choose_scale(struct viewer *viewer);
uint32_t viewer_panel_width(const struct viewer *viewer);
/* The part of the window that the panel leaves. */
VkRect2D viewer_area(const struct viewer *viewer);
void viewer_fit(struct viewer *viewer);
/* Something else is computed, or the same is shown in another way. */
void viewer_mark_stale(struct viewer *viewer);
void viewer_mark_seen(struct viewer *viewer);
/* As many frames more as it takes until what was asked for is shown. */
void viewer_draw_more(struct viewer *viewer);
/* What can be undone. */
struct history_state viewer_state(const struct viewer *viewer);
void viewer_take_state(struct viewer *viewer, const struct history_state *state);
/* The range of the depth view, if it is the automatic one. */
void viewer_fit_depth(struct viewer *viewer);
/* Whether a side is seen, or asked about. */
bool viewer_needs(const struct viewer *viewer, enum side side);
/* How the view makes a side's values visible. */
struct tone viewer_tone(const struct viewer *viewer, enum side side);
/* The computation that the latest frame of a side is in. */
const struct computation *viewer_result(const struct viewer *viewer, enum side side);
unsigned viewer_images_there(const struct viewer *viewer);
/* Panel and title: "A vbao". */
void side_title(const struct viewer *viewer, enum side side, char *text, size_t size);

#endif
