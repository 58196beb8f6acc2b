/* SPDX-License-Identifier: MIT */
#include "frames.h"

#include "text.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MAX_FRAMES = 1000000,
    MAX_DIGITS = 18 /* all of them fit into 64 bits */
};

static bool append(struct frame_list *list, size_t *capacity, int64_t number, char *path,
                   struct tool_error *err)
{
    if (list->count == *capacity) {
        size_t grown = *capacity ? *capacity * 2 : 64;
        struct frame *frames = realloc(list->frames, grown * sizeof *frames);
        if (!frames)
            return fail(err, EXIT_MEMORY, "out of memory for a list of %zu frames", grown);
        list->frames = frames;
        *capacity = grown;
    }
    list->frames[list->count++] = (struct frame){.number = number, .path = path};
    return true;
}

void frame_list_free(struct frame_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->frames[i].path);
    free(list->frames);
    *list = (struct frame_list){0};
}

static bool read_number(const char **at, int64_t *number)
{
    const char *p = *at;
    bool negative = *p == '-';
    if (negative)
        p++;
    if (!isdigit((unsigned char)*p))
        return false;
    int64_t value = 0;
    for (int digits = 0; isdigit((unsigned char)*p); p++, digits++) {
        if (digits == MAX_DIGITS)
            return false;
        value = value * 10 + (*p - '0');
    }
    *number = negative ? -value : value;
    *at = p;
    return true;
}

struct range {
    int64_t first, last, step;
};

static bool read_range(const char *spec, const char **at, enum frame_syntax syntax,
                       struct range *range, struct tool_error *err)
{
    *range = (struct range){.step = 1};
    if (!read_number(at, &range->first))
        return fail(err, EXIT_USAGE, "frames '%s': expected a frame number at '%s'", spec, *at);
    range->last = range->first;
    if (**at == '-') {
        (*at)++;
        if (!read_number(at, &range->last))
            return fail(err, EXIT_USAGE, "frames '%s': expected a frame number at '%s'", spec, *at);
    }
    if (**at == ':' && syntax == FRAME_SYNTAX_VFX) {
        fail_hint(err, "write 1-10x2 (step) or pass --frames-syntax openjd");
        return fail(err, EXIT_USAGE,
                    "frames '%s': ':' means step in OpenJD but interleave in fileseq/OpenCue",
                    spec);
    }
    if (**at == 'y' || **at == 'Y') {
        fail_hint(err, "list the frames: 1-3,5-7");
        return fail(err, EXIT_USAGE, "frames '%s': 'y' (all but every n-th) is not supported",
                    spec);
    }
    if (**at == 'x' || **at == ':') {
        (*at)++;
        if (!read_number(at, &range->step) || range->step < 1)
            return fail(err, EXIT_USAGE, "frames '%s': the step must be a whole number >= 1", spec);
    }
    return true;
}

static bool add_range(const char *spec, const struct range *range, struct frame_list *list,
                      size_t *capacity, struct tool_error *err)
{
    int64_t step = range->first <= range->last ? range->step : -range->step;
    int64_t span = range->last - range->first;
    int64_t count = (span < 0 ? -span : span) / range->step + 1;
    if (count > MAX_FRAMES - (int64_t)list->count)
        return fail(err, EXIT_USAGE, "frames '%s': more than %d frames", spec, MAX_FRAMES);
    for (int64_t i = 0; i < count; i++)
        if (!append(list, capacity, range->first + i * step, NULL, err))
            return false;
    return true;
}

struct numbered {
    int64_t number;
    size_t place;
};

static int compare_numbered(const void *a, const void *b)
{
    const struct numbered *x = a, *y = b;
    if (x->number != y->number)
        return x->number < y->number ? -1 : 1;
    return x->place < y->place ? -1 : x->place > y->place;
}

/* Keeps the first of equal numbers, in the order that the user gave. */
static bool drop_repeated(struct frame_list *list, struct tool_error *err)
{
    struct numbered *sorted = malloc(list->count * sizeof *sorted);
    if (!sorted)
        return fail(err, EXIT_MEMORY, "out of memory for a list of %zu frames", list->count);
    bool *repeated = calloc(list->count, sizeof *repeated);
    if (!repeated) {
        free(sorted);
        return fail(err, EXIT_MEMORY, "out of memory for a list of %zu frames", list->count);
    }
    for (size_t i = 0; i < list->count; i++)
        sorted[i] = (struct numbered){.number = list->frames[i].number, .place = i};
    qsort(sorted, list->count, sizeof *sorted, compare_numbered);
    for (size_t i = 1; i < list->count; i++)
        repeated[sorted[i].place] = sorted[i].number == sorted[i - 1].number;
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++)
        if (!repeated[i])
            list->frames[kept++] = list->frames[i];
    list->count = kept;
    free(repeated);
    free(sorted);
    return true;
}

