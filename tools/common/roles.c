/* SPDX-License-Identifier: MIT */
#include "roles.h"

#include "cryptomatte.h"
#include "role_search.h"
#include "text.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* --- Views --- */

static bool first_with_view(const struct exr_info *info, size_t part)
{
    const char *view = info->parts[part].view;
    if (!view || !*view)
        return false;
    for (size_t i = 0; i < part; i++)
        if (info->parts[i].view && strcmp(info->parts[i].view, view) == 0)
            return false;
    return true;
}

/* The part whose channels name the views, as in single-part stereo files, to which others may have
 * been appended; NULL if parts are of one view each. */
static const struct exr_part *part_of_all_views(const struct exr_info *info)
{
    for (size_t i = 0; i < info->part_count; i++)
        if (info->parts[i].multi_view_count > 0)
            return &info->parts[i];
    return NULL;
}

size_t roles_view_count(const struct exr_info *info)
{
    if (part_of_all_views(info))
        return part_of_all_views(info)->multi_view_count;
    size_t count = 0;
    for (size_t i = 0; i < info->part_count; i++)
        count += first_with_view(info, i);
    return count;
}

const char *roles_view_name(const struct exr_info *info, size_t index)
{
    if (part_of_all_views(info))
        return part_of_all_views(info)->multi_view[index];
    for (size_t i = 0; i < info->part_count; i++)
        if (first_with_view(info, i) && index-- == 0)
            return info->parts[i].view;
    return "";
}
/* --- Results --- */

static size_t common_prefix(const char *a, const char *b)
{
    size_t n = 0;
    while (a[n] && a[n] == b[n])
        n++;
    return n;
}

/* Two view layers each have normals: those that go with the depth are meant. */
static void prefer_neighbours(struct role_search *s, const struct role *depth)
{
    if (depth->info != s->info)
        return;
    size_t best = 0, kept = 0;
    const char *near_name = depth->channels[0]->name;
    for (size_t i = 0; i < s->count; i++) {
        size_t n = common_prefix(s->hits[i].channels[0]->name, near_name);
        best = n > best ? n : best;
    }
    for (size_t i = 0; i < s->count; i++)
        if (common_prefix(s->hits[i].channels[0]->name, near_name) == best)
            s->hits[kept++] = s->hits[i];
    s->count = kept;
    kept = 0;
    for (size_t i = 0; i < s->count; i++)
        kept += s->hits[i].part == depth->part;
    if (kept == 1)
        for (size_t i = 0; i < s->count; i++)
            if (s->hits[i].part == depth->part) {
                s->hits[0] = s->hits[i];
                s->count = 1;
            }
}
/* G beside an R: whether that is a picture in grey shows when it is read. */
static const struct exr_channel *twin_of(const struct role_search *s, const struct role *role)
{
    const struct exr_part *part = &s->info->parts[role->part];
    struct role_channel name;
    return role->channel_count == 1 &&
                   role_channel_read(part, role->channels[0]->name, s->view,
                                     s->info->part_count > 1, &name) &&
                   role_name_fits("R|red", name.component)
               ? role_channel_sibling(s, role->part, &name, "G|green")
               : NULL;
}

static void take_hit(const struct role_search *s, const struct role_hit *hit,
                     const struct role_row *row, struct role *role)
{
    role->found = true;
    role->info = s->info;
    role->part = hit->part;
    memcpy(role->channels, hit->channels, sizeof role->channels);
    role->channel_count = hit->channel_count;
    role->depth_type = row ? row->depth_type : DEPTH_AUTO;
    role->normal_space = row ? row->normal_space : NORMAL_SPACE_AUTO;
    role->follows_positions = row && row->companion;
    role->twin = row && row->is_mixed ? NULL : twin_of(s, role);
    role_hit_label(s, hit, role->label);
}

