/* SPDX-License-Identifier: MIT
 *
 * The formulas of the slice methods, before any of them is trusted: the cumulative distribution of
 * the cosine-weighted measure in a slice, VBAO's form of it, and that slices add up to the
 * hemisphere. */
#include "ref_horizon.h"
#include "ref_methods.h"
#include "ref_normal.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

static const double pi = 3.14159265358979323846;

static void check_near(const char *what, double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance))
        fail_msg("%s: %.12g, want %.12g", what, got, want);
}

/* phi is measured from the projected normal, V stands at phi = n or, with the other orientation, at
 * -n; the density is cos(phi) |sin(phi - v)| for V at v. */
static double closed_form(double v, double phi)
{
    double total = cos(v) + v * sin(v);
    if (phi < v)
        return (cos(v) + cos(v - 2.0 * phi) + (2.0 * phi + pi) * sin(v)) / (4.0 * total);
    return (3.0 * cos(v) - cos(v - 2.0 * phi) + (4.0 * v - 2.0 * phi + pi) * sin(v)) /
           (4.0 * total);
}

static void distribution_is_the_integral_of_its_density(void **state)
{
    (void)state;
    for (int i = -8; i <= 8; ++i) {
        double v = i * 0.19; /* up to 87 degrees */
        /* theta from V; phi = theta + v */
        double all = ref_slice_integral(-v, -pi / 2.0 - v, pi / 2.0 - v);
        check_near("total", all, cos(v) + v * sin(v), 1e-7);
        check_near("F(-pi/2)", closed_form(v, -pi / 2.0), 0.0, 1e-12);
        check_near("F(pi/2)", closed_form(v, pi / 2.0), 1.0, 1e-12);
        for (int k = 0; k <= 20; ++k) {
            double phi = -pi / 2.0 + pi * k / 20.0;
            double part = ref_slice_integral(-v, -pi / 2.0 - v, phi - v) / all;
            check_near("F(phi)", closed_form(v, phi), part, 1e-6);
        }
    }
}

/* The same measure seen from one side in c = cos theta, and against the distribution above. */
static void sector_bounds_follow_the_distribution(void **state)
{
    (void)state;
    for (int i = -7; i <= 8; ++i) {              /* beyond, one side is next to nothing */
        double n = i * 0.19, low = n + pi / 2.0; /* of the tangent plane */
        double side = ref_slice_integral(n, 0.0, low);
        for (int k = 0; k <= 20; ++k) {
            double theta = low * k / 20.0;
            double beyond = ref_slice_integral(n, theta, low) / side;
            check_near("share", ref_vbao_share(n, theta), beyond, 1e-6);
            /* phi = theta - n, V at phi = -n */
            double f = (1.0 - closed_form(-n, theta - n)) / (1.0 - closed_form(-n, -n));
            check_near("share of F", ref_vbao_share(n, theta), f, 1e-9);
        }
        assert_int_equal(ref_vbao_sector(n, 0.0, 0.0), 31);
        assert_int_equal(ref_vbao_sector(n, low, 0.0), 0);
    }
}

/* GTAO's closed form of the inner integral (Jimenez et al. 2016, equation 7). */
static void inner_integral_is_the_closed_form(void **state)
{
    (void)state;
    for (int i = -7; i <= 7; ++i) {
        double n = i * 0.2;
        for (int k = 0; k <= 10; ++k) {
            double h = (n + pi / 2.0) * k / 10.0;
            double closed = (cos(n) + 2.0 * h * sin(n) - cos(2.0 * h - n)) / 4.0;
            check_near("inner integral", closed, ref_slice_integral(n, 0.0, h), 1e-6);
        }
    }
}

/* Mean over slices of L (cos n + n sin n) for a normal tilted from V. The slices of a texel are
 * evenly spread on screen, so that away from the middle of a perspective picture they are not
 * around V: weight is what makes up for that. */
static double mean_of_slices(double eye_tilt, double tilt, double azimuth, bool weighted)
{
    enum { SLICES = 3600 };
    struct ref_slice s = {.to_eye = {sin(eye_tilt), 0.0, -cos(eye_tilt)}};
    /* the normal at tilt from V, round V by azimuth */
    double x[3] = {cos(eye_tilt), 0.0, sin(eye_tilt)}, sum = 0.0;
    for (int c = 0; c < 3; ++c)
        s.n[c] = cos(tilt) * s.to_eye[c] +
                 sin(tilt) * (cos(azimuth) * x[c] + sin(azimuth) * (c == 1 ? 1.0 : 0.0));
    for (int i = 0; i < SLICES; ++i) {
        double angle = pi * (i + 0.5) / SLICES;
        ref_slice_turn(&s, angle);
        double along = cos(angle) * s.to_eye[0];
        double w = weighted ? cos(eye_tilt) / (1.0 - along * along) : 1.0;
        sum += w * s.length * (cos(s.angle) + s.angle * sin(s.angle)) / SLICES;
    }
    return sum;
}

static void slices_add_up_to_the_hemisphere(void **state)
{
    (void)state;
    double worst = 0.0;
    for (int i = 0; i <= 8; ++i) {
        for (int k = 0; k < 6; ++k) {
            double tilt = i * 0.19, azimuth = k * 0.5;
            check_near("mean about V", mean_of_slices(0.0, tilt, azimuth, false), 1.0, 1e-6);
            check_near("weighted mean", mean_of_slices(0.6, tilt, azimuth, true), 1.0, 1e-6);
            worst = fmax(worst, fabs(mean_of_slices(0.6, tilt, azimuth, false) - 1.0));
        }
    }
    print_message("    34 degrees off the axis the mean without weights is off by up to %.3f\n",
                  worst);
    assert_true(worst > 0.01); /* or the weight would be idle */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distribution_is_the_integral_of_its_density),
        cmocka_unit_test(sector_bounds_follow_the_distribution),
        cmocka_unit_test(inner_integral_is_the_closed_form),
        cmocka_unit_test(slices_add_up_to_the_hemisphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
