/* SPDX-License-Identifier: MIT
 *
 * An EXR file of any bytes, from its headers to a copy of it with AO appended: headers, pixels,
 * roles, camera, G-buffer, a new part, and all of it read again. The last bytes of the input choose
 * the options. */
#include "automatic.h"
#include "camera.h"
#include "exr_file.h"
#include "fuzz.h"
#include "fuzz_view.h"
#include "gbuffer.h"
#include "placement.h"

#include <dirent.h>
#include <limits.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum {
    OPTION_BYTES = 16,
    MOST_PIXELS = 1 << 14, /* of what is decoded: more are as good, and slower */
    MOST_CHANNELS = 4,     /* read at once */
    GUARD = 4096,
    ROOM = MOST_PIXELS * MOST_CHANNELS * sizeof(float)
};

static const uint64_t refusals = FUZZ_CODE(EXIT_INPUT) | FUZZ_CODE(EXIT_CHANNELS) |
                                 FUZZ_CODE(EXIT_OUTPUT) | FUZZ_CODE(EXIT_MEMORY);

static const char *const compressions[] = {"none",  "rle", "zips", "zip",  "piz",
                                           "pxr24", "b44", "b44a", "dwaa", "dwab"};

/* --- Files --- */

static int input_fd = -1;
static char input_path[64], output_path[PATH_MAX];

static void store_input(const uint8_t *data, size_t size)
{
    if (input_fd < 0) {
        input_fd = memfd_create("fuzz.exr", 0);
        snprintf(input_path, sizeof input_path, "/proc/self/fd/%d", input_fd);
        snprintf(output_path, sizeof output_path, "%s/out.exr", fuzz_directory());
    }
    /* Not a finding about the input: the harness itself is broken. */
    if (input_fd < 0 || ftruncate(input_fd, 0) != 0 ||
        pwrite(input_fd, data, size, 0) != (ssize_t)size)
        abort();
}

