/* SPDX-License-Identifier: MIT
 *
 * All that decides the AO of a G-buffer, in the library's own structs; its members by the library's
 * table of parameters, so that command line, panel, record and man page need no other. */
#ifndef VKAO_TOOLS_SETTING_H_
#define VKAO_TOOLS_SETTING_H_

#include "text.h"
#include "vkao.h"

/* --- What images show --- */

/* vkao_view and what images hold. */
struct ao_view {
    vkao_depth_encoding depth_encoding;
    vkao_normal_encoding normal_encoding, bent_encoding;
    vkao_view_axis axis;
    VkRect2D valid, viewport, rect;
    float projection[16], normal_to_view[9];
};

struct ao_view ao_view_default(void);
vkao_view ao_library_view(const struct ao_view *view);
/* The members of an effect that images decide: encodings and projection. */
void ao_view_describe(const struct ao_view *view, vkao_effect_info *effect);

/* --- What is wanted of them --- */

struct setting {
    vkao_effect_info effect;
    vkao_params params;
};

struct setting setting_default(void);
/* What vkao_preset decides; the rest stays. */
void setting_apply_preset(struct setting *setting, vkao_quality quality);

enum { QUALITY_COUNT = VKAO_QUALITY_BEST + 1 };
extern const char *const quality_names[QUALITY_COUNT];

const char *method_name(vkao_ssao_method method);
/* Whether VKAO_STAGE_BLUR can write bent normals after it. */
bool method_has_bent(vkao_ssao_method method);

/* Of the library: "0.2.0". */
enum { VERSION_BYTES = 16 };
void version_string(char version[VERSION_BYTES]);

/* --- One parameter --- */

/* NULL if there is none of that name, or at that offset in struct setting. */
const vkao_parameter *parameter_named(const char *name);
const vkao_parameter *parameter_at(size_t offset);
size_t parameter_offset(const vkao_parameter *parameter);

static inline void *parameter_of(struct setting *setting, const vkao_parameter *parameter)
{
    return (char *)setting + parameter_offset(parameter);
}
static inline const void *parameter_of_const(const struct setting *setting,
                                             const vkao_parameter *parameter)
{
    return (const char *)setting + parameter_offset(parameter);
}
size_t parameter_bytes(const vkao_parameter *parameter);
bool parameter_equals(const vkao_parameter *parameter, const struct setting *a,
                      const struct setting *b);
void parameter_copy(const vkao_parameter *parameter, struct setting *to,
                    const struct setting *from);
/* Whether it is what ao_view_describe sets. */
bool parameter_is_of_images(const vkao_parameter *parameter);

/* What people may ask for: the range of the table, without a zero that stands for the default. */
struct parameter_range {
    double low, high; /* high: INFINITY if only finite numbers end it */
    bool low_is_excluded;
};
struct parameter_range parameter_range(const vkao_parameter *parameter);

/* A number in as few digits as bring it back, a word, 'R,G,B'; switches are 0 and 1. */
void parameter_add_value(struct text *text, const vkao_parameter *parameter,
                         const struct setting *setting);
/* As few digits as text_to_number and a cast make the same float of. */
void text_add_float(struct text *text, float value);

#endif
