/* SPDX-License-Identifier: MIT
 *
 * The search for the model, field of view and rotation that explain the stored normals. The limits
 * are those that neither crops of real G-buffers nor made-up ones led astray. */
#include "camera_fit_internal.h"

#include <stdio.h>

enum { MOST_RIVALS = 8, SEARCH_SAMPLES = 1500, FIELDS_OF_VIEW = 15 };

static const double most_sigma = 0.12;
/* Of these nothing more is asked, unless the camera is found shifted. */
static const double all_agree = 0.995;

/* --- Search --- */

static void sort(struct fit_found *f)
{
    for (size_t i = 1; i < f->count; i++) {
        const struct fit_solution x = f->list[i];
        size_t j = i;
        for (; j > 0 && f->list[j - 1].cost > x.cost; j--)
            f->list[j] = f->list[j - 1];
        f->list[j] = x;
    }
}

static void keep(struct fit_found *f, const struct fit_solution *solution)
{
    if (f->count < FIT_MOST_FOUND)
        f->list[f->count++] = *solution;
}

/* Of the whole image as it is seen. */
static double aspect_of(const struct fit_input *input)
{
    const double width = (double)input->display_window.x_max - input->display_window.x_min + 1.0;
    const double height = (double)input->display_window.y_max - input->display_window.y_min + 1.0;
    return width / height * input->pixel_aspect;
}

struct starts {
    double offsets[4];
    size_t count;
};

/* Values of c to begin with. */
static struct starts starts_of(enum fit_model model)
{
    switch (model) {
    case FIT_RADIAL_NEAR:
        return (struct starts){{0, 0.02, 0.1}, 3};
    case FIT_DEVICE:
        return (struct starts){{-0.001, 1.0001, 1.01}, 3};
    case FIT_PLANAR_NORMALIZED:
    case FIT_RADIAL_NORMALIZED:
        return (struct starts){{0.003, 0.03, 0.3, 2}, 4};
    case FIT_PLANAR_REVERSED:
        return (struct starts){{1.001, 1.03, 1.3, 3}, 4};
    default:
        return (struct starts){{0}, 1};
    }
}

static bool has_offset(enum fit_model model)
{
    return model == FIT_RADIAL_NEAR || model == FIT_DEVICE || model == FIT_PLANAR_NORMALIZED ||
           model == FIT_RADIAL_NORMALIZED || model == FIT_PLANAR_REVERSED;
}

/* The i-th value of ln k to try; fields of view from 6 to 140 degrees. */
static double trial(const struct fit_samples *s, enum fit_model model, int i, int count)
{
    const double t = (double)i / (count - 1);
    if (fit_model_is_ortho(model))
        return s->log_slope + (t - 0.5) * 5.0;
    const double degrees = exp(log(6.0) + t * (log(140.0) - log(6.0)));
    return log(tan(degrees * PI / 360.0));
}

/* Where half of the normals are turned away, as of leaves, the closed form starts nowhere: 24 turns
 * of a cube instead, whichever way normals point. */
static void search_turns(const struct fit_samples *s, const struct fit_solution *from,
                         struct fit_found *out)
{
    static const double sigmas[] = {0.5, 0.25, 0.12};
    const struct vec3 axes[3] = {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)};
    struct fit_solution best = *from;
    for (int turn = 0; turn < 24; turn++) {
        const int first = turn / 8, second = (first + 1 + turn % 2) % 3;
        const struct vec3 x = scale(axes[first], turn & 2 ? -1.0 : 1.0);
        const struct vec3 y = scale(axes[second], turn & 4 ? -1.0 : 1.0);
        struct fit_solution at = *from;
        at.rotation = (struct mat3){x, y, cross(x, y)};
        at.rotation = fit_improve_rotation(s, &at, sigmas, sizeof sigmas / sizeof *sigmas);
        at.cost = fit_cost(s, &at, 0.1);
        if (at.cost < best.cost)
            best = at;
    }
    keep(out, &best);
}

