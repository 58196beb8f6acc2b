/* SPDX-License-Identifier: MIT
 *
 * Channels by what they are called: names taken apart, and those that a row of the table or an
 * option may mean. */
#ifndef VKAO_TOOLS_ROLE_SEARCH_H_
#define VKAO_TOOLS_ROLE_SEARCH_H_

#include "exr_file.h"
#include "roles.h"

#include <stdbool.h>
#include <stddef.h>

enum { ROLE_NAME_BYTES = 256 };

/* A channel's name taken apart: layers 'A.B', component 'Z', without its view. */
struct role_channel {
    char layer[ROLE_NAME_BYTES];
    const char *leaf;      /* last component of layer */
    const char *component; /* points into the channel's own name */
    bool bare;             /* no layer in the channel's name: layer is that of the part */
    /* What all channels of the layer begin with: their names, up to the end of the layer. */
    const char *channel;
    size_t prefix;
};

enum { ROLE_MAX_HITS = 16 };

struct role_hit {
    size_t part;
    char layer[ROLE_NAME_BYTES];
    size_t set;
    const struct exr_channel *channels[ROLE_MAX_COMPONENTS + 1];
    size_t channel_count;
    bool bare;
};

struct role_search {
    const struct exr_info *info;
    const char *view; /* "" = any */
    struct role_hit hits[ROLE_MAX_HITS];
    size_t count;
};

/* Deep parts have no view that could be used. view: "" = any. */
bool role_part_has_view(const struct exr_part *part, const char *view);

/* In single-part stereo files the last but one component is the view (Blender names all views so,
 * OpenEXR leaves out the default one), or the first (Nuke). False if the channel belongs to another
 * view than the wanted one. multi_part: bare channels have the name of their part for a layer. */
bool role_channel_read(const struct exr_part *part, const char *channel, const char *view,
                       bool multi_part, struct role_channel *name);
/* By what it is called: no distance. */
bool role_channel_is_never_depth(const struct role_channel *name);
/* One of X, Y and Z. */
bool role_channel_is_of_vector(const struct role_search *s, size_t part,
                               const struct role_channel *name);
/* That of the same layer with another component, as a row spells it; the same case of letters is
 * preferred. NULL if there is none. */
const struct exr_channel *role_channel_sibling(const struct role_search *s, size_t part_index,
                                               const struct role_channel *name,
                                               const char *component);

/* Words joined by '&', each of them in the name, or not in it with '!' in front. */
bool role_name_has(const char *name, const char *words);
/* Whether name is one of the alternatives, or contains the words behind '~'. */
bool role_name_fits(const char *alternatives, const char *name);

/* Adds a hit if the channel is the first component of a set that is there as a whole. Beyond
 * ROLE_MAX_HITS none is. */
void role_search_sets(struct role_search *s, const char *const sets[][ROLE_MAX_COMPONENTS],
                      size_t part, const struct exr_channel *channel,
                      const struct role_channel *name);
/* The hits are those of the row. */
void role_search_row(struct role_search *s, const struct role_row *row);
/* Adds those of a layer, by its name, that of its part or that of one of its channels; of every
 * layer if wanted is NULL. */
void role_search_layer(struct role_search *s, enum role_kind kind, size_t part, const char *wanted);
/* The hits are those of a channel, a layer, a part or part/one of these. */
void role_search_named(struct role_search *s, enum role_kind kind, const char *name);
/* The hits are those channels that are the only one of a layer or a part of that name, whatever
 * they are called. */
void role_search_only(struct role_search *s, const char *name);
/* Adds channels of other views, by their whole name. */
void role_search_in_full(struct role_search *s, const char *wanted);

/* The name, in the form that options take. */
void role_hit_label(const struct role_search *s, const struct role_hit *hit,
                    char label[ROLE_LABEL_MAX]);

#endif
