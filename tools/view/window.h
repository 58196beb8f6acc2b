/* SPDX-License-Identifier: MIT
 *
 * The GLFW window, and what people do to it since the viewer last looked. The one file that talks
 * to GLFW, beside the back end of the panel. */
#ifndef VKAO_VIEW_WINDOW_H_
#define VKAO_VIEW_WINDOW_H_

#include "gpu.h"

#include <stdbool.h>
#include <stddef.h>

enum key_action {
    KEY_NONE,
    KEY_CHARACTER, /* what the keys so far have typed, of input.characters */
    KEY_VIEW_1,    /* and the six after it, in the order of enum view_kind */
    KEY_SWAP = KEY_VIEW_1 + 7,
    KEY_WIPE,
    KEY_ZOOM_IN,
    KEY_ZOOM_OUT,
    KEY_FIT,
    KEY_FULL_SIZE,
    KEY_PREVIOUS,
    KEY_NEXT,
    KEY_SAVE,
    KEY_PANEL,
    KEY_PROJECTION,
    KEY_PAUSE,
    KEY_UNDO,
    KEY_REDO,
    KEY_COPY,
    KEY_OPEN,
    KEY_UP,
    KEY_DOWN,
    KEY_PAGE_UP,
    KEY_PAGE_DOWN,
    KEY_FIRST,
    KEY_LAST,
    KEY_ENTER,
    KEY_ERASE,
    KEY_HELP,
    KEY_ESCAPE,
    KEY_QUIT
};

enum { MAX_KEYS = 128 };

/* Lengths are texels of the framebuffer, from its upper left corner. */
struct input {
    enum key_action keys[MAX_KEYS]; /* pressed, in order */
    size_t key_count;
    uint32_t characters[MAX_KEYS];    /* of Unicode; 0 but for KEY_CHARACTER */
    double x, y;                      /* the mouse, now */
    bool inside;                      /* the mouse is over the window */
    bool left, right;                 /* buttons held now */
    bool left_pressed, right_pressed; /* since the last look; press_x, press_y: where */
    double press_x, press_y;
    double scroll;  /* notches, + = away from the user */
    char **dropped; /* paths, malloc'ed; NULL if nothing was dropped */
    size_t dropped_count;
    bool changed; /* anything at all happened */
};

/* A press or a release of the left button, and where the mouse was then. */
struct button_event {
    double x, y;
    bool down;
};

enum { MAX_BUTTON_EVENTS = 64 };

struct window {
    void *handle; /* GLFWwindow */
    struct input input;
    /* Not taken yet, in order. */
    struct button_event button_events[MAX_BUTTON_EVENTS];
    size_t button_event_count;
    double scale_x, scale_y; /* framebuffer texels per screen coordinate */
    double content_scale;    /* framebuffer texels per texel of a monitor of 96 dpi, where it is */
};

/* What gpu_create needs to know. Errors: EXIT_DEVICE if there is no display or no Vulkan on it. */
bool window_system_start(struct gpu_presentation *presentation, struct tool_error *err);
void window_system_stop(void);

/* Errors: EXIT_DEVICE. Callbacks keep the address of *window. */
bool window_create(struct window *window, VkExtent2D size, const char *title,
                   struct tool_error *err);
void window_destroy(struct window *window);
bool window_surface(struct window *window, VkInstance instance, VkSurfaceKHR *surface,
                    struct tool_error *err);
/* content_scale of a window that is still to open. */
double window_system_scale(void);
/* The size of the largest part of the screen that a window may take. */
VkExtent2D window_largest(void);
/* 0x0 while the window is minimised. */
VkExtent2D window_framebuffer(const struct window *window);
void window_set_title(struct window *window, const char *title);
bool window_should_close(const struct window *window);

enum cursor { CURSOR_ARROW, CURSOR_WIPE };
void window_set_cursor(struct window *window, enum cursor cursor);
void window_set_clipboard(struct window *window, const char *text);

/* Starts a new look at the input: waits for an event if wait is set, at most for `seconds` if that
 * is > 0. */
void window_poll(struct window *window, bool wait, double seconds);
/* The oldest of those that were not taken, of any look; false if there is none. */
bool window_take_button_event(struct window *window, struct button_event *event);
/* Seconds since some start. */
double window_time(void);

#endif