/* The three best minima of one model over all fields of view, or at the one that is known. */
static void search_model(const struct fit_samples *s, const struct fit_input *input,
                         enum fit_model model, struct fit_found *out)
{
    struct fit_found minima = {.count = 0};
    const struct starts starts = starts_of(model);
    const bool is_known = input->half_width > 0;
    const int count = is_known ? 1 : FIELDS_OF_VIEW;
    struct fit_solution row[FIELDS_OF_VIEW];
    for (size_t start = 0; start < starts.count; start++) {
        for (int i = 0; i < count; i++) {
            row[i] = (struct fit_solution){.model = model, .free = {!is_known}};
            row[i].free[FIT_C] = has_offset(model);
            row[i].p[FIT_LN_K] = is_known ? log(input->half_width)
                                 : input->near_half_width > 0
                                     ? log(input->near_half_width) + (i - count / 2) * 0.02
                                     : trial(s, model, i, count);
            row[i].p[FIT_C] = starts.offsets[start];
            if (is_known) {
                row[i].p[FIT_CX] = -2.0 * input->shift_x;
                row[i].p[FIT_CY] = -2.0 * input->shift_y / aspect_of(input);
            }
            row[i].rotation = fit_start_rotation(s, &row[i]);
            row[i].cost = fit_cost(s, &row[i], 0.1);
        }
        for (int i = 0; i < count; i++)
            if ((i == 0 || row[i].cost <= row[i - 1].cost) &&
                (i == count - 1 || row[i].cost < row[i + 1].cost))
                keep(&minima, &row[i]);
    }
    sort(&minima);
    for (size_t i = 0; i < minima.count && i < 3; i++)
        keep(out, &minima.list[i]);
}

static bool is_inside(const struct fit_samples *s, const struct fit_solution *at)
{
    double low, high;
    fit_model_range(s, at->model, &low, &high);
    return isfinite(at->cost) &&
           (!at->free[FIT_LN_K] || (at->p[FIT_LN_K] > low + 0.02 && at->p[FIT_LN_K] < high - 0.02));
}

static void drop_outside(const struct fit_samples *s, struct fit_found *f)
{
    size_t kept = 0;
    for (size_t i = 0; i < f->count; i++)
        if (is_inside(s, &f->list[i]))
            f->list[kept++] = f->list[i];
    f->count = kept;
    sort(f);
}

static void merge_doubles(struct fit_found *f)
{
    size_t kept = 0;
    for (size_t i = 0; i < f->count && kept < MOST_RIVALS; i++) {
        const struct fit_solution *x = &f->list[i];
        bool is_double = false;
        for (size_t j = 0; j < kept; j++)
            is_double |= f->list[j].model == x->model &&
                         fabs(f->list[j].p[FIT_LN_K] - x->p[FIT_LN_K]) < 0.01 &&
                         fabs(f->list[j].p[FIT_C] - x->p[FIT_C]) < 0.01;
        if (!is_double)
            f->list[kept++] = *x;
    }
    f->count = kept;
}

static bool is_in_unit_range(const struct fit_samples *s)
{
    return s->least >= -1e-6 && s->most <= 1.0001;
}

static bool search(const struct fit_samples *s, const struct fit_input *input, struct fit_found *f)
{
    struct fit_samples few;
    const bool in_unit_range = is_in_unit_range(s);
    if (!fit_samples_thin(s, SEARCH_SAMPLES, &few))
        return false;
    f->count = 0;
    for (int model = 0; model < FIT_MODELS; model++)
        if ((input->models >> model & 1u) && (model < FIT_DEVICE || in_unit_range))
            search_model(&few, input, (enum fit_model)model, f);
    sort(f);
    const size_t plain = f->count;
    for (size_t i = 0; i < plain && f->list[0].cost > 0.6; i++)
        search_turns(&few, &f->list[i], f);
    sort(f);
    /* Between two trials the cost falls by less than this. */
    while (f->count > 1 && f->list[f->count - 1].cost > f->list[0].cost + 0.4)
        f->count--;
    for (size_t i = 0; i < f->count; i++) {
        fit_descend(&few, &f->list[i], 0.1, FIT_NEARLY);
        fit_descend(&few, &f->list[i], 0.05, FIT_NEARLY);
    }
    drop_outside(&few, f);
    merge_doubles(f);
    fit_samples_free(&few);
    return true;
}