static bool fail_ambiguous(const struct role_search *s, enum role_kind kind, struct tool_error *err)
{
    struct text list = {0}, arguments = {0};
    for (size_t i = 0; i < s->count; i++) {
        char label[ROLE_LABEL_MAX];
        role_hit_label(s, &s->hits[i], label);
        text_add(&list, "%s'%s'", i ? ", " : "", label);
        text_add(&arguments, "%s--%s '%s'", i ? " or " : "", role_names[kind].option, label);
    }
    fail_hint(err, "add %s", arguments.data ? arguments.data : "");
    fail(err, EXIT_CHANNELS, "%s: %zu %s candidates: %s", s->info->path, s->count,
         role_names[kind].option, list.data ? list.data : "");
    text_free(&list);
    text_free(&arguments);
    return false;
}

/* 'R G B A N.X (part "beauty"); Z (part "depth")', as much as fits in a message. */
static void list_channels(const struct exr_info *info, const char *view, struct text *list)
{
    enum { ENOUGH = 600 };
    for (size_t p = 0; p < info->part_count; p++) {
        const struct exr_part *part = &info->parts[p];
        if (*view && part->view && *part->view && strcmp(part->view, view) != 0)
            continue;
        if (list->length)
            text_add(list, ";");
        for (size_t c = 0; c < part->channel_count; c++) {
            if (list->length > ENOUGH) {
                text_add(list, " ... ('vkao inspect' lists all)");
                return;
            }
            text_add(list, "%s%s", list->length ? " " : "", part->channels[c].name);
        }
        if (part->name && *part->name)
            text_add(list, " (part \"%s\")", part->name);
    }
}

/* Of a file that vkao wrote: the name of what it was made of, or NULL. */
static const char *source_of_result(const struct exr_info *info)
{
    const char *source = NULL;
    for (size_t p = 0; p < info->part_count; p++)
        for (size_t i = 0; i < info->parts[p].attribute_count; i++) {
            const struct exr_attribute *a = &info->parts[p].attributes[i];
            if (strcmp(a->name, "vkao/source") == 0 && a->text)
                source = a->text;
        }
    return source;
}

/* Depth is often written as a picture of its own. */
static void hint_at_depth(const struct exr_info *info, struct tool_error *err)
{
    const struct exr_part *part = &info->parts[0];
    const char *source = source_of_result(info);
    bool grey = false;
    if (source) {
        fail_hint(err,
                  "this is a result, which vkao made of '%s': give that; --like takes the settings "
                  "of a result",
                  source);
        return;
    }
    for (size_t i = 0; i < part->channel_count; i++)
        grey |= strcmp(part->channels[i].name, "R") == 0;
    if (info->part_count == 1 && part->channel_count == 1)
        fail_hint(err, "if this channel is depth, say so: --depth %s", part->channels[0].name);
    else if (info->part_count == 1 && grey)
        fail_hint(err, "say which it is: --depth NAME; --depth R if this is a depth pass written "
                       "as a grey image (R = G = B)");
    else
        fail_hint(err, "say which it is: --depth NAME");
}

static bool fail_missing(const struct exr_info *info, const char *view, enum role_kind kind,
                         const char *name, struct tool_error *err)
{
    struct text list = {0};
    list_channels(info, view, &list);
    const char *channels = list.data ? list.data : "none";
    if (name) {
        fail(err, EXIT_CHANNELS, "%s: no channel or layer '%s'%s%s; channels: %s", info->path, name,
             *view ? " in view " : "", view, channels);
        if (role_is_scalar(kind))
            fail_hint(err, "--%s takes a channel, a layer or part/channel",
                      role_names[kind].option);
        else
            fail_hint(err, "--%s takes a layer with three components, %s, or a part with them",
                      role_names[kind].option,
                      kind == ROLE_NORMAL || kind == ROLE_POSITION ? "X Y Z or R G B" : "R G B");
    } else {
        fail(err, EXIT_CHANNELS, "%s: no %s channel found%s%s; channels: %s", info->path,
             role_names[kind].option, *view ? " in view " : "", view, channels);
        if (kind == ROLE_DEPTH)
            hint_at_depth(info, err);
        else
            fail_hint(err, "say which it is: --%s NAME", role_names[kind].option);
    }
    text_free(&list);
    return false;
}

