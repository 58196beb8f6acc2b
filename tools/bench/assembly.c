/* SPDX-License-Identifier: MIT */
#include "assembly.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { MAX_BLOCKS = 4096, MAX_LOOPS = 128 };

struct loop {
    unsigned first, last; /* lines */
};

struct layout {
    unsigned line_of[MAX_BLOCKS]; /* where the block begins; 0 = nowhere so far */
    struct loop loops[MAX_LOOPS];
    unsigned count;
};

static const char *next_line(const char *line)
{
    const char *end = strchr(line, '\n');
    return end ? end + 1 : NULL;
}

/* The name of the instruction in a line, "" if there is none. */
static void read_name(const char *line, char name[64])
{
    name[0] = '\0';
    if (isspace((unsigned char)line[0]))
        sscanf(line, " %63[a-z0-9_]", name);
}

static bool begins(const char *name, const char *with)
{
    return strncmp(name, with, strlen(with)) == 0;
}

/* A branch back to a line is a loop from there; 'continue' is a second branch to the same. */
static void add_loop(struct layout *layout, unsigned first, unsigned last)
{
    for (unsigned i = 0; i < layout->count; i++) {
        if (layout->loops[i].first == first) {
            layout->loops[i].last = last;
            return;
        }
    }
    if (layout->count < MAX_LOOPS)
        layout->loops[layout->count++] = (struct loop){first, last};
}

static void find_loops(const char *text, struct layout *layout)
{
    unsigned number = 1;
    for (const char *line = text; line && *line; line = next_line(line), number++) {
        unsigned block;
        char name[64];
        if (sscanf(line, "BB%u:", &block) == 1 && block < MAX_BLOCKS)
            layout->line_of[block] = number;
        read_name(line, name);
        if ((begins(name, "s_branch") || begins(name, "s_cbranch")) &&
            sscanf(line, " %*s BB%u", &block) == 1 && block < MAX_BLOCKS && layout->line_of[block])
            add_loop(layout, layout->line_of[block], number);
    }
}

static double weight(const struct layout *layout, unsigned line, const unsigned trips[])
{
    double times = 1;
    unsigned depth = 0;
    for (unsigned i = 0; i < layout->count; i++) {
        if (line < layout->loops[i].first || line > layout->loops[i].last)
            continue;
        if (depth < ASSEMBLY_NEST && trips[depth] > 0)
            times *= trips[depth];
        depth++;
    }
    return times;
}

static bool is_transcendental(const char *name)
{
    static const char *const names[] = {"v_rcp_", "v_rsq_", "v_sqrt_", "v_sin_",
                                        "v_cos_", "v_exp_", "v_log_"};
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++)
        if (begins(name, names[i]))
            return true;
    return false;
}

static void add(struct assembly_counts *counts, const char *name, double times)
{
    const bool is_image = begins(name, "image_") || begins(name, "buffer_");
    counts->all += times;
    counts->vector += begins(name, "v_") ? times : 0;
    counts->transcendental += is_transcendental(name) ? times : 0;
    counts->image += is_image ? times : 0;
    counts->shared += begins(name, "ds_") ? times : 0;
}

struct assembly_counts assembly_count(const char *text, const unsigned trips[ASSEMBLY_NEST])
{
    struct assembly_counts counts = {0};
    struct layout layout = {0};
    unsigned number = 1;
    find_loops(text, &layout);
    counts.loops = layout.count;
    for (const char *line = text; line && *line; line = next_line(line), number++) {
        char name[64];
        read_name(line, name);
        if (name[0] >= 'a')
            add(&counts, name, weight(&layout, number, trips));
    }
    return counts;
}