/* --- Refinement --- */

/* Twice the weighted median of the sines: what most of the image stays below. */
static double robust_scale(const struct fit_samples *s, const struct fit_solution *at)
{
    enum { BINS = 512 };
    const struct fit_residual *residuals = fit_find_residuals(s, at);
    double histogram[BINS] = {0}, sum = 0;
    for (size_t i = 0; i < s->count; i++) {
        const double e = sqrt(residuals[i].e2);
        const int bin = (int)(e * 2.0 / most_sigma * BINS); /* nothing beyond matters */
        histogram[bin < BINS ? bin : BINS - 1] += s->list[i].weight;
    }
    int bin = 0;
    while (bin < BINS - 1 && (sum += histogram[bin]) < 0.5 * s->total_weight)
        bin++;
    const double median = (bin + 0.5) * most_sigma / 2.0 / BINS;
    return fmin(fmax(2.0 * median, FIT_LEAST_SIGMA), most_sigma);
}

/* All rivals at one scale, at that of the best. */
static void refine_all(const struct fit_samples *s, struct fit_found *f, double *sigma)
{
    *sigma = robust_scale(s, &f->list[0]);
    for (int again = 0; again < 2 && f->count > 0; again++) {
        for (size_t i = 0; i < f->count; i++)
            fit_refine(s, &f->list[i], *sigma);
        drop_outside(s, f);
        if (f->count == 0)
            return;
        const double better = robust_scale(s, &f->list[0]);
        if (better > 0.7 * *sigma || *sigma <= FIT_LEAST_SIGMA)
            return;
        *sigma = better; /* the best fits better than the search knew */
    }
}

/* Smaller and smaller scales, as long as they make the field of view surer: flat faces decide and
 * smooth shading drops out. But a floor, where that is all that is flat, tells nothing alone. */
static struct fit_solution sharpened(const struct fit_samples *s, const struct fit_solution *from)
{
    struct fit_solution best = *from, t = *from;
    struct vec3 weakest;
    while (t.sigma > FIT_SHARPEST_SIGMA) {
        fit_refine(s, &t, fmax(t.sigma * 0.5, FIT_SHARPEST_SIGMA));
        const double moved = fabs(t.p[FIT_LN_K] - best.p[FIT_LN_K]);
        if (t.inlier_weight < 0.25 || moved > 3.0 * best.deviation[FIT_LN_K] + 0.005 ||
            !fit_has_directions(s, &t, &weakest))
            break;
        if (t.deviation[FIT_LN_K] < 0.9 * best.deviation[FIT_LN_K])
            best = t;
    }
    return best;
}

/* Where flat faces are few and point few ways, a wrong field of view may suit them as well as the
 * right one with its shift. Round things tell the two apart, at a scale that is theirs. Of renders
 * that are whole none gains as much. */
static bool is_seen_in_all(const struct fit_samples *s, const struct fit_solution *with,
                           const struct fit_solution *without)
{
    static const double least = 0.02;
    const double sigma = fmax(with->sigma, least);
    const struct fit_solution a = fit_refined(s, with, sigma), b = fit_refined(s, without, sigma);
    return a.cost < 0.85 * b.cost && fit_paired_z(&a, &b) > 3;
}

