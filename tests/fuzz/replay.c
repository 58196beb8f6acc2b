/* SPDX-License-Identifier: MIT
 *
 * replay FILE-OR-DIRECTORY...   runs a fuzzer over files, each also cut short and with single bytes
 * changed. Prints like cmocka. What is written ?PATH may be missing, and is then skipped. */
#include "fuzz.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct result {
    int passed, failed;
};

static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    uint8_t *data = NULL;
    size_t room = 0;
    *size = 0;
    for (size_t got = 1; got;) {
        if (*size == room) {
            room = room ? 2 * room : 65536;
            uint8_t *bigger = realloc(data, room);
            if (!bigger)
                break;
            data = bigger;
        }
        got = fread(data + *size, 1, room - *size, file);
        *size += got;
    }
    fclose(file);
    return data;
}

/* A fixed sequence: a replay that fails must fail again. */
static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* In memory of exactly its size, so that a byte too many is seen. */
static void run(const uint8_t *data, size_t size)
{
    uint8_t *copy = malloc(size ? size : 1);
    if (!copy)
        abort();
    if (size)
        memcpy(copy, data, size);
    LLVMFuzzerTestOneInput(copy, size);
    free(copy);
}

static void run_variants(uint8_t *data, size_t size, int variants)
{
    uint32_t state = 1;
    run(data, size);
    for (int i = 0; size && i < variants; ++i) {
        size_t cut = next_random(&state) % size;
        run(data, cut);
        /* Headers are where the decisions are: half of the changes go there. */
        size_t where = next_random(&state) % (i % 2 && size > 512 ? 512 : size);
        uint8_t kept = data[where];
        data[where] = (uint8_t)next_random(&state);
        run(data, size);
        data[where] = kept;
    }
}

static void replay_file(const char *path, struct result *result)
{
    enum { LARGE = 1 << 17 };
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    size_t size = 0;
    printf("[ RUN      ] %s_survives_damage\n", name);
    fflush(stdout);
    uint8_t *data = read_file(path, &size);
    if (data)
        run_variants(data, size, size > LARGE ? 4 : 30);
    printf(data ? "[       OK ] %s_survives_damage\n"
                : "[  FAILED  ] %s_survives_damage: cannot read it\n",
           name);
    result->passed += data != NULL;
    result->failed += !data;
    free(data);
}

static int is_visible(const struct dirent *entry)
{
    return entry->d_name[0] != '.';
}

static void replay(const char *path, struct result *result)
{
    struct dirent **entries = NULL;
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISDIR(status.st_mode)) {
        replay_file(path, result);
        return;
    }
    const int count = scandir(path, &entries, is_visible, alphasort);
    for (int i = 0; i < count; i++) {
        char file[PATH_MAX];
        snprintf(file, sizeof file, "%s/%s", path, entries[i]->d_name);
        if (stat(file, &status) == 0 && S_ISREG(status.st_mode))
            replay_file(file, result);
        free(entries[i]);
    }
    free(entries);
    if (count < 1) {
        printf("[  FAILED  ] there_is_something_to_replay: nothing in %s\n", path);
        result->failed++;
    }
}

int main(int argc, char **argv)
{
    struct result result = {0};
    for (int i = 1; i < argc; ++i) {
        struct stat status;
        const bool may_lack = argv[i][0] == '?';
        const char *path = argv[i] + may_lack;
        if (!may_lack || stat(path, &status) == 0) {
            replay(path, &result);
            continue;
        }
        const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
        printf("[ RUN      ] files_of_%s_survive\n[  SKIPPED ] files_of_%s_survive\n", name, name);
        printf("there is no %s\n", path);
    }
    return result.failed ? 1 : 0;
}