static bool fail_deep(const struct exr_info *info, size_t part, struct tool_error *err)
{
    fail_hint(err, "flatten it first: oiiotool %s --flatten -o flat.exr", info->path);
    return fail(err, EXIT_INPUT, "%s: deep data is not supported (part %zu, %s)", info->path, part,
                info->parts[part].type);
}

/* --- One role --- */

static bool take_labelled(struct role_search *s, const char *name, struct role *role)
{
    for (size_t h = 0; h < s->count; h++) {
        char label[ROLE_LABEL_MAX];
        role_hit_label(s, &s->hits[h], label);
        if (strcmp(label, name) != 0)
            continue;
        take_hit(s, &s->hits[h], NULL, role);
        role->depth_type = DEPTH_POSITION;
        return true;
    }
    return false;
}

/* --depth P: positions, not one of their components, and so is any layer with X, Y and Z. */
static bool names_positions(struct role_search *s, const char *name, struct role *role)
{
    for (size_t i = 0; i < role_table_count; i++) {
        if (role_table[i].kind != ROLE_POSITION)
            continue;
        role_search_row(s, &role_table[i]);
        if (take_labelled(s, name, role))
            return true;
    }
    role_search_named(s, ROLE_POSITION, name);
    enum { XYZ = 0 }; /* the first of role_vector_sets */
    return s->count == 1 && s->hits[0].set == XYZ && take_labelled(s, name, role);
}

static bool resolve_named(struct role_search *s, enum role_kind kind, const char *name,
                          struct role *role, struct tool_error *err)
{
    if (kind == ROLE_DEPTH && names_positions(s, name, role))
        return true;
    role_search_named(s, kind, name);
    if (s->count == 0 && role_is_scalar(kind))
        role_search_only(s, name);
    const bool in_view = s->count > 0;
    if (!in_view && role_is_scalar(kind))
        role_search_in_full(s, name);
    if (s->count == 0)
        return fail_missing(s->info, s->view, kind, name, err);
    if (s->count > 1)
        return fail_ambiguous(s, kind, err);
    /* A row that knows the channel still tells what it measures. */
    const struct role_hit hit = s->hits[0];
    const struct role_row *known = NULL;
    for (size_t i = 0; i < role_table_count && !known; i++) {
        if (role_table[i].kind != kind)
            continue;
        role_search_row(s, &role_table[i]);
        for (size_t h = 0; h < s->count; h++)
            if (s->hits[h].channels[0] == hit.channels[0])
                known = &role_table[i];
    }
    take_hit(s, &hit, known, role);
    role->twin = NULL; /* whoever names one channel means it */
    role->of_another_view = !in_view;
    return true;
}

static bool resolve_found(struct role_search *s, enum role_kind kind, const struct role *depth,
                          struct role *role, struct tool_error *err)
{
    for (size_t i = 0; i < role_table_count; i++) {
        if (role_table[i].kind != kind)
            continue;
        role_search_row(s, &role_table[i]);
        if (s->count == 0)
            continue;
        if (s->count > 1 && kind != ROLE_DEPTH && depth->found)
            prefer_neighbours(s, depth);
        if (s->count > 1 && (kind == ROLE_DEPTH || kind == ROLE_NORMAL))
            return fail_ambiguous(s, kind, err);
        take_hit(s, &s->hits[0], &role_table[i], role);
        return true;
    }
    return true;
}

/* Where all points are, depth is too. */
static bool take_positions(struct roles *roles)
{
    const struct role *position = &roles->kind[ROLE_POSITION];
    struct role *depth = &roles->kind[ROLE_DEPTH];
    if (!position->found)
        return false;
    *depth = *position;
    depth->depth_type = DEPTH_POSITION;
    return true;
}

static bool is_named_depth(const char *path)
{
    const char *name = text_base_name(path);
    return role_name_has(name, "depth") && !role_name_has(name, "depthoffield") &&
           !role_name_has(name, "depth_of_field");
}