/* A lens shift has to win clearly at the same scale. What is neither won nor lost is doubt: of most
 * whole renders a shift, which is not there, gains less than 3 of 100. These bounds were chosen on
 * 240 random crops of eight renders: of those said to be sure 24 of 214 were wrong before, 5 of 218
 * with them. Checked on 100 others of the same, 9 of 87 and 3 of 88, and on 100 of twenty other
 * scenes, 8 of 77 and 4 of 82. */
static void try_shift(const struct fit_samples *s, const struct fit_solution *coarse, double sigma,
                      struct fit_solution *best)
{
    struct fit_solution t = *coarse;
    t.free[FIT_CX] = t.free[FIT_CY] = true;
    fit_refine(s, &t, fmax(sigma, 0.03));
    t = sharpened(s, &t);
    /* What is exact for most needs no sharpening, and is held against the sharpest scale. */
    const bool is_exact = robust_scale(s, &t) <= FIT_LEAST_SIGMA;
    const double scale = fmax(is_exact ? FIT_LEAST_SIGMA : t.sigma, best->sigma);
    struct fit_solution with = fit_refined(s, &t, scale), without = fit_refined(s, best, scale);
    const double *p = with.p, *deviation = with.deviation;
    const double z = fit_paired_z(&with, &without);
    const double ratio = with.cost / fmax(without.cost, 1e-12);
    const double sigmas = fmax(fabs(p[FIT_CX]) / fmax(deviation[FIT_CX], 0.002),
                               fabs(p[FIT_CY]) / fmax(deviation[FIT_CY], 0.002));
    if (sigmas <= 5 || fmax(fabs(p[FIT_CX]), fabs(p[FIT_CY])) <= 0.01 ||
        without.cost - with.cost <= 0.01)
        return;
    const bool is_clear =
        ratio < 0.6 || (ratio < 0.9 && z > 3 && is_seen_in_all(s, &with, &without));
    if (is_clear && fmax(deviation[FIT_CX], deviation[FIT_CY]) < 0.03) {
        *best = t;
        best->shifted = true;
    } else if (ratio < 0.6 || (ratio < 0.97 && z > 1.5)) {
        best->doubt = fabs(p[FIT_LN_K] - without.p[FIT_LN_K]);
    }
}

/* Far off the axis another model, or another field of view, may seem best as long as there is no
 * shift. */
static void try_shift_of_rivals(const struct fit_samples *s, const struct fit_found *f,
                                double sigma, struct fit_solution *best)
{
    enum { MOST = 4 };
    for (size_t i = 1; i < f->count && i < MOST && !best->shifted; i++) {
        if (fit_model_is_ortho(f->list[i].model))
            continue;
        struct fit_solution t = sharpened(s, &f->list[i]);
        try_shift(s, &f->list[i], sigma, &t);
        if (t.shifted && is_seen_in_all(s, &t, best))
            *best = t;
    }
}

/* Whether the offset is better by enough, at one scale. */
static bool earns(const struct fit_samples *s, const struct fit_solution *plain,
                  const struct fit_solution *offset, double sigma)
{
    struct fit_solution without = fit_refined(s, plain, sigma),
                        with = fit_refined(s, offset, sigma);
    return fabs(with.p[FIT_C]) > fmax(5.0 * with.deviation[FIT_C], 0.001) &&
           without.cost - with.cost > 0.01 && fit_paired_z(&with, &without) > 2.5;
}

/* The near plane has to earn its place, at the sharp scale and, since what is exact there may be
 * the few that bend the same way, at a common one. */