static size_t files_left(void)
{
    size_t count = 0;
    DIR *dir = opendir(fuzz_directory());
    if (!dir)
        abort();
    for (struct dirent *entry; (entry = readdir(dir));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(dir);
    return count;
}

/* --- Headers --- */

static int64_t width_of(const struct exr_box *box)
{
    return (int64_t)box->x_max - box->x_min + 1;
}

static int64_t height_of(const struct exr_box *box)
{
    return (int64_t)box->y_max - box->y_min + 1;
}

static bool is_small(const struct exr_box *box)
{
    return width_of(box) <= MOST_PIXELS && height_of(box) <= MOST_PIXELS &&
           width_of(box) * height_of(box) <= MOST_PIXELS;
}

static void check_part(const struct exr_part *part)
{
    const struct exr_box *w = &part->data_window;
    FUZZ_CHECK(part->name && part->view && part->type && part->compression && part->line_order,
               "a part lacks a text");
    FUZZ_CHECK(width_of(w) >= 1 && width_of(w) <= 65536 && height_of(w) >= 1 &&
                   height_of(w) <= 65536,
               "data window %lldx%lld", (long long)width_of(w), (long long)height_of(w));
    FUZZ_CHECK(part->channel_count > 0, "a part without channels");
    for (size_t i = 0; i < part->channel_count; i++) {
        const struct exr_channel *c = &part->channels[i];
        FUZZ_CHECK(c->name && c->name[0] && c->type <= EXR_FLOAT && c->x_sampling > 0 &&
                       c->y_sampling > 0,
                   "channel %zu", i);
        FUZZ_CHECK(i == 0 || strcmp(part->channels[i - 1].name, c->name) < 0,
                   "channels not sorted, or one twice: '%s'", c->name);
    }
    for (size_t i = 0; i < part->attribute_count; i++)
        FUZZ_CHECK(part->attributes[i].name && part->attributes[i].type, "attribute %zu", i);
}

/* --- Pixels --- */

/* Memory with nothing before and behind it. OpenEXR is not instrumented: what it writes outside of
 * the buffer that it was given is seen by the processor or not at all. */
static float *guarded(size_t bytes, bool at_end)
{
    static char *memory;
    if (!memory) {
        memory = mmap(NULL, ROOM + 2 * GUARD, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS,
                      -1, 0);
        if (memory == MAP_FAILED || mprotect(memory, GUARD, PROT_NONE) != 0 ||
            mprotect(memory + GUARD + ROOM, GUARD, PROT_NONE) != 0)
            abort();
    }
    return (float *)(void *)(memory + GUARD + (at_end ? ROOM - bytes : 0));
}

/* AddressSanitizer would fill the first 4096 bytes of every block alike, and memory that is shown
 * without having been written would look as it does every time. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "max_malloc_fill_size=0";
}

/* What new memory of the C library is filled with from now on, where there is a way to say so. */
static void fill_new_memory(int byte)
{
#ifdef M_PERTURB
    mallopt(M_PERTURB, byte);
#else
    (void)byte;
#endif
}

/* The first channels of a part, of one stride; malloc'ed, NULL if they cannot be read. Read twice
 * over different bytes, in the buffer and in whatever memory OpenEXR takes: nothing is left as it
 * was. */
static float *read_part(const struct exr_info *info, size_t part, bool at_end)
{
    const struct exr_part *p = &info->parts[part];
    const size_t pixels = (size_t)(width_of(&p->data_window) * height_of(&p->data_window));
    const size_t count = p->channel_count < MOST_CHANNELS ? p->channel_count : MOST_CHANNELS;
    const size_t bytes = pixels * count * sizeof(float);
    float *values = guarded(bytes, at_end), *first = malloc(bytes);
    struct exr_read reads[MOST_CHANNELS];
    struct tool_error err = {0};
    if (!first)
        abort();
    for (size_t i = 0; i < count; i++)
        reads[i] = (struct exr_read){p->channels[i].name, values + i, count};
    memset(values, 0, bytes);
    fill_new_memory(0x11);
    if (!exr_read_channels(info, part, reads, count, &err)) {
        fuzz_check_refusal(&err, refusals);
        free(first);
        return NULL;
    }
    memcpy(first, values, bytes);
    memset(values, 0xff, bytes);
    fill_new_memory(0x77);
    FUZZ_CHECK(exr_read_channels(info, part, reads, count, &err), "the second time: %s",
               err.message);
    FUZZ_CHECK(memcmp(first, values, bytes) == 0, "part %zu has pixels that were not read", part);
    return first;
}

/* --- G-buffers --- */

static void load(const struct exr_info *info, const struct gbuffer_options *options)
{
    enum { MOST_PADDING = 1 << 16 };
    struct report report = {.verbosity = REPORT_QUIET};
    struct tool_error err = {0};
    struct gbuffer g;
    struct placement placement;
    if (!gbuffer_load(info, options, NULL, &report, &g, &err)) {
        fuzz_check_refusal(&err, refusals & ~FUZZ_CODE(EXIT_OUTPUT));
        FUZZ_CHECK(!g.depth && !g.normals && !g.color, "a refusal left pixels behind");
        return;
    }
    fuzz_check_gbuffer(&g);
    FUZZ_CHECK(!options->want_color || g.color, "no colour");
    const uint64_t texels = (uint64_t)g.width * g.height;
    const uint64_t bytes = texels * (4u + (g.normals ? 16u : 0u) + (g.color ? 16u : 0u));
    const struct budget *budget = &options->budget;
    FUZZ_CHECK(!budget->pixels || texels <= budget->pixels, "%llu pixels",
               (unsigned long long)texels);
    FUZZ_CHECK(!budget->memory || bytes <= budget->memory, "%llu bytes", (unsigned long long)bytes);
    FUZZ_CHECK(placement_expand(&g, &placement, &err), "%s", err.message);
    FUZZ_CHECK(placement.left < MOST_PADDING && placement.top < MOST_PADDING, "padded by %ux%u",
               placement.left, placement.top);
    struct setting setting = setting_default();
    setting.params.radius = relative_radius_of(&(struct relative_radius){0}, &g);
    setting.params.bias = automatic_bias(&g, setting.params.radius, setting.params.bias);
    for (int half = 0; half < 2; half++) {
        setting.effect.half_resolution = (VkBool32)half;
        fuzz_check_job(&(struct fuzz_job){
            .width = g.width + placement.left,
            .height = g.height + placement.top,
            .view = &g.view,
            .setting = &setting,
        });
    }
    gbuffer_free(&g);
}

static void load_with_options(struct fuzz_input *in, const struct exr_info *info)
{
    struct gbuffer_options options = {0};
    load(info, &options);
    const size_t views = roles_view_count(info);
    if (views)
        options.roles.view = roles_view_name(info, fuzz_below(in, (uint32_t)views));
    options.depth_type = (enum depth_type)fuzz_below(in, DEPTH_DEVICE + 1);
    options.normal_space = (enum normal_space)fuzz_below(in, NORMAL_SPACE_CAMERA + 1);
    options.normal_encoding = (enum normal_encoding)fuzz_below(in, NORMAL_ENCODING_UNSIGNED + 1);
    options.want_color = fuzz_flag(in);
    options.roles.no_normals = fuzz_flag(in);
    const uint32_t camera = fuzz_u8(in);
    if (camera & 1)
        options.camera.near_plane = camera & 2 ? 0.1 : INFINITY;
    if (camera & 4)
        options.camera.far_plane = camera & 8 ? 1000 : INFINITY;
    if (camera & 16)
        options.camera.ortho_width = 10;
    /* Often more than enough, sometimes not. */
    const uint32_t budget = fuzz_u8(in);
    if (budget & 1)
        options.budget.memory = UINT64_C(1) << budget / 8;
    if (budget & 2)
        options.budget.pixels = UINT64_C(1) << budget / 8;
    options.work_texel_bytes = budget & 4 ? 100 : 0;
    if (fuzz_flag(in)) /* any channel may stand behind the depth */
        for (int kind = ROLE_THICKNESS; kind < ROLE_KINDS; kind++) {
            const struct exr_part *part = &info->parts[fuzz_below(in, (uint32_t)info->part_count)];
            if (part->channel_count)
                options.roles.name[kind] =
                    part->channels[fuzz_below(in, (uint32_t)part->channel_count)].name;
        }
    load(info, &options);
}

/* --- Appending --- */

enum { AO_PIXELS = 1 << 12 };

/* Exact in every type, and in 24 bits of float. */
static float ao_value(size_t i, enum exr_pixel_type type)
{
    return type == EXR_UINT ? (float)(i % 5000) : (float)(i % 257) / 256.0f;
}

static bool keeps_values(const char *compression)
{
    return strncmp(compression, "b44", 3) != 0 && strncmp(compression, "dwa", 3) != 0;
}

static bool same_numbers(const struct exr_attribute *a, const struct exr_attribute *b)
{
    if (strcmp(a->type, b->type) != 0 || a->number_count != b->number_count ||
        (a->text != NULL) != (b->text != NULL))
        return false;
    return (!a->text || strcmp(a->text, b->text) == 0) &&
           (!a->number_count ||
            memcmp(a->numbers, b->numbers, a->number_count * sizeof *a->numbers) == 0);
}

/* What a copy may change: OpenEXR counts the chunks itself, a part must have a name, and a
 * description of tiles has no meaning in a part that has none. */
static bool may_change(const char *name)
{
    static const char *const names[] = {"name", "type", "chunkCount", "tiles", "version"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

static void check_attributes(const struct exr_part *before, const struct exr_part *after)
{
    for (size_t i = 0; i < before->attribute_count; i++) {
        const struct exr_attribute *a = &before->attributes[i];
        bool kept = may_change(a->name);
        for (size_t k = 0; !kept && k < after->attribute_count; k++)
            kept = strcmp(a->name, after->attributes[k].name) == 0 &&
                   same_numbers(a, &after->attributes[k]);
        FUZZ_CHECK(kept, "attribute '%s' was lost or changed", a->name);
    }
}

static bool same_box(const struct exr_box *a, const struct exr_box *b)
{
    return a->x_min == b->x_min && a->y_min == b->y_min && a->x_max == b->x_max &&
           a->y_max == b->y_max;
}

static void check_copy(const struct exr_info *before, const struct exr_info *after, size_t part)
{
    const struct exr_part *a = &before->parts[part], *b = &after->parts[part];
    FUZZ_CHECK(same_box(&a->data_window, &b->data_window) &&
                   same_box(&a->display_window, &b->display_window),
               "part %zu has other windows", part);
    FUZZ_CHECK(strcmp(a->compression, b->compression) == 0 && a->deep == b->deep &&
                   strcmp(a->type, b->type) == 0,
               "part %zu is %s %s, was %s %s", part, b->type, b->compression, a->type,
               a->compression);
    FUZZ_CHECK(a->channel_count == b->channel_count, "part %zu has %zu channels, had %zu", part,
               b->channel_count, a->channel_count);
    for (size_t i = 0; i < a->channel_count; i++)
        FUZZ_CHECK(strcmp(a->channels[i].name, b->channels[i].name) == 0 &&
                       a->channels[i].type == b->channels[i].type,
                   "channel %zu of part %zu is another", i, part);
    check_attributes(a, b);
    if (!is_small(&a->data_window) || a->deep)
        return;
    float *was = read_part(before, part, false);
    float *is = was ? read_part(after, part, true) : NULL;
    const size_t count = a->channel_count < MOST_CHANNELS ? a->channel_count : MOST_CHANNELS;
    const size_t pixels = (size_t)(width_of(&a->data_window) * height_of(&a->data_window));
    FUZZ_CHECK(!was || (is && memcmp(was, is, pixels * count * sizeof *was) == 0),
               "the pixels of part %zu are others, or cannot be read any more", part);
    free(was);
    free(is);
}

static void check_new_part(const struct exr_info *info, const struct exr_new_part *made)
{
    const struct exr_part *part = &info->parts[info->part_count - 1];
    const enum exr_pixel_type type = made->channels[0].type;
    FUZZ_CHECK(same_box(&part->data_window, &made->data_window), "another window");
    FUZZ_CHECK(part->channel_count == 1 && strcmp(part->channels[0].name, "AO") == 0 &&
                   part->channels[0].type == type,
               "other channels");
    FUZZ_CHECK(info->part_count == 1 || strcmp(part->name, made->name) == 0, "called '%s'",
               part->name);
    float *values = read_part(info, info->part_count - 1, true);
    FUZZ_CHECK(values, "cannot be read");
    const size_t pixels = (size_t)(width_of(&part->data_window) * height_of(&part->data_window));
    for (size_t i = 0; keeps_values(made->compression) && i < pixels; i++)
        FUZZ_CHECK(fabsf(values[i] - ao_value(i, type)) <= 0.0f, "AO %zu is %g, wrote %g", i,
                   (double)values[i], (double)ao_value(i, type));
    free(values);
}

static void check_output(const struct exr_info *input, bool copied, const struct exr_new_part *made)
{
    struct exr_info info;
    struct tool_error err = {0};
    const size_t copies = copied ? input->part_count : 0;
    FUZZ_CHECK(files_left() == 1, "%zu files were left", files_left());
    FUZZ_CHECK(exr_info_read(output_path, &info, &err), "what was written: %s", err.message);
    FUZZ_CHECK(info.part_count == copies + 1, "%zu parts, want %zu", info.part_count, copies + 1);
    for (size_t i = 0; i < copies; i++)
        check_copy(input, &info, i);
    check_new_part(&info, made);
    exr_info_free(&info);
    unlink(output_path);
}

/* With all of the input, or with the attributes of one of its parts alone. */
static void append(struct fuzz_input *in, const struct exr_info *info)
{
    static float values[AO_PIXELS];
    struct tool_error err = {0};
    const bool copied = !fuzz_flag(in) || !fuzz_flag(in);
    const struct exr_part *first = &info->parts[0];
    const struct exr_write channel = {"AO", (enum exr_pixel_type)fuzz_below(in, 3), values, 1};
    struct exr_new_part part = {
        .name = fuzz_below(in, 16) == 15 ? first->name : "ao",
        .data_window = first->data_window,
        .display_window = first->display_window,
        .pixel_aspect = first->pixel_aspect,
        .compression = compressions[fuzz_below(in, 10)],
        .channels = &channel,
        .channel_count = 1,
        .attributes_from = info,
        .attributes_from_part = fuzz_below(in, (uint32_t)info->part_count),
        .level = (float)fuzz_below(in, 12),
    };
    const bool fits = is_small(&part.data_window) &&
                      width_of(&part.data_window) * height_of(&part.data_window) <= AO_PIXELS;
    if (!fits) {
        part.data_window.x_max = part.data_window.x_min;
        part.data_window.y_max = part.data_window.y_min;
    }
    for (size_t i = 0; i < AO_PIXELS; i++)
        values[i] = ao_value(i, channel.type);
    if (exr_write_file(output_path, copied ? info : NULL, &part, 1, fuzz_flag(in), &err)) {
        check_output(info, copied, &part);
        return;
    }
    fuzz_check_refusal(&err, refusals);
    FUZZ_CHECK(files_left() == 0, "a refusal left %zu files: %s", files_left(), err.message);
}

/* What becomes shorter while it is open is an error of its own, whatever was learned before. */
static void cut_while_open(const struct exr_info *info, size_t size)
{
    struct tool_error err = {0};
    float values[1];
    const struct exr_read read = {info->parts[0].channels[0].name, values, 0};
    if (!size || ftruncate(input_fd, (off_t)(size / 2)) != 0)
        return;
    FUZZ_CHECK(!exr_read_channels(info, 0, &read, 1, &err), "read from a file that was cut");
    fuzz_check_refusal(&err, FUZZ_CODE(EXIT_INPUT));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const size_t tail = size < OPTION_BYTES ? size : OPTION_BYTES;
    struct fuzz_input in = {data + size - tail, tail};
    struct exr_info info;
    struct tool_error err = {0};
    store_input(data, size);
    if (!exr_info_read(input_path, &info, &err)) {
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_INPUT) | FUZZ_CODE(EXIT_MEMORY));
        FUZZ_CHECK(!info.parts && !info.part_count, "a refusal left parts behind");
        return 0;
    }
    FUZZ_CHECK(info.part_count > 0, "a file without parts");
    bool small = true;
    for (size_t i = 0; i < info.part_count; i++) {
        const struct exr_part *part = &info.parts[i];
        struct camera camera = {0};
        check_part(part);
        camera_from_header(part, &camera);
        if (is_small(&part->data_window))
            free(read_part(&info, i, fuzz_flag(&in)));
        else
            small = false;
    }
    if (small)
        load_with_options(&in, &info);
    append(&in, &info);
    if (fuzz_flag(&in))
        cut_while_open(&info, size);
    exr_info_free(&info);
    return 0;
}
