/* SPDX-License-Identifier: MIT
 *
 * Instructions of AMD's assembly, as Mesa prints it, counted by hand. */
#include "assembly.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* Two blocks of which the second may be left out, and no loop. */
static const char straight[] =
    "BB0:\n"
    "\tv_lshl_add_u32 v0, s5, 4, v0      ; d7460000 04010805\n"
    "\tv_rsq_f32_e32 v1, v0              ; 7e025d00\n"
    "\timage_load v4, v[6:7], s[8:15] dmask:0x1 dim:SQ_RSRC_IMG_2D unorm ; f0001108 00020406\n"
    "\ts_cbranch_execz BB1               ; bf880002\n"
    "\tds_write_b32 v2, v3               ; d8340000 00000302\n"
    "\tbuffer_load_dword v2, v3, s[4:7], 0 offen ; e0301000 80010203\n"
    "BB1:\n"
    "\tv_sin_f32_e32 v1, v1              ; 7e026b01\n"
    "\ts_endpgm                          ; bf810000\n";

/* An outer loop with an inner one that goes on in two places. */
static const char nested[] = "BB0:\n"
                             "\tv_mov_b32_e32 v0, 0\n"
                             "BB1:\n"
                             "\tv_add_f32_e32 v0, v0, v1\n"
                             "BB2:\n"
                             "\tv_rcp_f32_e32 v2, v0\n"
                             "\ts_cbranch_scc1 BB2\n"
                             "\timage_gather4_l v2, v[3:4], s[0:7], s[8:11]\n"
                             "\ts_cbranch_scc0 BB2\n"
                             "\ts_branch BB1\n"
                             "BB3:\n"
                             "\ts_endpgm\n";

static void expect(const char *text, const unsigned trips[ASSEMBLY_NEST],
                   struct assembly_counts wanted)
{
    const struct assembly_counts got = assembly_count(text, trips);
    assert_float_equal(got.all, wanted.all, 0);
    assert_float_equal(got.vector, wanted.vector, 0);
    assert_float_equal(got.transcendental, wanted.transcendental, 0);
    assert_float_equal(got.image, wanted.image, 0);
    assert_float_equal(got.shared, wanted.shared, 0);
    assert_int_equal(got.loops, wanted.loops);
}

static void every_block_counts_once(void **state)
{
    (void)state;
    const unsigned trips[ASSEMBLY_NEST] = {7, 7, 7};
    expect(straight, trips,
           (struct assembly_counts){
               .all = 8, .vector = 3, .transcendental = 2, .image = 2, .shared = 1});
}

static void loops_count_as_often_as_they_run(void **state)
{
    (void)state;
    const unsigned trips[ASSEMBLY_NEST] = {3, 5};
    expect(nested, trips,
           (struct assembly_counts){.all = 1 + 3 * (1 + 5 * 4 + 1) + 1,
                                    .vector = 1 + 3 * (1 + 5 * 1),
                                    .transcendental = 3 * 5,
                                    .image = 3 * 5,
                                    .loops = 2});
}

static void unknown_loops_count_once(void **state)
{
    (void)state;
    const unsigned trips[ASSEMBLY_NEST] = {0};
    expect(nested, trips,
           (struct assembly_counts){
               .all = 8, .vector = 3, .transcendental = 1, .image = 1, .loops = 2});
}

static void nothing_has_no_instructions(void **state)
{
    (void)state;
    const unsigned trips[ASSEMBLY_NEST] = {0};
    expect("", trips, (struct assembly_counts){0});
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_block_counts_once),
        cmocka_unit_test(loops_count_as_often_as_they_run),
        cmocka_unit_test(unknown_loops_count_once),
        cmocka_unit_test(nothing_has_no_instructions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