static void settle_offset(const struct fit_samples *s, const struct fit_input *input,
                          struct fit_solution *best)
{
    struct fit_solution plain = *best, offset = *best;
    plain.model = fit_model_without_offset(best->model);
    plain.p[FIT_C] = 0;
    plain.free[FIT_C] = false;
    best->near_known = true;
    if (plain.model == best->model && (plain.model == FIT_RADIAL || plain.model == FIT_PLANAR)) {
        offset.model = plain.model == FIT_RADIAL ? FIT_RADIAL_NEAR : FIT_PLANAR_NORMALIZED;
        if (plain.model == FIT_PLANAR && !(input->models >> offset.model & 1u))
            return;
        offset.p[FIT_C] = 0.01;
        offset.free[FIT_C] = true;
    } else if (plain.model == best->model || !(input->models >> plain.model & 1u)) {
        return;
    }
    const double common = fmax(best->sigma, FIT_LEAST_SIGMA);
    fit_refine(s, &offset, common);
    /* A little of an offset is what filters and rounding leave. */
    const double least =
        offset.model == FIT_PLANAR_NORMALIZED && best->model == FIT_PLANAR ? 0.03 : 0;
    const bool earned = fabs(offset.p[FIT_C]) > least && earns(s, &plain, &offset, common) &&
                        earns(s, &plain, &offset, best->sigma);
    fit_refine(s, &plain, common);
    const double apart = fabs(plain.p[FIT_LN_K] - offset.p[FIT_LN_K]);
    *best = sharpened(s, earned ? &offset : &plain);
    best->near_known = earned;
    best->near = earned ? best->p[FIT_C] : offset.p[FIT_C];
    best->near_deviation = earned ? best->deviation[FIT_C] : offset.deviation[FIT_C];
    /* Where the name says that there is one, not to see it is no proof of none. */
    if (!earned && (input->models >> FIT_RADIAL_NEAR & 1u))
        best->doubt += apart;
}

/* Normals that face the eye tell R from -R; where too many do not, the world is right-handed. A
 * mirrored world must be in the data. */
static void settle_sign(const struct fit_samples *s, struct fit_solution *best)
{
    const struct fit_residual *residuals = fit_find_residuals(s, best);
    double balance = 0, values[3];
    struct vec3 weakest;
    for (size_t i = 0; i < s->count; i++)
        balance += residuals[i].cosine < 0 ? -s->list[i].weight : s->list[i].weight;
    balance /= s->total_weight;
    struct mat3 *r = &best->rotation;
    if (balance < -0.5 || (fabs(balance) <= 0.5 && dot(cross(r->x, r->y), r->z) < 0))
        *r = (struct mat3){scale(r->x, -1), scale(r->y, -1), scale(r->z, -1)};
    best->hand_unknown = fabs(balance) <= 0.5;
    if (dot(cross(r->x, r->y), r->z) > 0)
        return;
    fit_directions(s, best, values, &weakest);
    struct fit_solution t = *best;
    const struct vec3 rows[3] = {r->x, r->y, r->z};
    const double along[3] = {weakest.x, weakest.y, weakest.z};
    struct vec3 reflected = {0, 0, 0}, out[3];
    for (int i = 0; i < 3; i++)
        reflected = mad(rows[i], along[i], reflected);
    for (int i = 0; i < 3; i++)
        out[i] = mad(reflected, -2.0 * along[i], rows[i]);
    t.rotation = (struct mat3){out[0], out[1], out[2]};
    fit_refine(s, &t, best->sigma);
    /* Round things tell it too, which are not exact. */
    const double common = fmax(best->sigma, 0.02);
    const struct fit_solution as_is = fit_refined(s, best, common),
                              turned = fit_refined(s, &t, common);
    const double worse = turned.cost - as_is.cost;
    if (worse < 0.01 || (worse < 0.05 && fit_paired_z(&as_is, &turned) < 3)) {
        t.hand_unknown = true;
        *best = t;
    }
}

/* --- The whole --- */

struct attempt {
    struct fit_solution best;
    struct fit fit;
    double near_share;
};

