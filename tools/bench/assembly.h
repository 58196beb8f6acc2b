/* SPDX-License-Identifier: MIT
 *
 * Counts the instructions of a shader for AMD GPUs in the text that Mesa's compiler makes of it. */
#ifndef VKAO_BENCH_ASSEMBLY_H_
#define VKAO_BENCH_ASSEMBLY_H_

enum { ASSEMBLY_NEST = 3 };

/* Every block once, whatever branches lead around it, and those of a loop as often as it runs. */
struct assembly_counts {
    double all;
    double vector;         /* VALU, transcendental ones among them */
    double transcendental; /* square roots, reciprocals, sines, exponentials, logarithms */
    double image;          /* that go to the texture unit: loads, stores, gathers */
    double shared;         /* that go to shared memory */
    unsigned loops;        /* that are left after unrolling */
};

/* trips: how often the loops run, from the outermost in; 0 = unknown, which counts as once. */
struct assembly_counts assembly_count(const char *text, const unsigned trips[ASSEMBLY_NEST]);

#endif
