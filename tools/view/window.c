/* SPDX-License-Identifier: MIT */
#include "window.h"

#include "text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

static const struct {
    int key;
    enum key_action action;
} key_table[] = {
    {GLFW_KEY_TAB, KEY_SWAP},       {GLFW_KEY_W, KEY_WIPE},
    {GLFW_KEY_KP_ADD, KEY_ZOOM_IN}, {GLFW_KEY_KP_SUBTRACT, KEY_ZOOM_OUT},
    {GLFW_KEY_0, KEY_FIT},          {GLFW_KEY_KP_0, KEY_FIT},
    {GLFW_KEY_F, KEY_FIT},          {GLFW_KEY_Z, KEY_FULL_SIZE},
    {GLFW_KEY_LEFT, KEY_PREVIOUS},  {GLFW_KEY_RIGHT, KEY_NEXT},
    {GLFW_KEY_S, KEY_SAVE},         {GLFW_KEY_P, KEY_PANEL},
    {GLFW_KEY_O, KEY_PROJECTION},   {GLFW_KEY_SPACE, KEY_PAUSE},
    {GLFW_KEY_Q, KEY_QUIT},         {GLFW_KEY_ESCAPE, KEY_ESCAPE},
    {GLFW_KEY_F1, KEY_HELP},        {GLFW_KEY_UP, KEY_UP},
    {GLFW_KEY_DOWN, KEY_DOWN},      {GLFW_KEY_PAGE_UP, KEY_PAGE_UP},
    {GLFW_KEY_HOME, KEY_FIRST},     {GLFW_KEY_PAGE_DOWN, KEY_PAGE_DOWN},
    {GLFW_KEY_END, KEY_LAST},       {GLFW_KEY_ENTER, KEY_ENTER},
    {GLFW_KEY_KP_ENTER, KEY_ENTER}, {GLFW_KEY_BACKSPACE, KEY_ERASE},
};

/* --- The window system --- */

static char glfw_message[256];

static void on_error(int code, const char *message)
{
    (void)code;
    snprintf(glfw_message, sizeof glfw_message, "%s", message);
}

static bool can_present(VkInstance instance, VkPhysicalDevice device, uint32_t queue_family)
{
    return glfwGetPhysicalDevicePresentationSupport(instance, device, queue_family) == GLFW_TRUE;
}

bool window_system_start(struct gpu_presentation *presentation, struct tool_error *err)
{
    glfwSetErrorCallback(on_error);
    if (!glfwInit()) {
        fail(err, EXIT_DEVICE, "no display: %s", glfw_message);
        return fail_hint(err, "vkao computes without one; xvfb-run provides a display in memory");
    }
    if (!glfwVulkanSupported()) {
        fail(err, EXIT_DEVICE, "no Vulkan on this display: %s",
             glfw_message[0] ? glfw_message : "no driver was found");
        fail_hint(err, "install mesa-vulkan-drivers to compute on the CPU (lavapipe), or a GPU "
                       "driver");
        glfwTerminate();
        return false;
    }
    *presentation = (struct gpu_presentation){.supported = can_present};
    presentation->instance_extensions =
        glfwGetRequiredInstanceExtensions(&presentation->instance_extension_count);
    if (presentation->instance_extensions)
        return true;
    fail(err, EXIT_DEVICE, "no Vulkan driver can present on this display");
    fail_hint(err, "vkao computes without a display");
    glfwTerminate();
    return false;
}

void window_system_stop(void)
{
    glfwTerminate();
}

/* --- Callbacks --- */

static struct window *window_of(GLFWwindow *handle)
{
    return glfwGetWindowUserPointer(handle);
}

static void add_key(struct input *input, enum key_action action)
{
    if (input->key_count == MAX_KEYS)
        input->key_count--; /* nobody types as fast */
    input->characters[input->key_count] = 0;
    input->keys[input->key_count++] = action;
}

/* A key that is held goes on zooming and stepping; whatever it switches or ends, it does once. */
static bool repeats(enum key_action action)
{
    return action == KEY_ZOOM_IN || action == KEY_ZOOM_OUT || action == KEY_PREVIOUS ||
           action == KEY_NEXT || action == KEY_UNDO || action == KEY_REDO || action == KEY_UP ||
           action == KEY_DOWN || action == KEY_PAGE_UP || action == KEY_PAGE_DOWN ||
           action == KEY_ERASE;
}

/* With Ctrl, by the letter: Z and Y change places from keyboard to keyboard. */
static enum key_action chord(int key, int scancode, int mods)
{
    const char *name = glfwGetKeyName(key, scancode);
    if (!name || !(mods & GLFW_MOD_CONTROL) || (mods & (GLFW_MOD_ALT | GLFW_MOD_SUPER)))
        return KEY_NONE;
    if (strcmp(name, "z") == 0)
        return mods & GLFW_MOD_SHIFT ? KEY_REDO : KEY_UNDO;
    return strcmp(name, "y") == 0   ? KEY_REDO
           : strcmp(name, "c") == 0 ? KEY_COPY
           : strcmp(name, "o") == 0 ? KEY_OPEN
                                    : KEY_NONE;
}