static void describe(const struct fit_samples *s, const struct fit_input *input,
                     const struct fit_solution *best, struct fit *fit)
{
    const struct vec3 rows[3] = {best->rotation.x, best->rotation.y, best->rotation.z};
    fit->model = best->model;
    fit->half_width = exp(best->p[FIT_LN_K]);
    fit->shift_x = -best->p[FIT_CX] / 2.0;
    fit->shift_y = -best->p[FIT_CY] / 2.0 * aspect_of(input);
    fit->near_plane = best->model == FIT_RADIAL_NEAR || best->model == FIT_PLANAR_NORMALIZED
                          ? best->p[FIT_C] * s->median
                          : 0;
    fit->near_known = best->near_known;
    if (fit_model_without_offset(best->model) == FIT_RADIAL) {
        fit->seen_near = best->near * s->median;
        fit->near_bound = 2.5 * best->near_deviation * s->median;
    }
    fit->median = s->median;
    fit->in_unit_range = is_in_unit_range(s);
    for (int i = 0; i < 3; i++) {
        fit->rotation[i * 3] = rows[i].x;
        fit->rotation[i * 3 + 1] = rows[i].y;
        fit->rotation[i * 3 + 2] = rows[i].z;
    }
}

/* What else may be wrong with an image whose normals are not those of its depth: the one that
 * explains them best. */
static bool find_causes(const struct fit_samples *s, const struct fit_input *input,
                        const struct fit_solution *best, struct fit *fit)
{
    struct fit_stretch stretch;
    struct fit_tone tone = {.cost = INFINITY};
    if (!fit_find_stretch(s, best, &stretch))
        return false;
    /* A field of view that is known may be wrong, and looks like it. */
    if (best->free[FIT_LN_K] && (input->models >> FIT_PLANAR & 1u) &&
        !fit_find_tone(s, best, &tone))
        return false;
    if (tone.share > 0 && tone.cost < stretch.cost)
        fit->tone = s->median / tone.share;
    else if (isfinite(stretch.cost))
        fit->pixel_aspect = input->pixel_aspect / stretch.times;
    else if (fabs(stretch.times - 1.0) > 0)
        fit->other_aspect = input->pixel_aspect / stretch.times;
    fit->squeezed = stretch.agreement;
    fit->curve = tone.curve;
    fit->toned = tone.agreement;
    return true;
}

/* One attempt with normals averaged over a patch. *tried is false if there is too little to go by.
 */
static bool attempt(const struct fit_input *input, unsigned blur, struct attempt *a, bool *tried)
{
    struct fit_samples s;
    struct fit_found f;
    double sigma;
    *a = (struct attempt){.near_share = 0};
    *tried = false;
    if (!fit_samples_take(input, blur, &s))
        return false;
    bool ok = s.count == 0 || search(&s, input, &f);
    if (ok && s.count > 0 && f.count > 0) {
        refine_all(&s, &f, &sigma);
        if (f.count > 0) {
            const struct fit_solution coarse = f.list[0];
            a->best = coarse;
            if (coarse.free[FIT_LN_K]) {
                a->best = sharpened(&s, &coarse);
                if (!fit_model_is_ortho(coarse.model))
                    try_shift(&s, &coarse, sigma, &a->best);
                if (1.0 - fit_cost(&s, &a->best, FIT_HALF_AGREEMENT) < all_agree)
                    try_shift_of_rivals(&s, &f, sigma, &a->best);
            }
            settle_offset(&s, input, &a->best);
            settle_sign(&s, &a->best);
            a->near_share = fit_near_share(&s, &a->best);
            describe(&s, input, &a->best, &a->fit);
            a->fit.agreement = 1.0 - fit_cost(&s, &a->best, FIT_HALF_AGREEMENT);
            a->fit.tells_view = fit_tells_view(&s, &a->best);
            if ((a->fit.agreement < all_agree || a->best.shifted) && blur == 0)
                ok = find_causes(&s, input, &a->best, &a->fit);
            ok = ok && fit_judge(&s, &f, sigma, &a->best, &a->fit);
            *tried = true;
        }
    }
    fit_samples_free(&s);
    return ok;
}

