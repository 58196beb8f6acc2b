/* SPDX-License-Identifier: MIT */
#include "budget.h"

#include "text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static uint64_t smaller(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* The number in a file that holds one; UINT64_MAX if there is none ("max"). */
static uint64_t read_limit(const char *path)
{
    uint64_t limit = UINT64_MAX;
    FILE *file = fopen(path, "r");
    if (!file)
        return limit;
    if (fscanf(file, "%" SCNu64, &limit) != 1)
        limit = UINT64_MAX;
    fclose(file);
    return limit;
}

/* Limits of the control group at path below root, and of those around it. */
static uint64_t group_limit(const char *root, const char *path, const char *name)
{
    char group[2048], file[4096];
    uint64_t limit = UINT64_MAX;
    snprintf(group, sizeof group, "%s", path);
    for (;;) {
        snprintf(file, sizeof file, "%s%s/%s", root, group, name);
        limit = smaller(limit, read_limit(file));
        char *slash = strrchr(group, '/');
        if (!slash)
            return limit;
        *slash = '\0';
    }
}

/* Lines of /proc/self/cgroup are 'number:controllers:path'; version 2 has number 0 and no
 * controllers. */
static uint64_t control_group_limit(void)
{
    char line[2048];
    uint64_t limit = UINT64_MAX;
    FILE *file = fopen("/proc/self/cgroup", "r");
    while (file && fgets(line, sizeof line, file)) {
        char *controllers = strchr(line, ':');
        char *path = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!path)
            continue;
        *path++ = '\0';
        path[strcspn(path, "\n")] = '\0';
        if (strcmp(controllers, ":") == 0)
            limit = smaller(limit, group_limit("/sys/fs/cgroup", path, "memory.max"));
        else if (strstr(controllers, "memory"))
            limit =
                smaller(limit, group_limit("/sys/fs/cgroup/memory", path, "memory.limit_in_bytes"));
    }
    if (file)
        fclose(file);
    return limit;
}

static uint64_t resource_limit(int resource)
{
    struct rlimit limit;
    return getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY
               ? (uint64_t)limit.rlim_cur
               : UINT64_MAX;
}

/* The bytes of memory that this process could ever have: the machine's, or those that control
 * groups and resource limits leave of them. */
static uint64_t machine_memory(void)
{
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    uint64_t memory = pages > 0 && page > 0 ? (uint64_t)pages * (uint64_t)page : UINT64_MAX;
    memory = smaller(memory, control_group_limit());
    memory = smaller(memory, resource_limit(RLIMIT_AS));
    return smaller(memory, resource_limit(RLIMIT_DATA));
}

bool budget_allows_pixels(const struct budget *budget, const char *path, uint64_t width,
                          uint64_t height, struct tool_error *err)
{
    const uint64_t most = budget->pixels ? budget->pixels : BUDGET_DEFAULT_PIXELS;
    if (height == 0 || width <= most / height)
        return true;
    fail_hint(err, "--max-pixels %" PRIu64 " allows it", width * height);
    return fail(err, EXIT_INPUT,
                "%s: %" PRIu64 "x%" PRIu64 " are %" PRIu64 " pixels, more than the %" PRIu64
                " allowed",
                path, width, height, width * height, most);
}

bool budget_allows_memory(const struct budget *budget, const char *path, uint64_t width,
                          uint64_t height, uint64_t bytes, struct tool_error *err)
{
    const uint64_t machine = machine_memory(), mega = UINT64_C(1) << 20;
    const uint64_t most = budget->memory ? budget->memory : machine / 4 * 3;
    const uint64_t needed = bytes / mega + (bytes % mega > 0);
    if (bytes <= most)
        return true;
    fail_hint(err, "--max-memory %" PRIu64 "M allows it; this machine has %" PRIu64 " MB", needed,
              machine / mega);
    return fail(err, EXIT_MEMORY,
                "%s: %" PRIu64 "x%" PRIu64 " pixels need %" PRIu64
                " MB of memory, more than the %" PRIu64 " MB allowed",
                path, width, height, needed, most / mega);
}

bool budget_parse_bytes(const char *text, uint64_t *bytes)
{
    static const char units[] = "KMGT";
    char digits[64];
    double number, scale = 1;
    const size_t length = strlen(text);
    if (length == 0 || length >= sizeof digits)
        return false;
    memcpy(digits, text, length + 1);
    const char last = digits[length - 1];
    const char *unit = strchr(units, last >= 'a' && last <= 'z' ? last - 'a' + 'A' : last);
    if (unit) {
        scale = ldexp(1.0, 10 * (int)(unit - units + 1));
        digits[length - 1] = '\0';
    }
    /* Beyond 2^63 no machine has any. */
    if (!text_to_number(digits, &number) || !(number * scale >= 1) || !(number * scale < 0x1p63))
        return false;
    *bytes = (uint64_t)(number * scale);
    return true;
}
