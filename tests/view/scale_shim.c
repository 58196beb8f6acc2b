/* SPDX-License-Identifier: MIT
 *
 * Preloaded, it stands between the viewer and GLFW: the content scale is what the file VKAO_SCALE
 * says, and when that changes, the window is told, as when it moves to another monitor. An X server
 * in memory has monitors of one scale only. If VKAO_SIZE_LAGS is set, the window's size is one of a
 * moment ago in one call of four, as that of a window that grows while its sizes are asked for. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

static GLFWwindowcontentscalefun told;
static GLFWwindow *window;
static float last;

static float scale(void)
{
    float value = 1.0f;
    const char *path = getenv("VKAO_SCALE");
    FILE *file = path ? fopen(path, "r") : NULL;
    if (!file || fscanf(file, "%f", &value) != 1)
        value = 1.0f;
    if (file)
        fclose(file);
    return value;
}

GLFWAPI void glfwGetMonitorContentScale(GLFWmonitor *monitor, float *x, float *y)
{
    (void)monitor;
    *x = *y = scale();
}

GLFWAPI void glfwGetWindowContentScale(GLFWwindow *handle, float *x, float *y)
{
    (void)handle;
    *x = *y = last = scale();
}

GLFWAPI GLFWwindowcontentscalefun
glfwSetWindowContentScaleCallback(GLFWwindow *handle, GLFWwindowcontentscalefun callback)
{
    window = handle;
    told = callback;
    return NULL;
}

GLFWAPI void glfwWaitEvents(void)
{
    void (*wait)(double);
    *(void **)&wait = dlsym(RTLD_NEXT, "glfwWaitEventsTimeout");
    wait(0.1);
    const float now = scale();
    if (told && (now < last || now > last)) {
        last = now;
        told(window, now, now);
    }
}

GLFWAPI void glfwGetWindowSize(GLFWwindow *handle, int *width, int *height)
{
    static unsigned calls;
    void (*get)(GLFWwindow *, int *, int *);
    *(void **)&get = dlsym(RTLD_NEXT, "glfwGetWindowSize");
    get(handle, width, height);
    if (getenv("VKAO_SIZE_LAGS") && ++calls % 4 == 0)
        *width = *height = 1;
}