/* What may lack a lens shift has nothing to say against one. */
static bool contradict(const struct attempt *a, const struct attempt *b)
{
    const double spread = b->best.deviation[FIT_LN_K] + (a->best.shifted ? b->best.doubt : 0);
    return spread < 0.03 && b->near_share > 0.25 && a->best.model == b->best.model &&
           fabs(a->best.p[FIT_LN_K] - b->best.p[FIT_LN_K]) >
               3.0 * (spread + a->best.deviation[FIT_LN_K]) + 0.02;
}

/* Where one attempt leaves open whether there is a lens shift, it is open for all that have none
 * and found the same. */
static void take_doubts(const struct attempt *best, const struct attempt attempts[], size_t count,
                        struct fit *fit)
{
    static const double same = 0.05;
    for (size_t i = 0; i < count && !best->best.shifted; i++) {
        const struct fit_solution *s = &attempts[i].best;
        if (s->model == best->best.model && !s->shifted &&
            fabs(s->p[FIT_LN_K] - best->best.p[FIT_LN_K]) < same)
            fit_doubt(fit, s->doubt);
    }
}

/* Patches blur what tells a lens shift that single normals have shown. */
static bool is_settled(const struct attempt *a)
{
    return a->fit.is_sure && (a->fit.bound < 0.008 || a->best.shifted);
}

/* Normals that are those of the depth in any field of view: patches mix those of faces, and would
 * only make one up. */
static bool tells_nothing(const struct attempt *a)
{
    return !a->fit.tells_view && a->near_share > 0.9 && a->best.sigma <= FIT_LEAST_SIGMA;
}

bool camera_fit(const struct fit_input *input, struct fit *fit, struct tool_error *err)
{
    /* The sure one of the least error counts; bump maps need patches. */
    static const unsigned blurs[] = {[FIT_PATCH_SMALL] = 3, [FIT_PATCH_LARGE] = 8};
    struct attempt attempts[3], *best = NULL;
    size_t count = 0;
    *fit = (struct fit){.model = FIT_PLANAR};
    snprintf(fit->why, sizeof fit->why, "no smooth surface has normals");
    for (int patch = FIT_PATCH_NONE; patch <= FIT_PATCH_LARGE; patch++) {
        bool tried;
        if (input->patch != FIT_PATCH_ANY && (int)input->patch != patch)
            continue;
        if (!attempt(input, blurs[patch], &attempts[count], &tried))
            return fail(err, EXIT_MEMORY, "out of memory for the estimate of the camera");
        attempts[count].fit.patch = (enum fit_patch)patch;
        count += tried;
        if (tried && (is_settled(&attempts[count - 1]) || tells_nothing(&attempts[count - 1])))
            break;
    }
    for (size_t i = 0; i < count; i++) {
        const struct attempt *a = &attempts[i];
        if (!best || (a->fit.is_sure && !best->fit.is_sure) ||
            (a->fit.is_sure == best->fit.is_sure &&
             a->best.deviation[FIT_LN_K] < best->best.deviation[FIT_LN_K]))
            best = &attempts[i];
    }
    if (!best)
        return true;
    *fit = best->fit;
    fit->pixel_aspect = attempts[0].fit.pixel_aspect;
    fit->squeezed = attempts[0].fit.squeezed;
    fit->other_aspect = best->best.shifted ? attempts[0].fit.other_aspect : 0;
    /* A curve may stand in for a lens shift that patches alone have shown. */
    const bool is_shift = best->best.shifted && best->fit.agreement >= attempts[0].fit.toned;
    fit->tone = is_shift ? 0 : attempts[0].fit.tone;
    fit->curve = attempts[0].fit.curve;
    fit->toned = attempts[0].fit.toned;
    take_doubts(best, attempts, count, fit);
    for (size_t i = 0; i < count && fit->is_sure; i++)
        if (contradict(best, &attempts[i])) {
            fit->is_sure = false;
            snprintf(fit->why, sizeof fit->why, "fine and coarse normals contradict each other");
        }
    return true;
}