bool frame_list_parse(const char *spec, enum frame_syntax syntax, struct frame_list *list,
                      struct tool_error *err)
{
    *list = (struct frame_list){0};
    size_t capacity = 0;
    const char *at = spec;
    for (;;) {
        struct range range;
        if (!read_range(spec, &at, syntax, &range, err) ||
            !add_range(spec, &range, list, &capacity, err))
            break;
        if (!*at) {
            if (!drop_repeated(list, err))
                break;
            return true;
        }
        if (*at++ != ',') {
            fail_hint(err, "write 1-10, 1-10x2 or 1,5,20-30");
            fail(err, EXIT_USAGE, "frames '%s': cannot read '%s'", spec, at - 1);
            break;
        }
    }
    frame_list_free(list);
    return false;
}

void frame_list_describe(const struct frame_list *list, char *buffer, size_t size)
{
    size_t used = 0;
    buffer[0] = '\0';
    for (size_t i = 0; i < list->count;) {
        size_t end = i;
        while (end + 1 < list->count &&
               list->frames[end + 1].number == list->frames[end].number + 1)
            end++;
        char item[64];
        int length = end > i ? snprintf(item, sizeof item, "%s%" PRId64 "-%" PRId64, i ? ", " : "",
                                        list->frames[i].number, list->frames[end].number)
                             : snprintf(item, sizeof item, "%s%" PRId64, i ? ", " : "",
                                        list->frames[i].number);
        if (used + (size_t)length + sizeof ", ..." > size) {
            snprintf(buffer + used, size - used, ", ...");
            return;
        }
        memcpy(buffer + used, item, (size_t)length + 1);
        used += (size_t)length;
        i = end + 1;
    }
}

/* Length of the token at p, 0 if none starts there. */
static size_t token_length(const char *p, int *digits)
{
    size_t run = strspn(p, "#@");
    if (run) {
        *digits = run == 1 && *p == '#' ? 4 : (int)run;
        return run;
    }
    if (*p == '%') {
        size_t number = strspn(p + 1, "0123456789");
        if (number > 2 || p[1 + number] != 'd')
            return 0;
        *digits = number ? atoi(p + 1) : 1;
        return number + 2;
    }
    if (p[0] == '$' && p[1] == 'F') {
        *digits = isdigit((unsigned char)p[2]) ? p[2] - '0' : 1;
        return isdigit((unsigned char)p[2]) ? 3 : 2;
    }
    return 0;
}

static const char *find_token(const char *name, size_t *length, int *digits)
{
    for (const char *p = name; *p; p++)
        if ((*length = token_length(p, digits)) > 0)
            return p;
    return NULL;
}

/* Between separators, or at an end of the name. */
static bool stands_alone(const char *name, const char *token, size_t length)
{
    return (token == name || strchr("._-", token[-1])) && strchr("._-", token[length]);
}

const char *frame_token_that_is_clear(const char *path, size_t *length)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path, *p = name;
    int digits;
    while ((p = find_token(p, length, &digits)) != NULL) {
        const bool is_short =
            *length == 1 || strncmp(p, "%d", *length) == 0 || strncmp(p, "$F", *length) == 0;
        if (!is_short || stands_alone(name, p, *length))
            return p;
        p += *length;
    }
    return NULL;
}

bool frame_pattern_parse(const char *path, struct frame_pattern *pattern, struct tool_error *err)
{
    *pattern = (struct frame_pattern){0};
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    size_t length = 0, second = 0;
    int unused;
    const char *token = find_token(name, &length, &pattern->digits);
    if (token) {
        bool mixed = strspn(token, "#") < length && strspn(token, "@") < length &&
                     (*token == '#' || *token == '@');
        if (mixed) {
            fail_hint(err, "use one kind: #### for four digits");
            return fail(err, EXIT_USAGE, "%s: frame token '%.*s' mixes # and @", path, (int)length,
                        token);
        }
        if (find_token(token + length, &second, &unused))
            return fail(err, EXIT_USAGE, "%s: more than one frame token in the file name", path);
        if (pattern->digits > MAX_DIGITS)
            return fail(err, EXIT_USAGE, "%s: frame numbers have at most %d digits", path,
                        MAX_DIGITS);
        pattern->is_printf = *token == '%';
        pattern->suffix = text_copy(token + length, strlen(token + length));
    }
    pattern->prefix = text_copy(path, token ? (size_t)(token - path) : strlen(path));
    if (!pattern->prefix || (token && !pattern->suffix)) {
        frame_pattern_free(pattern);
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    }
    return true;
}

