/* SPDX-License-Identifier: MIT
 *
 * Runs a fuzzer over the files given, each also cut short and with single bytes changed. Prints like cmocka. */
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static void run_variants(uint8_t *data, size_t size, int variants)
{
    uint32_t state = 1;
    LLVMFuzzerTestOneInput(data, size);
    for (int i = 0; size && i < variants; ++i) {
        size_t cut = next_random(&state) % size;
        LLVMFuzzerTestOneInput(data, cut);
        /* Headers are where the decisions are: half of the changes go there. */
        size_t where = next_random(&state) % (i % 2 && size > 512 ? 512 : size);
        uint8_t kept = data[where];
        data[where] = (uint8_t)next_random(&state);
        LLVMFuzzerTestOneInput(data, size);
        data[where] = kept;
    }
}

int main(int argc, char **argv)
{
    int failed = 0;
    for (int i = 1; i < argc; ++i) {
        const char *name = strrchr(argv[i], '/') ? strrchr(argv[i], '/') + 1 : argv[i];
        size_t size = 0;
        printf("[ RUN      ] %s_survives_damage\n", name);
        fflush(stdout);
        uint8_t *data = read_file(argv[i], &size);
        if (data)
            run_variants(data, size, 60);
        printf(data ? "[       OK ] %s_survives_damage\n" : "[  FAILED  ] %s_survives_damage: cannot read it\n", name);
        failed += !data;
        free(data);
    }
    return failed ? 1 : 0;
}
