/* SPDX-License-Identifier: MIT
 *
 * Passes as data. A row says what a pass is made of, what it reads and writes, and over which
 * texels it runs. A program is a list of rows that were compiled for the settings of an effect;
 * descriptor layouts, pipelines, lifetimes of scratch, barriers and checks of the caller's images
 * derive from it. */
#ifndef VKAO_PASSES_H_
#define VKAO_PASSES_H_

#include "context.h"

#include "params.h"

/* The caller's images: resource, member of vkao_images, kind of format. AO_NOISY and AO are scratch
 * where the caller gives none. */
#define VKAO_SLOTS(X)                                                                              \
    X(DEPTH, depth, DEPTH)                                                                         \
    X(NORMALS, normals, NORMALS)                                                                   \
    X(AO_NOISY, ao_noisy, AO)                                                                      \
    X(AO, ao, AO)                                                                                  \
    X(COLOR, color, COLOR)                                                                         \
    X(DIRECT, direct, COLOR)                                                                       \
    X(OUTPUT, output, COLOR)                                                                       \
    X(BENT_NORMALS, bent_normals, NORMALS)                                                         \
    X(ALBEDO, albedo, COLOR)                                                                       \
    X(SPECULAR, specular, SPECULAR)                                                                \
    X(THICKNESS, thickness, DEPTH)                                                                 \
    X(SECOND_DEPTH, second_depth, DEPTH)

#define VKAO_SLOT_RESOURCE(NAME, member, kind) VKAO_RESOURCE_##NAME,
/* What passes read and write. */
enum vkao_resource {
    VKAO_SLOTS(VKAO_SLOT_RESOURCE) VKAO_SLOT_COUNT,
    /* Scratch images. */
    VKAO_RESOURCE_VIEW_Z = VKAO_SLOT_COUNT,
    VKAO_RESOURCE_SECOND_Z,   /* view z of the second layer */
    VKAO_RESOURCE_CODES,      /* AO that SSAO hands to the blur, in place of AO_NOISY */
    VKAO_RESOURCE_BENT_CODES, /* the same of bent normals */
    VKAO_RESOURCE_HALFWAY,    /* AO between the two directions of the blur */
    VKAO_RESOURCE_BLURRED,    /* at half resolution, for upsampling */
    VKAO_RESOURCE_BREAKS_X,   /* words of where depth breaks along rows, and along columns */
    VKAO_RESOURCE_BREAKS_Y,
    VKAO_IMAGE_COUNT,
    /* Parts of the scratch buffer: the constants, and those of the CPU's passes (cpu/cpu.h). */
    VKAO_RESOURCE_CONSTANTS = VKAO_IMAGE_COUNT,
    VKAO_RESOURCE_CPU,
    VKAO_RESOURCE_COUNT = VKAO_RESOURCE_CPU + 9,
    VKAO_RESOURCE_SAMPLER = VKAO_RESOURCE_COUNT /* in the layouts themselves */
};

#define VKAO_BIT(resource) (1u << (resource))

#define VKAO_CODES_FORMAT VK_FORMAT_R8_UNORM /* of VKAO_RESOURCE_CODES */
#define VKAO_BENT_CODES_FORMAT VK_FORMAT_R8G8B8A8_UNORM

/* A binding of a shader. */
struct vkao_use {
    uint32_t binding; /* VKAO_BINDING_*; 0 ends the list, as every pass has the constants there */
    enum vkao_resource resource;
    bool writes;
    VkFormat texels; /* of a part of the buffer as a texel buffer; UNDEFINED = storage buffer */
};
#define VKAO_READS(name, what)                                                                     \
    {                                                                                              \
        VKAO_BINDING_##name, VKAO_RESOURCE_##what, false, VK_FORMAT_UNDEFINED                      \
    }
#define VKAO_WRITES(name, what)                                                                    \
    {                                                                                              \
        VKAO_BINDING_##name, VKAO_RESOURCE_##what, true, VK_FORMAT_UNDEFINED                       \
    }

