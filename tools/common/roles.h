/* SPDX-License-Identifier: MIT
 *
 * Which channels are depth, normals and colour: found by the names that renderers use.
 * roles_table.c is that knowledge; one row adds a renderer. */
#ifndef VKAO_TOOLS_ROLES_H_
#define VKAO_TOOLS_ROLES_H_

#include "error.h"
#include "exr_file.h"
#include "text.h"

#include <stdbool.h>
#include <stddef.h>

enum role_kind {
    ROLE_DEPTH,
    ROLE_NORMAL,
    ROLE_COLOR,
    ROLE_POSITION,
    ROLE_AO,
    /* No renderer has a name for these: they are there if the request names them. */
    ROLE_THICKNESS,
    ROLE_BACK_DEPTH,
    ROLE_LAYER2,
    ROLE_ROUGHNESS,
    ROLE_HOLDOUT,
    ROLE_NO_CAST,
    ROLE_INDIRECT,
    ROLE_ALBEDO,
    ROLE_SPECULAR,
    ROLE_KINDS
};
/* What people are told, what JSON has, and the option without its dashes. */
struct role_name {
    const char *said, *key, *option;
};
extern const struct role_name role_names[ROLE_KINDS];
/* Depth, normals and colour may each lie in a file of its own. */
enum { ROLE_FILES = ROLE_COLOR + 1 };
/* One number per texel. */
static inline bool role_is_scalar(enum role_kind kind)
{
    return kind == ROLE_DEPTH || (kind >= ROLE_THICKNESS && kind < ROLE_INDIRECT);
}

/* What a depth value measures. */
enum depth_type {
    DEPTH_AUTO,        /* nothing known: planar */
    DEPTH_PLANAR,      /* distance along the view axis */
    DEPTH_RADIAL,      /* distance from the eye */
    DEPTH_RADIAL_NEAR, /* distance along the ray from where it crosses the near plane (Mitsuba) */
    DEPTH_INVERSE,     /* 1 / planar, 0 = infinitely far (Nuke) */
    DEPTH_DEVICE,      /* what a rasteriser's depth buffer holds, in [0,1] */
    DEPTH_NORMALIZED,  /* planar, moved and scaled into [0,1] */
    DEPTH_POSITION     /* none: positions, three numbers per texel, from which planar depth comes */
};

enum normal_space { NORMAL_SPACE_AUTO, NORMAL_SPACE_WORLD, NORMAL_SPACE_CAMERA };

enum {
    ROLE_MAX_SETS = 7,       /* spellings of the components in one row */
    ROLE_MAX_COMPONENTS = 3, /* alpha comes on top */
    ROLE_LABEL_MAX = 512
};

/* Where a row with bare channels (no layer) holds. */
enum role_place { ROLE_ANYWHERE, ROLE_SINGLE_PART, ROLE_MULTI_PART };

/* One way to name a role. Rows of one kind are tried in order; the first that fits wins. */
struct role_row {
    enum role_kind kind;
    /* Last component of the layer, alternatives separated by '|', case ignored. NULL: no layer.
     * "*": any layer.
     * '~' in front: the layer contains all of the words, which '&' joins, or not those with '!'.
     * '=' in front: one name, and its case counts. */
    const char *layers;
    /* That before it, likewise: 'N' of N.world. NULL: any. */
    const char *outer;
    /* Spellings of the components, case ignored; all of one set must be there. '|' separates
     * alternatives; '~' in front: the component contains the word. */
    const char *sets[ROLE_MAX_SETS][ROLE_MAX_COMPONENTS];
    enum role_place place;
    /* Only in parts with this channel, or in files with an attribute that starts so; NULL = no
     * condition. */
    const char *companion, *attribute;
    enum depth_type depth_type;
    enum normal_space normal_space;
    bool is_plain; /* a name of the depth itself, as good as those of other rows like it */
    bool is_mixed; /* components beside it measure other things: not a picture in colours */
};

extern const struct role_row role_table[];
extern const size_t role_table_count;
/* Components of what an option names. */
extern const char *const role_scalar_sets[ROLE_MAX_SETS][ROLE_MAX_COMPONENTS];
extern const char *const role_vector_sets[ROLE_MAX_SETS][ROLE_MAX_COMPONENTS];
extern const char *const role_color_sets[ROLE_MAX_SETS][ROLE_MAX_COMPONENTS];
/* Layers that are never depth, whatever their channels are called. Lower case. */
extern const char *const role_never_depth[];
extern const size_t role_never_depth_count;

/* The label of bare channels. */
#define ROLE_NO_LAYER "(no layer)"

/* A role as found. Pointers lead into the exr_info. */
struct role {
    bool found;
    const struct exr_info *info; /* the file it is in */
    size_t part;
    bool of_another_view; /* a name given in full is believed */
    const struct exr_channel
        *channels[ROLE_MAX_COMPONENTS + 1]; /* the last: alpha of colour, or NULL */
    size_t channel_count;                   /* without alpha */
    const struct exr_channel *twin;         /* G of R that nobody named, or NULL */
    bool is_guessed;                        /* by the name of the file, if the twin is alike */
    enum depth_type depth_type;             /* as the name implies, or AUTO */
    enum normal_space normal_space;         /* likewise */
    bool follows_positions;     /* normals that are in the space of the positions beside them */
    char label[ROLE_LABEL_MAX]; /* the name, in the form that --depth, --normal and --color take */
};

struct roles {
    struct role kind[ROLE_KINDS];
};

struct role_request {
    const char *name[ROLE_KINDS]; /* channel, layer or part/channel; NULL = find it */
    const char *view;             /* NULL or "" in files without views */
    bool no_normals;              /* --normal none */
    /* Where the role is, if not in the file that is resolved. What lies in a file of its own is
     * found there by any name, if only one thing can be meant. */
    const struct exr_info *file[ROLE_FILES];
};

/* Views of a file in its order: of a part's multiView attribute, or of its parts. */
size_t roles_view_count(const struct exr_info *info);
const char *roles_view_name(const struct exr_info *info, size_t index);

/* Every role on its own: one that fails leaves the others as they are found. Where there is no
 * depth, positions take its place, as DEPTH_POSITION. Fails without either or with several equally
 * good hits; other roles may stay unfound, unless the request names them. Errors: EXIT_CHANNELS;
 * EXIT_INPUT if all there is is deep data. */
bool roles_resolve(const struct exr_info *info, const struct role_request *request,
                   struct roles *roles, struct tool_error *err);

/* Another depth of the part or of the part of the colour, whose name is as good as that of the one
 * that was taken, unless the request names it: *other is filled if true. */
bool roles_other_depth(const struct role_request *request, const struct roles *roles,
                       struct role *other);

/* Tells of channels that might be taken for depth, normals or colour and were not, and why; label
 * is in the form that the options take. At most some dozen. */
typedef void (*role_listener)(void *data, enum role_kind kind, const char *label,
                              const char *reason);
void roles_passed_over(const struct exr_info *info, const struct role_request *request,
                       const struct roles *roles, role_listener listener, void *data);
/* "'rgba_N', 'N.X'": what might be normals by its name, with the components of some, or with two.
 * At most a few. */
void roles_list_normals(const struct exr_info *info, const struct role_request *request,
                        struct text *list);
/* "'diffuse', 'specular'": whatever has three components of a colour. */
void roles_list_colors(const struct exr_info *info, const struct role_request *request,
                       struct text *list);

#endif