static void on_key(GLFWwindow *handle, int key, int scancode, int action, int mods)
{
    struct input *input = &window_of(handle)->input;
    const enum key_action chorded = chord(key, scancode, mods);
    input->changed = true;
    if (action != GLFW_RELEASE && chorded && (action == GLFW_PRESS || repeats(chorded)))
        add_key(input, chorded);
    if (action == GLFW_RELEASE || (mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)))
        return;
    if (action == GLFW_PRESS && key >= GLFW_KEY_1 && key <= GLFW_KEY_7)
        add_key(input, (enum key_action)((int)KEY_VIEW_1 + key - GLFW_KEY_1));
    for (size_t i = 0; i < sizeof key_table / sizeof *key_table; i++)
        if (key_table[i].key == key && (action == GLFW_PRESS || repeats(key_table[i].action)))
            add_key(input, key_table[i].action);
}

/* + and - lie on other keys on other keyboards: what counts is the character. */
static void on_character(GLFWwindow *handle, unsigned character)
{
    struct input *input = &window_of(handle)->input;
    input->changed = true;
    add_key(input, KEY_CHARACTER);
    input->characters[input->key_count - 1] = character;
    if (character == '+' || character == '=')
        add_key(input, KEY_ZOOM_IN);
    else if (character == '-')
        add_key(input, KEY_ZOOM_OUT);
    else if (character == '?')
        add_key(input, KEY_HELP);
}

static void on_move(GLFWwindow *handle, double x, double y)
{
    struct window *w = window_of(handle);
    w->input.x = x * w->scale_x;
    w->input.y = y * w->scale_y;
    w->input.inside = true;
    w->input.changed = true;
}

/* Of more than anybody can make between two frames, the last counts. */
static void add_button_event(struct window *w, bool down)
{
    w->button_event_count -= w->button_event_count == MAX_BUTTON_EVENTS;
    w->button_events[w->button_event_count++] = (struct button_event){w->input.x, w->input.y, down};
}

static void on_button(GLFWwindow *handle, int button, int action, int mods)
{
    struct window *w = window_of(handle);
    struct input *input = &w->input;
    (void)mods;
    /* on_move was told where the mouse was when the button was pressed. glfwGetCursorPos says where
     * it is by now. */
    input->inside = true;
    input->changed = true;
    if (button == GLFW_MOUSE_BUTTON_RIGHT)
        input->right = action == GLFW_PRESS;
    if (button == GLFW_MOUSE_BUTTON_LEFT) {
        input->left = action == GLFW_PRESS;
        add_button_event(w, input->left);
    }
    if (action == GLFW_PRESS &&
        (button == GLFW_MOUSE_BUTTON_LEFT || button == GLFW_MOUSE_BUTTON_RIGHT)) {
        input->left_pressed |= button == GLFW_MOUSE_BUTTON_LEFT;
        input->right_pressed |= button == GLFW_MOUSE_BUTTON_RIGHT;
        input->press_x = input->x;
        input->press_y = input->y;
    }
}

static void on_enter(GLFWwindow *handle, int entered)
{
    struct input *input = &window_of(handle)->input;
    input->inside = entered == GLFW_TRUE;
    input->changed = true;
}

static void on_scroll(GLFWwindow *handle, double dx, double dy)
{
    struct input *input = &window_of(handle)->input;
    (void)dx;
    input->scroll += dy;
    input->changed = true;
}

static void forget_dropped(struct input *input)
{
    for (size_t i = 0; i < input->dropped_count; i++)
        free(input->dropped[i]);
    free(input->dropped);
    input->dropped = NULL;
    input->dropped_count = 0;
}

static void on_drop(GLFWwindow *handle, int count, const char **paths)
{
    struct input *input = &window_of(handle)->input;
    forget_dropped(input);
    input->dropped = calloc((size_t)count, sizeof *input->dropped);
    for (int i = 0; input->dropped && i < count; i++) {
        char *path = text_copy(paths[i], strlen(paths[i]));
        if (path)
            input->dropped[input->dropped_count++] = path;
    }
    input->changed = true;
}

static void on_framebuffer(GLFWwindow *handle, int width, int height)
{
    struct window *w = window_of(handle);
    int screen_width, screen_height;
    glfwGetWindowSize(handle, &screen_width, &screen_height);
    if (width > 0 && height > 0 && screen_width > 0 && screen_height > 0) {
        w->scale_x = (double)width / screen_width;
        w->scale_y = (double)height / screen_height;
    }
    w->input.changed = true;
}

static double usable_scale(float x, float y)
{
    const double larger = (double)(x > y ? x : y);
    return larger >= 0.25 && larger <= 16 ? larger : 1;
}