/* Over which texels a pass runs. */
enum vkao_area {
    VKAO_AREA_WHOLE,       /* all of the grid, and the border around it */
    VKAO_AREA_VALID,       /* those that hold depth, and the border around them */
    VKAO_AREA_AROUND,      /* what the blur reads for the rect */
    VKAO_AREA_ABOVE_BELOW, /* what its second direction reads */
    VKAO_AREA_RECT,        /* the rect, on the grid of the stages */
    VKAO_AREA_IMAGE_RECT   /* on the image's grid */
};

enum { VKAO_MOST_USES = 12, VKAO_MOST_PASSES = 16, VKAO_MOST_FORMS = 4 };

/* Bits of a form's index. */
enum { VKAO_FORM_TONED = 1, VKAO_FORM_COPIED = 2 };

struct vkao_recording;
struct vkao_pipelines;

struct vkao_pass {
    const char *name;  /* of its objects: "vkao blur x" */
    const char *label; /* the stage that debuggers and marks see */
    vkao_stage_flags stage;
    const uint32_t *code;
    size_t code_bytes;
    struct vkao_use uses[VKAO_MOST_USES + 1];
    enum vkao_area area;
    VkExtent2D texels; /* of an invocation */
    VkExtent2D group;  /* invocations of a workgroup */
    bool on_rows;      /* invocations begin at multiples of texels.height, as of texels.width */
    bool vertical;     /* VKAO_SETTING_VERTICAL */
    /* it and the next one run in turns: what either touches lives as long as both, and so on */
    bool with_next;
    uint32_t forms; /* 1, or the 2 or 4 with VKAO_FORM_* */
    /* Records it. NULL: one dispatch over the area. */
    void (*record)(const struct vkao_recording *recording, uint32_t pass);
};
#define VKAO_CODE(words) .code = words, .code_bytes = sizeof words
/* View z, which is sampled. */
#define VKAO_READS_VIEW_Z VKAO_READS(VIEW_Z, VIEW_Z), VKAO_READS(NEAREST, SAMPLER)
#define VKAO_ONE_TEXEL .texels = {1, 1}, .group = {VKAO_GROUP_WIDTH, VKAO_GROUP_HEIGHT}

/* A row, compiled. */
struct vkao_step {
    const struct vkao_pass *row;
    /* the row's, with resources that the effect puts in their place */
    struct vkao_use uses[VKAO_MOST_USES + 1];
    uint32_t use_count;
    struct vkao_pipelines *pipelines; /* see pipelines.h */
};

struct vkao_program {
    const vkao_context *ctx;
    vkao_effect_info settings; /* checked */
    bool is_cpu, is_packed;    /* of the CPU's passes; AO goes through the buffer */
    bool has_codes;            /* of an image: AO_NOISY is CODES */
    uint32_t constants[VKAO_SETTING_COUNT];
    uint32_t count;
    struct vkao_step steps[VKAO_MOST_PASSES];
    /* VKAO_BIT of the resources that may be; for others of the rows there are stand-ins */
    uint32_t read, written;
};

/* Those of an effect, and PREPARE if others make AO. */
vkao_stage_flags vkao_stages_of(const vkao_effect_info *effect);
bool vkao_makes_ao(const vkao_effect_info *effect);
/* Has view z the thickness of what is seen in its last bits? */
bool vkao_has_thickness(const vkao_effect_info *effect);

/* Adds a row, yet to be compiled. */
void vkao_program_add(struct vkao_program *program, const struct vkao_pass *row);
/* Is it more than a stand-in? */
bool vkao_use_is_touched(const struct vkao_program *program, const struct vkao_use *use);
/* Does any pass read or write the resource? */
bool vkao_program_reads(const struct vkao_program *program, enum vkao_resource resource);
bool vkao_program_writes(const struct vkao_program *program, enum vkao_resource resource);
/* The first and the last pass that touch it, first > last if there is none. */
void vkao_program_lifetime(const struct vkao_program *program, enum vkao_resource resource,
                           uint32_t *first, uint32_t *last);

/* How a shader sees a use. */
VkDescriptorType vkao_use_type(const struct vkao_use *use);

#endif