/* A picture of its own in a file that is called depth: R of it, if it is grey. */
static bool take_grey_file(struct role_search *s, struct roles *roles)
{
    static const char *const sets[][ROLE_MAX_COMPONENTS] = {{"R"}, {NULL}};
    struct role *depth = &roles->kind[ROLE_DEPTH], *color = &roles->kind[ROLE_COLOR];
    if (!is_named_depth(s->info->path))
        return false;
    s->count = 0;
    for (size_t p = 0; p < s->info->part_count; p++) {
        const struct exr_part *part = &s->info->parts[p];
        for (size_t c = 0; role_part_has_view(part, s->view) && c < part->channel_count; c++) {
            struct role_channel name;
            if (role_channel_read(part, part->channels[c].name, s->view, s->info->part_count > 1,
                                  &name) &&
                name.bare)
                role_search_sets(s, sets, p, &part->channels[c], &name);
        }
    }
    if (s->count != 1)
        return false;
    take_hit(s, &s->hits[0], NULL, depth);
    depth->is_guessed = depth->twin != NULL;
    if (depth->is_guessed && color->channels[0] == depth->channels[0])
        *color = (struct role){0};
    if (!depth->is_guessed)
        *depth = (struct role){0};
    return depth->found;
}

/* In a file of its own a role needs no name: R, G and B of a normal pass are normals. */
static bool resolve_alone(struct role_search *s, enum role_kind kind, struct role *role,
                          struct tool_error *err)
{
    if (!resolve_found(s, kind, &(struct role){0}, role, err) || role->found)
        return role->found;
    s->count = 0;
    for (size_t p = 0; p < s->info->part_count; p++)
        if (role_part_has_view(&s->info->parts[p], s->view))
            role_search_layer(s, kind, p, NULL);
    if (s->count == 0)
        return fail_missing(s->info, s->view, kind, NULL, err);
    if (s->count > 1)
        return fail_ambiguous(s, kind, err);
    take_hit(s, &s->hits[0], NULL, role);
    return true;
}

static bool fail_without_depth(const struct exr_info *info, const char *view,
                               struct tool_error *err)
{
    for (size_t p = 0; p < info->part_count; p++)
        if (info->parts[p].deep)
            return fail_deep(info, p, err);
    return fail_missing(info, view, ROLE_DEPTH, NULL, err);
}

bool roles_resolve(const struct exr_info *info, const struct role_request *request,
                   struct roles *roles, struct tool_error *err)
{
    struct role_search s = {.info = info, .view = request->view ? request->view : ""};
    struct role *depth = &roles->kind[ROLE_DEPTH];
    bool ok = true;
    *roles = (struct roles){0};
    for (int kind = ROLE_DEPTH; kind < ROLE_KINDS; kind++) {
        struct role *role = &roles->kind[kind];
        const char *name = request->name[kind];
        if (kind == ROLE_NORMAL && request->no_normals)
            continue;
        if (name && (kind == ROLE_HOLDOUT || kind == ROLE_NO_CAST) &&
            text_starts_with(name, CRYPTOMATTE_PREFIX)) {
            snprintf(role->label, sizeof role->label, "%s", name);
            continue; /* names of objects, not of channels */
        }
        const bool is_alone = kind < ROLE_FILES && request->file[kind];
        s.info = is_alone ? request->file[kind] : info;
        ok &= name       ? resolve_named(&s, (enum role_kind)kind, name, role, err)
              : is_alone ? resolve_alone(&s, (enum role_kind)kind, role, err)
                         : resolve_found(&s, (enum role_kind)kind, depth, role, err);
    }
    s.info = info;
    if (depth->found && depth->depth_type == DEPTH_POSITION)
        roles->kind[ROLE_POSITION] = *depth; /* those that are named */
    if (ok && !depth->found && !take_positions(roles) && !take_grey_file(&s, roles))
        return fail_without_depth(info, s.view, err);
    return ok;
}

/* --- What was not taken --- */

/* Parts of their own, of a character say, may have a depth of their own. */
static bool is_of_picture(const struct roles *roles, const struct role_search *s, size_t part)
{
    const struct role *color = &roles->kind[ROLE_COLOR];
    return color->found && color->info == s->info && color->part == part;
}