void frame_pattern_free(struct frame_pattern *pattern)
{
    free(pattern->prefix);
    free(pattern->suffix);
    *pattern = (struct frame_pattern){0};
}

bool frame_pattern_has_token(const struct frame_pattern *pattern)
{
    return pattern->suffix != NULL;
}

char *frame_pattern_path(const struct frame_pattern *pattern, int64_t number)
{
    struct text path = {0};
    if (!pattern->suffix)
        text_add(&path, "%s", pattern->prefix);
    else if (pattern->is_printf)
        text_add(&path, "%s%0*" PRId64 "%s", pattern->prefix, pattern->digits, number,
                 pattern->suffix);
    else
        text_add(&path, "%s%s%0*" PRId64 "%s", pattern->prefix, number < 0 ? "-" : "",
                 pattern->digits, number < 0 ? -number : number, pattern->suffix);
    if (path.out_of_memory)
        text_free(&path);
    return path.data;
}

/* The number in name if it is prefix, number, suffix and nothing else. */
static bool match_name(const char *name, const char *prefix, const char *suffix, int64_t *number)
{
    const size_t before = strlen(prefix), behind = strlen(suffix), length = strlen(name);
    char digits[MAX_DIGITS + 2]; /* with a sign; longer ones are no number */
    if (length <= before + behind || length - before - behind >= sizeof digits ||
        !text_starts_with(name, prefix) || !text_ends_with(name, suffix))
        return false;
    /* Not as far as there are digits: those at the beginning of the suffix are not the number's. */
    snprintf(digits, sizeof digits, "%.*s", (int)(length - before - behind), name + before);
    const char *p = digits;
    return read_number(&p, number) && !*p;
}

static int compare_frames(const void *a, const void *b)
{
    const struct frame *x = a, *y = b;
    if (x->number != y->number)
        return x->number < y->number ? -1 : 1;
    return strcmp(x->path, y->path);
}

static bool merge_paddings(const struct frame_pattern *pattern, struct frame_list *list,
                           struct tool_error *err)
{
    if (list->count == 0)
        return true;
    qsort(list->frames, list->count, sizeof *list->frames, compare_frames);
    bool ok = true;
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++) {
        struct frame *last = kept ? &list->frames[kept - 1] : NULL;
        if (!last || last->number != list->frames[i].number) {
            list->frames[kept++] = list->frames[i];
            continue;
        }
        char *exact = frame_pattern_path(pattern, last->number);
        bool better = exact && strcmp(exact, list->frames[i].path) == 0;
        free(better ? last->path : list->frames[i].path);
        if (better)
            last->path = list->frames[i].path;
        free(exact);
        ok = ok && exact;
    }
    list->count = kept;
    return ok || fail(err, EXIT_MEMORY, "out of memory for a list of frames");
}

static bool scan_directory(const struct frame_pattern *pattern, DIR *dir, size_t dir_length,
                           struct frame_list *list, struct tool_error *err)
{
    size_t capacity = 0;
    const struct dirent *entry;
    while ((entry = readdir(dir)) != NULL) {
        int64_t number;
        if (!match_name(entry->d_name, pattern->prefix + dir_length, pattern->suffix, &number))
            continue;
        struct text path = {0};
        text_add(&path, "%.*s%s", (int)dir_length, pattern->prefix, entry->d_name);
        if (path.out_of_memory || list->count == MAX_FRAMES) {
            text_free(&path);
            return fail(err, EXIT_MEMORY, "%s: too many frames", pattern->prefix);
        }
        if (!append(list, &capacity, number, path.data, err)) {
            text_free(&path);
            return false;
        }
    }
    return merge_paddings(pattern, list, err);
}

bool frame_pattern_scan(const struct frame_pattern *pattern, struct frame_list *list,
                        struct tool_error *err)
{
    *list = (struct frame_list){0};
    const char *slash = strrchr(pattern->prefix, '/');
    size_t dir_length = slash ? (size_t)(slash - pattern->prefix) + 1 : 0;
    char *name = dir_length ? text_copy(pattern->prefix, dir_length) : text_copy(".", 1);
    if (!name)
        return fail(err, EXIT_MEMORY, "%s: out of memory", pattern->prefix);
    DIR *dir = opendir(name);
    if (!dir) {
        fail(err, EXIT_INPUT, "%s: cannot list: %s", name, strerror(errno));
        free(name);
        return false;
    }
    bool ok = scan_directory(pattern, dir, dir_length, list, err);
    closedir(dir);
    free(name);
    if (!ok)
        frame_list_free(list);
    return ok;
}