/* The window has moved to another monitor, or somebody has changed what it says. */
static void on_content_scale(GLFWwindow *handle, float x, float y)
{
    struct window *w = window_of(handle);
    w->content_scale = usable_scale(x, y);
    w->input.changed = true;
}

static void on_refresh(GLFWwindow *handle)
{
    window_of(handle)->input.changed = true;
}

/* --- The window --- */

bool window_create(struct window *window, VkExtent2D size, const char *title,
                   struct tool_error *err)
{
    *window = (struct window){.scale_x = 1, .scale_y = 1, .content_scale = 1};
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    GLFWwindow *handle = glfwCreateWindow((int)size.width, (int)size.height, title, NULL, NULL);
    if (!handle)
        return fail(err, EXIT_DEVICE, "cannot open a window: %s", glfw_message);
    window->handle = handle;
    glfwSetWindowUserPointer(handle, window);
    glfwSetKeyCallback(handle, on_key);
    glfwSetCharCallback(handle, on_character);
    glfwSetCursorPosCallback(handle, on_move);
    glfwSetMouseButtonCallback(handle, on_button);
    glfwSetCursorEnterCallback(handle, on_enter);
    glfwSetScrollCallback(handle, on_scroll);
    glfwSetDropCallback(handle, on_drop);
    glfwSetFramebufferSizeCallback(handle, on_framebuffer);
    glfwSetWindowContentScaleCallback(handle, on_content_scale);
    glfwSetWindowRefreshCallback(handle, on_refresh);
    float x = 1, y = 1;
    glfwGetWindowContentScale(handle, &x, &y);
    on_content_scale(handle, x, y);
    int width, height;
    glfwGetFramebufferSize(handle, &width, &height);
    on_framebuffer(handle, width, height);
    return true;
}

void window_destroy(struct window *window)
{
    forget_dropped(&window->input);
    if (window->handle)
        glfwDestroyWindow(window->handle);
    *window = (struct window){0};
}

bool window_surface(struct window *window, VkInstance instance, VkSurfaceKHR *surface,
                    struct tool_error *err)
{
    VkResult result = glfwCreateWindowSurface(instance, window->handle, NULL, surface);
    if (result == VK_SUCCESS)
        return true;
    *surface = VK_NULL_HANDLE;
    if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY)
        return gpu_ok(err, "glfwCreateWindowSurface", result);
    return fail(err, EXIT_DEVICE, "cannot draw into a window: VkResult %d (%s)", (int)result,
                glfw_message);
}

double window_system_scale(void)
{
    float x = 1, y = 1;
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    if (monitor)
        glfwGetMonitorContentScale(monitor, &x, &y);
    return usable_scale(x, y);
}

VkExtent2D window_largest(void)
{
    int x, y, width = 0, height = 0;
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    if (monitor)
        glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
    if (width <= 0 || height <= 0)
        return (VkExtent2D){1280, 720};
    return (VkExtent2D){(uint32_t)width, (uint32_t)height};
}

VkExtent2D window_framebuffer(const struct window *window)
{
    int width, height;
    glfwGetFramebufferSize(window->handle, &width, &height);
    if (width <= 0 || height <= 0)
        return (VkExtent2D){0};
    return (VkExtent2D){(uint32_t)width, (uint32_t)height};
}

void window_set_title(struct window *window, const char *title)
{
    glfwSetWindowTitle(window->handle, title);
}

bool window_should_close(const struct window *window)
{
    return glfwWindowShouldClose(window->handle);
}

void window_set_cursor(struct window *window, enum cursor cursor)
{
    static GLFWcursor *wipe; /* glfwTerminate destroys it */
    static enum cursor now = CURSOR_ARROW;
    if (cursor == now)
        return;
    if (!wipe)
        wipe = glfwCreateStandardCursor(GLFW_HRESIZE_CURSOR);
    glfwSetCursor(window->handle, cursor == CURSOR_WIPE ? wipe : NULL);
    now = cursor;
}

void window_set_clipboard(struct window *window, const char *text)
{
    glfwSetClipboardString(window->handle, text);
}

void window_poll(struct window *window, bool wait, double seconds)
{
    struct input *input = &window->input;
    forget_dropped(input);
    input->key_count = 0;
    input->left_pressed = input->right_pressed = false;
    input->scroll = 0;
    input->changed = false;
    if (wait && seconds > 0)
        glfwWaitEventsTimeout(seconds);
    else if (wait)
        glfwWaitEvents();
    else
        glfwPollEvents();
}

bool window_take_button_event(struct window *window, struct button_event *event)
{
    if (window->button_event_count == 0)
        return false;
    *event = window->button_events[0];
    window->button_event_count--;
    memmove(window->button_events, window->button_events + 1,
            window->button_event_count * sizeof *window->button_events);
    return true;
}

double window_time(void)
{
    return glfwGetTime();
}