bool roles_other_depth(const struct role_request *request, const struct roles *roles,
                       struct role *other)
{
    const struct role *depth = &roles->kind[ROLE_DEPTH];
    struct role_search s = {.info = depth->info, .view = request->view ? request->view : ""};
    const struct role_row *first = NULL;
    if (request->name[ROLE_DEPTH] || depth->depth_type == DEPTH_POSITION)
        return false;
    for (size_t i = 0; i < role_table_count; i++) {
        const struct role_row *row = &role_table[i];
        if (row->kind != ROLE_DEPTH || !row->is_plain)
            continue;
        role_search_row(&s, row);
        for (size_t h = 0; first && h < s.count; h++)
            if (s.hits[h].part == depth->part || is_of_picture(roles, &s, s.hits[h].part)) {
                take_hit(&s, &s.hits[h], row, other);
                return true;
            }
        if (s.count > 0 && s.hits[0].channels[0] == depth->channels[0])
            first = row;
    }
    return false;
}

struct passing {
    struct role_search search;
    const struct roles *roles;
    role_listener listener;
    void *data;
    const struct exr_channel *told[24];
    size_t count;
};

static bool was_told(const struct passing *p, const struct exr_channel *channel)
{
    for (int kind = ROLE_DEPTH; kind < ROLE_KINDS; kind++)
        for (size_t c = 0; c <= ROLE_MAX_COMPONENTS; c++)
            if (p->roles->kind[kind].channels[c] == channel)
                return true;
    for (size_t i = 0; i < p->count; i++)
        if (p->told[i] == channel)
            return true;
    return false;
}

static void tell(struct passing *p, enum role_kind kind, const struct exr_channel *channel,
                 const char *label, const char *reason)
{
    if (p->count == sizeof p->told / sizeof *p->told || was_told(p, channel))
        return;
    p->told[p->count++] = channel;
    p->listener(p->data, kind, label, reason);
}

/* Those that a row knows, but a better one came before. */
static void tell_later_hits(struct passing *p, enum role_kind kind)
{
    const struct role *taken = &p->roles->kind[kind];
    char reason[ROLE_LABEL_MAX + 32], label[ROLE_LABEL_MAX];
    for (size_t i = 0; i < role_table_count; i++) {
        if (role_table[i].kind != kind)
            continue;
        role_search_row(&p->search, &role_table[i]);
        for (size_t h = 0; h < p->search.count; h++) {
            role_hit_label(&p->search, &p->search.hits[h], label);
            if (taken->found)
                snprintf(reason, sizeof reason, "'%s' comes first", taken->label);
            else
                snprintf(reason, sizeof reason, "there are several");
            tell(p, kind, p->search.hits[h].channels[0], label, reason);
        }
    }
}

/* Why a channel of a part is not used though people see by its name what it is; NULL if they do not
 * or if it is. */
typedef const char *(*reason_finder)(const struct role_search *s, size_t part,
                                     const struct role_channel *name);

static const char *reason_against_depth(const struct role_search *s, size_t part,
                                        const struct role_channel *name)
{
    if (!role_name_fits("Z|depth|distance", name->component) &&
        !role_name_fits("~depth", name->leaf))
        return NULL;
    return s->info->parts[part].deep                             ? "deep data"
           : !role_part_has_view(&s->info->parts[part], s->view) ? "of another view"
           : role_channel_is_never_depth(name)                   ? "no distance by its name"
           : role_channel_is_of_vector(s, part, name)            ? "component of a vector"
                                                                 : "no name for depth";
}

/* Two components of what is called normals: the third cannot be told, as its sign is lost. */
static const char *reason_against_normal(const struct role_search *s, size_t part,
                                         const struct role_channel *name)
{
    const bool is_xyz = role_name_fits("X", name->component);
    if (s->info->parts[part].deep || (!is_xyz && !role_name_fits("R", name->component)) ||
        !(role_name_fits("N|Ns|Nn", name->leaf) || role_name_fits("~normal", name->leaf)) ||
        !role_channel_sibling(s, part, name, is_xyz ? "Y" : "G") ||
        role_channel_sibling(s, part, name, is_xyz ? "Z" : "B"))
        return NULL;
    return "two components: a third is missing";
}

static void tell_by_name(struct passing *p, enum role_kind kind, reason_finder reason_of)
{
    const struct role_search *s = &p->search;
    for (size_t i = 0; i < s->info->part_count; i++) {
        const struct exr_part *part = &s->info->parts[i];
        for (size_t c = 0; c < part->channel_count; c++) {
            struct role_channel name;
            const struct exr_channel *channel = &part->channels[c];
            const bool is_named =
                role_channel_read(part, channel->name, s->view, s->info->part_count > 1, &name);
            const char *reason = is_named ? reason_of(s, i, &name) : NULL;
            if (reason)
                tell(p, kind, channel, channel->name, reason);
        }
    }
}

void roles_passed_over(const struct exr_info *info, const struct role_request *request,
                       const struct roles *roles, role_listener listener, void *data)
{
    struct passing p = {.search = {.info = info, .view = request->view ? request->view : ""},
                        .roles = roles,
                        .listener = listener,
                        .data = data};
    tell_later_hits(&p, ROLE_DEPTH);
    tell_later_hits(&p, ROLE_NORMAL);
    tell_later_hits(&p, ROLE_COLOR);
    tell_by_name(&p, ROLE_DEPTH, reason_against_depth);
    tell_by_name(&p, ROLE_NORMAL, reason_against_normal);
}

/* Words of a layer, which anything but letters and digits ends: rgba_N, N_Beauty. */
static bool is_called_normals(const char *layer)
{
    char word[ROLE_NAME_BYTES];
    size_t length = 0;
    for (const char *c = layer;; c++) {
        if (isalnum((unsigned char)*c)) {
            word[length++] = *c;
            continue;
        }
        word[length] = '\0';
        if (role_name_fits("N|Ns|Nn|Ng|nrm|nrml|nml|norm|norms|normal|normals", word))
            return !role_name_fits("~tangent", layer);
        length = 0;
        if (!*c)
            return false;
    }
}

void roles_list_normals(const struct exr_info *info, const struct role_request *request,
                        struct text *list)
{
    enum { ENOUGH = 4 };
    struct role_search s = {.info = info, .view = request->view ? request->view : ""};
    size_t count = 0;
    for (size_t p = 0; p < info->part_count; p++) {
        const struct exr_part *part = &info->parts[p];
        for (size_t c = 0; count < ENOUGH && c < part->channel_count; c++) {
            struct role_channel name;
            char label[ROLE_LABEL_MAX];
            if (!role_part_has_view(part, s.view) ||
                !role_channel_read(part, part->channels[c].name, s.view, info->part_count > 1,
                                   &name) ||
                !is_called_normals(name.layer))
                continue;
            s.count = 0;
            role_search_sets(&s, role_vector_sets, p, &part->channels[c], &name);
            const bool is_pair = s.count == 0 && reason_against_normal(&s, p, &name);
            if (s.count > 0)
                role_hit_label(&s, &s.hits[0], label);
            else
                snprintf(label, sizeof label, "%s", part->channels[c].name);
            if (s.count > 0 || is_pair)
                text_add(list, "%s'%s'%s", count++ ? ", " : "", label,
                         is_pair ? " (two components: a third is missing)" : "");
        }
    }
}

void roles_list_colors(const struct exr_info *info, const struct role_request *request,
                       struct text *list)
{
    struct role_search s = {.info = info, .view = request->view ? request->view : ""};
    struct role_row any = {.kind = ROLE_COLOR, .layers = "*"};
    memcpy(any.sets, role_color_sets, sizeof any.sets);
    role_search_row(&s, &any);
    for (size_t i = 0; i < s.count; i++) {
        char label[ROLE_LABEL_MAX];
        role_hit_label(&s, &s.hits[i], label);
        text_add(list, "%s'%s'", i ? ", " : "", label);
    }
}
