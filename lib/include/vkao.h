/* SPDX-License-Identifier: MIT
 *
 * vkao.h - screen-space ambient occlusion recorded into the caller's Vulkan command buffer.
 *
 * The library never creates a device, submits, waits, maps memory or calls a Vulkan function it was not
 * handed. vkao_cmd_* functions allocate nothing. There is no global state: contexts are independent.
 *
 * Ambient occlusion is stored as visibility in [0,1]: 1 = open, 0 = fully occluded. Before the blur it is an
 * estimate that may lie on both sides of that, in ao_noisy and in the ao of frames without BLUR; it is right as a
 * mean. Nothing that vkao writes is NaN or infinite, whatever depth, normals and ao_noisy hold; colours are the
 * caller's, see vkao_composite_mode. Lengths are scene units
 * of the projection matrix unless a name says texels. Matrices are column-major, m[column * 4 + row], as in
 * GLSL. Texel (0,0) is the image's first; NDC (-1,-1) is the corner of that texel in a full-image viewport,
 * as when Vulkan rasterises with a positive viewport height.
 *
 * Synchronization contract, the same for every vkao_cmd_* function:
 *  - Before: images that a stage reads are visible to COMPUTE_SHADER / SHADER_READ in their declared layout;
 *    images that it writes are in VK_IMAGE_LAYOUT_GENERAL and earlier accesses to them have finished.
 *  - After: written images were last touched by COMPUTE_SHADER / SHADER_WRITE, still in GENERAL. The barrier
 *    to your own next use is yours.
 *  - Between vkao calls on one queue the library's own barriers order everything, scratch included, also
 *    across submits. Across queues, a semaphore is yours.
 *  - State left behind: compute pipeline, compute descriptor set 0, push constants. Nothing else changes.
 *  - Record outside a render pass, in any command buffer whose queue family supports compute.
 *
 * Struct rule: set struct_size = sizeof (the *_default() functions do). Bytes beyond the caller's size read
 * as zero, and zero always means the behaviour from before the field existed. A struct larger than the
 * library knows is accepted only if the extra bytes are zero. No struct has implicit padding on 64-bit
 * targets. Enums only grow.
 *
 * On any error nothing has been created or recorded, and *out is NULL.
 */
#ifndef VKAO_H_
#define VKAO_H_

#include <stdint.h>
#include <string.h>
#include <vulkan/vulkan_core.h>

#if defined(_WIN32) && !defined(VKAO_STATIC)
#ifdef VKAO_BUILD
#define VKAO_API __declspec(dllexport)
#else
#define VKAO_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define VKAO_API __attribute__((visibility("default")))
#else
#define VKAO_API
#endif
#ifdef __GNUC__
#define VKAO_MUST_CHECK __attribute__((warn_unused_result))
#else
#define VKAO_MUST_CHECK
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define VKAO_VERSION_MAJOR 0
#define VKAO_VERSION_MINOR 1
#define VKAO_VERSION_PATCH 0
#define VKAO_MIN_API_VERSION VK_API_VERSION_1_1 /* no extension needed */

/* Version of the linked library, packed as VK_MAKE_API_VERSION(0, major, minor, patch). */
VKAO_API uint32_t vkao_version(void);

typedef enum vkao_result {
    VKAO_SUCCESS = 0,
    VKAO_ERROR_INVALID_ARGUMENT = -1, /* caller bug; the log names the field and its value */
    VKAO_ERROR_UNSUPPORTED = -2,      /* device lacks a feature, format or limit; the log says which */
    VKAO_ERROR_OUT_OF_HOST_MEMORY = -3,
    VKAO_ERROR_OUT_OF_DEVICE_MEMORY = -4,
    VKAO_ERROR_VULKAN = -5, /* any other VkResult; the log has its value */
    VKAO_RESULT_MAX_ENUM = 0x7fffffff
} vkao_result;

/* Static English text, never NULL, for unknown values too. */
VKAO_API const char *vkao_result_string(vkao_result result);

typedef enum vkao_log_level {
    VKAO_LOG_DEFAULT = 0, /* in vkao_context_info: VKAO_LOG_WARNING */
    VKAO_LOG_ERROR = 1,   /* a call is about to return an error */
    VKAO_LOG_WARNING = 2, /* the result is right but probably not what was meant */
    VKAO_LOG_INFO = 3,    /* chosen formats, memory sizes; at creation only */
    VKAO_LOG_LEVEL_MAX_ENUM = 0x7fffffff
} vkao_log_level;

/* message: UTF-8, no newline, valid during the call. Runs on the thread that called vkao; must not call vkao. */
typedef void (*vkao_log_fn)(void *user_data, vkao_log_level level, const char *message);

typedef enum vkao_ssao_method {
    /* Points in the full sphere (Mittring 2007). Two forms, see vkao_sphere_form. Needs no normals. */
    VKAO_SSAO_SPHERE = 0,
    /* Cosine-distributed points in the normal-oriented hemisphere (Filion and McNaughton 2008). */
    VKAO_SSAO_HEMISPHERE = 1,
    /* Horizons, true-horizon form (Bavoil et al. 2008). */
    VKAO_SSAO_HBAO = 2,
    /* Cosine-weighted horizons (Jimenez et al. 2016), normalised so that an open wall is exactly 1. */
    VKAO_SSAO_GTAO = 3,
    /* Visibility bitmask (Therrien et al. 2023) with cosine-correct sectors, first hits and thickness: the closest
     * to ray-traced AO for its time. */
    VKAO_SSAO_VBAO = 4,
    /* Cosine-distributed rays marched through the depth image: slow, the yardstick of the others. */
    VKAO_SSAO_RAYMARCH = 5,
    VKAO_SSAO_METHOD_MAX_ENUM = 0x7fffffff
} vkao_ssao_method;

/* --- Context: one per VkDevice --- */

/* Stages that a frame is built for. SSAO and BLUR imply the prepare stage (depth -> view z in scratch).
 * Without BLUR the SSAO stage writes `ao` itself. */
typedef uint32_t vkao_stage_flags;
#define VKAO_STAGE_SSAO 0x1u      /* reads depth, normals;             writes ao_noisy */
#define VKAO_STAGE_BLUR 0x2u      /* reads ao_noisy, depth, normals;   writes ao */
#define VKAO_STAGE_COMPOSITE 0x4u /* reads ao, color, direct;          writes output */
#define VKAO_STAGE_ALL 0x7u

typedef struct vkao_view vkao_view;
typedef struct vkao_ssao_params vkao_ssao_params;
typedef struct vkao_blur_params vkao_blur_params;

/* In what the stages hand each other their results, where the caller has no image for them. The results are the same
 * but for rounding below 1/1000. */
typedef enum vkao_scratch_layout {
    VKAO_SCRATCH_AUTO = 0,    /* BUFFERS on CPUs without half_view_z, else IMAGES */
    VKAO_SCRATCH_IMAGES = 1,  /* caches of GPUs are made for them */
    VKAO_SCRATCH_BUFFERS = 2, /* several texels per invocation; far faster on CPUs. Not with half_view_z */
    VKAO_SCRATCH_LAYOUT_MAX_ENUM = 0x7fffffff
} vkao_scratch_layout;

/* Settings to compile pipelines for specially, loops unrolled and choices made: worth a factor of two on CPUs, little
 * on GPUs. A recording uses them if all of this is the same: of the view the encodings, perspective or orthographic,
 * which depth is far, and whether normal_to_view only turns axes round; of ssao the method, falloff, sphere_form and
 * counts; of blur the radius, whether normal_power is 0, 8 or another, and whether intensity and power are both 1. All
 * other members are free. Frames with images.ao_noisy fit no variant where scratch is in BUFFERS. A recording that fits
 * no variant uses the general pipelines. */
typedef struct vkao_variant {
    uint32_t struct_size;
    VkBool32 half_resolution; /* as in vkao_frame_info */
    VkBool32 bent_normals;    /* VK_TRUE: for frames with images.bent_normals */
    VkFormat staged_ao;       /* images.ao.format of frames with images.ao_image; UNDEFINED = of frames without */
    const vkao_view *view;
    const vkao_ssao_params *ssao;
    const vkao_blur_params *blur; /* NULL = no BLUR */
} vkao_variant;

/* Has to call job(data, i) once for each i < count, in any order and in any threads, and to return when all are done;
 * count may be 0. */
typedef void (*vkao_parallel_fn)(void *user_data, uint32_t count, void (*job)(void *data, uint32_t i), void *data);

/* Pipelines and layouts. Immutable once created; owns no device memory.
 * Thread-safety: any number of threads may use one context at once; destroying it is the exception. */
typedef struct vkao_context vkao_context;

typedef struct vkao_context_info {
    uint32_t struct_size;
    /* Bit (1u << method) per vkao_ssao_method to prepare. 0 = all. Recording another method is an error. */
    uint32_t method_mask;

    /* Handles must outlive the context. The device was created with apiVersion >= VKAO_MIN_API_VERSION. */
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;

    /* Used to look up every Vulkan function; the library links none. Both required. */
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    PFN_vkGetDeviceProcAddr get_device_proc_addr;

    /* Features the device was created with; must include vkao_add_required_features(). Required; read during
     * vkao_context_create only. */
    const VkPhysicalDeviceFeatures *enabled_features;
    /* Host allocations of the library and of the driver on its behalf. NULL = malloc and the driver's default.
     * Copied; its functions and pUserData must stay valid while any object of this context lives. */
    const VkAllocationCallbacks *allocator;
    /* Optional, caller-owned, used during vkao_context_create only. */
    VkPipelineCache pipeline_cache;

    vkao_log_fn log; /* NULL = silent */
    void *log_user_data;
    vkao_log_level log_level; /* most verbose level delivered. Default VKAO_LOG_WARNING */
    /* VK_TRUE: name objects and label stages through VK_EXT_debug_utils, if the instance enabled it. */
    VkBool32 debug_labels;
    /* VK_TRUE: keep view z in 16-bit floats, at half the memory and bandwidth; then 65504 scene units are as far as it
     * sees, and details of less than 1/1000 of their distance get lost. Needs shaderStorageImageExtendedFormats among
     * enabled_features. Default: 32-bit floats */
    VkBool32 half_view_z;
    uint32_t variant_count;
    const vkao_variant *variants; /* variant_count of them, or NULL; read during vkao_context_create only */
    /* VK_TRUE: compile nothing but the variants and COMPOSITE, for the shortest start. Recording SSAO or BLUR with
     * other settings is then an error. */
    VkBool32 variants_only;
    vkao_scratch_layout scratch_layout; /* Default AUTO */
    /* Optional: compiles pipelines side by side during vkao_context_create; log and allocator are then called from its
     * threads. NULL = one after the other. */
    vkao_parallel_fn parallel;
    void *parallel_user_data;
    vkao_stage_flags stage_mask; /* stages that frames may have. 0 = all. Others cost no time here */
    /* VK_TRUE: the device was created with VkPhysicalDevice16BitStorageFeatures.storageBuffer16BitAccess, which cannot
     * be checked here. SSAO in BUFFERS takes a CPU a twentieth less then. Default VK_FALSE */
    VkBool32 storage_16bit;
} vkao_context_info;

/* Sets the members that vkao needs to VK_TRUE, leaves the others alone. Call before vkCreateDevice. */
VKAO_API void vkao_add_required_features(VkPhysicalDeviceFeatures *features);

/* Compiles the pipelines; takes milliseconds to seconds, so call it while loading.
 * Errors: INVALID_ARGUMENT, UNSUPPORTED (feature, API version), OUT_OF_*_MEMORY, VULKAN. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_context_create(const vkao_context_info *info, vkao_context **out);

/* VK_TRUE if recordings with these settings find all their pipelines compiled for them. VK_FALSE too for what is not
 * valid. Thread-safe. */
VKAO_API VkBool32 vkao_context_has_variant(const vkao_context *ctx, const vkao_variant *variant);

/* All frames of the context must be destroyed first. NULL is ignored. Legal after device loss. */
VKAO_API void vkao_context_destroy(vkao_context *ctx);

/* --- Frame: the images that one frame in flight works on --- */

/* A caller-owned image as the library sees it: a 2D view with one mip level and one array layer. Layered or
 * stereo images need one view and one frame per layer. All zero = slot not used. */
typedef struct vkao_image {
    VkImageView view;
    /* Read slots: SHADER_READ_ONLY_OPTIMAL, DEPTH_STENCIL_READ_ONLY_OPTIMAL, DEPTH_READ_ONLY_OPTIMAL family or
     * GENERAL. Written slots: GENERAL. */
    VkImageLayout layout;
    VkFormat format; /* format of the view; UNDEFINED = slot not used */
} vkao_image;

/* Image usage: read slots SAMPLED, written slots STORAGE; ao_noisy and ao both, where one stage of the frame
 * writes them and another reads them. All images have the frame's extent. */
typedef struct vkao_images {
    uint32_t struct_size;
    uint32_t reserved;   /* zero */
    vkao_image depth;    /* depth-aspect view, or a one-component float format: see vkao_depth_encoding */
    vkao_image normals;  /* optional: see vkao_normal_encoding */
    vkao_image ao_noisy; /* R8/R16 unorm, R16/R32 float; unused = scratch. Input when SSAO is not a stage */
    vkao_image ao;       /* as ao_noisy; unused = scratch if COMPOSITE reads it. Input if only COMPOSITE */
    vkao_image color;    /* lit colour or indirect light, any float or unorm format; optional for AO_ONLY */
    vkao_image direct;   /* direct light, required by VKAO_COMPOSITE_INDIRECT only; as color */
    vkao_image output;   /* storage-capable colour format; may be color's image if both are GENERAL */
    /* Mean unoccluded direction, written by BLUR after GTAO, VBAO or RAYMARCH, in the space of the normals and the
     * encoding view.bent_encoding; zero on background, for which octahedral encodings have no code but that of
     * (0,0,1): both components as 0. Input if only COMPOSITE. ao_noisy must then be unused. */
    vkao_image bent_normals;
    vkao_image albedo;   /* diffuse reflectance in rgb, for composite.multi_bounce; as color */
    vkao_image specular; /* indirect specular light in rgb, roughness in alpha, for composite.specular; as color */
    /* Optional: the image behind ao.view, created with TRANSFER_DST too. Where scratch is in BUFFERS and the frame has
     * no ao_noisy and no bent_normals, BLUR then copies rows into it instead of storing texel by texel, which takes a
     * CPU a third of BLUR's time. Ignored elsewhere. Waiting for the stage's shader writes waits for the copy. */
    VkImage ao_image;
    uint32_t ao_mip_level, ao_array_layer; /* of ao.view in ao_image */
} vkao_images;

static inline vkao_images vkao_images_default(void)
{
    vkao_images i;
    memset(&i, 0, sizeof i);
    i.struct_size = (uint32_t)sizeof i;
    return i;
}

/* Descriptor set plus scratch memory. Recording does not modify it.
 * Thread-safety: recording one frame from several threads is fine; update and destroy need exclusive access. */
typedef struct vkao_frame vkao_frame;

typedef struct vkao_frame_info {
    uint32_t struct_size;
    vkao_stage_flags stages;   /* at least one */
    VkExtent2D extent;         /* texels; size of every image, 1..maxImageDimension2D */
    const vkao_images *images; /* read during the call only */
    /* Place scratch here instead of allocating: DEVICE_LOCAL memory satisfying vkao_frame_scratch(), kept until
     * destroy. Frames on one queue may share it, and you may alias it outside vkao recordings. */
    VkDeviceMemory scratch_memory; /* VK_NULL_HANDLE = the library allocates exactly one block */
    VkDeviceSize scratch_offset;   /* bytes; multiple of the queried alignment */
    /* VK_TRUE: SSAO and BLUR run on every second texel of every second row, and BLUR ends with a depth- and
     * normal-aware upsampling: a fourth of the work and of the scratch. Lengths keep their meaning; blur.radius counts
     * half-resolution texels. Needs both stages, and no ao_noisy. view.valid must begin at even texels. */
    VkBool32 half_resolution;
    uint32_t reserved; /* zero */
} vkao_frame_info;

/* Exact device memory for this info: the one allocation that vkao_frame_create would make. size 0 = none.
 * Views may still be null; only stages, extent, formats, used slots and whether there is an ao_image matter. Errors as
 * vkao_frame_create. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_frame_scratch(const vkao_context *ctx, const vkao_frame_info *info,
                                                        VkMemoryRequirements *out);

/* Errors: INVALID_ARGUMENT, UNSUPPORTED (a slot's format, extent over the device's limit), OUT_OF_*_MEMORY,
 * VULKAN. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_frame_create(const vkao_context *ctx, const vkao_frame_info *info,
                                                       vkao_frame **out);

/* Points the frame at other images with the same used slots, formats and extent (rotating or transient images), and an
 * ao_image if there was one.
 * No allocation. The frame must not be in use by a pending command buffer. On error the frame is unchanged. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_frame_update(vkao_frame *frame, const vkao_images *images);

/* The frame must not be in use by a pending command buffer. NULL is ignored. Legal after device loss. */
VKAO_API void vkao_frame_destroy(vkao_frame *frame);

/* --- View: what the images show --- */

typedef enum vkao_depth_encoding {
    VKAO_DEPTH_PROJECTED = 0, /* device depth z/w in [0,1] as rasterised: standard, reversed or infinite far */
    VKAO_DEPTH_VIEW_Z = 1,    /* positive distance along the view axis */
    VKAO_DEPTH_DISTANCE = 2,  /* positive distance from the eye (the Z channel of some ray tracers) */
    VKAO_DEPTH_INVERSE_Z = 3, /* 1 / view z; 0 = infinitely far */
    VKAO_DEPTH_ENCODING_MAX_ENUM = 0x7fffffff
} vkao_depth_encoding;

typedef enum vkao_normal_encoding {
    VKAO_NORMALS_FROM_DEPTH = 0, /* no normals image is read: reconstruct from depth */
    VKAO_NORMALS_XYZ_SNORM = 1,  /* xyz in [-1,1]: snorm or float formats */
    VKAO_NORMALS_XYZ_UNORM = 2,  /* xyz * 0.5 + 0.5 */
    VKAO_NORMALS_OCT_SNORM = 3,  /* octahedral in rg, [-1,1] */
    VKAO_NORMALS_OCT_UNORM = 4,  /* octahedral in rg, * 0.5 + 0.5 */
    VKAO_NORMAL_ENCODING_MAX_ENUM = 0x7fffffff
} vkao_normal_encoding;

/* Which way the camera looks along the view-space z axis. A perspective matrix says so itself; an orthographic
 * one does through its near and far planes, unless they lie equally far on both sides of the eye. */
typedef enum vkao_view_axis {
    VKAO_VIEW_AXIS_FROM_MATRIX = 0,
    VKAO_VIEW_AXIS_NEGATIVE_Z = 1, /* right-handed view space, as OpenGL */
    VKAO_VIEW_AXIS_POSITIVE_Z = 2, /* left-handed view space, as Direct3D */
    VKAO_VIEW_AXIS_MAX_ENUM = 0x7fffffff
} vkao_view_axis;

/* Texels at or beyond the far plane, not in front of the camera, or not finite are background: AO = 1, and
 * they occlude nothing. So are those nearer than 1e-15 or farther than 1e15 scene units. */
struct vkao_view {
    uint32_t struct_size;
    vkao_depth_encoding depth_encoding;
    vkao_normal_encoding normal_encoding;
    vkao_view_axis axis; /* orthographic matrices only; else FROM_MATRIX */
    /* Texels that hold depth and normals; nothing outside is read. 0x0 = the whole image. For dynamic resolution
     * set this alone: viewport and rect follow. */
    VkRect2D valid;
    /* Texels that NDC [-1,1] spans; may reach beyond the image. 0x0 = valid. Set it when the projection belongs
     * to another rectangle than valid: overscan, a cropped data window, one view of an atlas. */
    VkRect2D viewport;
    /* Texels to write, inside valid. 0x0 = valid. Use it to split work; the parts add up to the whole. */
    VkRect2D rect;
    /* View space to Vulkan clip space, unjittered. Perspective or orthographic, off-centre, y-flipped, either
     * hand, reversed or infinite depth are all read off the matrix. Finite, no shear, no rotation; a texel spans
     * 1e-15 to 1e15 scene units, in perspective at distance 1. */
    float projection[16];
    /* Rotation of stored normals into view space, m[column * 3 + row]. Identity if they are view-space. May scale.
     * Normals need not be unit length. One that faces away from the eye is turned round if it is the back of its
     * surface that is seen. If not, as where interpolation over a mesh has carried it past the outline, or if it is
     * shorter than 0.5 or not finite, the one that the neighbours' depths give takes its place. */
    float normal_to_view[9];
    uint32_t reserved; /* zero */
    /* Of images.bent_normals. 0 = as normal_encoding, or XYZ_SNORM if that is FROM_DEPTH. */
    vkao_normal_encoding bent_encoding;
    uint32_t reserved_too; /* zero */
};

static inline vkao_view vkao_view_default(void)
{
    vkao_view v;
    memset(&v, 0, sizeof v);
    v.struct_size = (uint32_t)sizeof v;
    v.normal_to_view[0] = v.normal_to_view[4] = v.normal_to_view[8] = 1.0f;
    return v; /* projection stays zero, which is rejected: the caller must set it */
}

/* --- Stages --- */

/* How an occluder at distance t from the shaded point counts, for reach R. */
typedef enum vkao_falloff {
    VKAO_FALLOFF_SMOOTH = 0,    /* weight 1 - (t/R)^2 */
    VKAO_FALLOFF_THRESHOLD = 1, /* weight 1 up to R, then 0 */
    VKAO_FALLOFF_MAX_ENUM = 0x7fffffff
} vkao_falloff;

typedef enum vkao_sphere_form {
    /* Range-checked and rescaled by the '50 %' rule: visibility = min(1, 2 * (1 - blocked)), so that a wall,
     * which fills half the sphere, is open. */
    VKAO_SPHERE_RESCALED = 0,
    /* The textbook form: blocking factor mean(1 / (1 + dz^2)), dz = blocking_scale * max(0, scene z - point z);
     * visibility = 1 - factor. Greys flat walls and outlines convex edges; ignores falloff and bias. */
    VKAO_SPHERE_LITERAL = 1,
    VKAO_SPHERE_FORM_MAX_ENUM = 0x7fffffff
} vkao_sphere_form;

struct vkao_ssao_params {
    uint32_t struct_size;
    vkao_ssao_method method;
    vkao_falloff falloff;
    vkao_sphere_form sphere_form; /* SPHERE only */
    /* [1,1024] points per texel of SPHERE and HEMISPHERE, rays of RAYMARCH. HEMISPHERE and SPHERE_RESCALED take
     * pairs: an odd count becomes one more. Default 16 */
    uint32_t sample_count;
    uint32_t noise_index;  /* any; 0 = the static pattern; a frame counter if something temporal follows */
    float radius;          /* (0,inf) scene units that an occluder reaches. Default 0.5 */
    /* [0,1] fraction of radius by which the scene must stand in front of a point to block it; hides acne from
     * coarse depth or interpolated normals. Default 0.005 */
    float bias;
    float blocking_scale; /* (0,inf) 1 / scene units; the constant 50 of SPHERE_LITERAL. Default 50 */
    uint32_t reserved;    /* zero */
    uint32_t slice_count; /* [1,64] HBAO, GTAO, VBAO: directions, each marched to both sides; 0 = 1. Default 1 */
    uint32_t step_count;  /* [1,256] samples on each side of a slice, or on each ray of RAYMARCH; 0 = 8. Default 8 */
    /* [0,8] VBAO, RAYMARCH: how thick the scene is behind what is seen, relative to the measured default, which grows
     * from .19 radius by .42 of the distance to the side, and with THRESHOLD 1.1 times that. 0 = 1. Default 1 */
    float thickness;
    uint32_t reserved_too; /* zero */
};

static inline vkao_ssao_params vkao_ssao_params_default(void)
{
    vkao_ssao_params p;
    memset(&p, 0, sizeof p);
    p.struct_size = (uint32_t)sizeof p;
    p.method = VKAO_SSAO_VBAO;
    p.sample_count = 16;
    p.radius = 0.5f;
    p.bias = 0.005f;
    p.blocking_scale = 50.0f;
    p.slice_count = 1;
    p.step_count = 8;
    p.thickness = 1.0f;
    return p;
}

/* Separable cross-bilateral blur, two dispatches: a mean whose taps count less the further they lie off the surface
 * that the local depth slope continues, and the more their normal turns away. The noise of SSAO repeats after 4 texels,
 * that of 4 or more slices after 2: a radius of 2, or 1 with so many slices, leaves none of it where a surface goes on.
 * It also ends the chain: intensity and power belong here because they are right only after the noise is gone.
 * radius 0 applies intensity and power alone. */
struct vkao_blur_params {
    uint32_t struct_size;
    uint32_t radius; /* [0,16] texels on each side; those near the ends count less. Default 3 */
    /* [0,10000] edge stopping: a tap whose view z is off the continued slope by more than 1 / sharpness of its own
     * distance counts nothing. 0 = depth is ignored. Default 200 */
    float sharpness;
    /* [0,128] edge stopping by normals: weight max(0, n.n')^normal_power; 0 = ignore them, as without a normals
     * image. 8 is a good value, and on CPUs doubles the time of the blur. Default 0 */
    float normal_power;
    float intensity;   /* [0,8] scale of occlusion: 1 - intensity * (1 - visibility), clamped. Default 1: physical */
    float power;       /* (0,8] exponent on visibility, after intensity. Default 1: physical */
    uint32_t reserved; /* zero */
};

static inline vkao_blur_params vkao_blur_params_default(void)
{
    vkao_blur_params p;
    memset(&p, 0, sizeof p);
    p.struct_size = (uint32_t)sizeof p;
    p.radius = 3;
    p.sharpness = 200.0f;
    p.intensity = 1.0f;
    p.power = 1.0f;
    return p;
}

/* Alpha is color's in MULTIPLY and INDIRECT. What light is multiplied by is always finite and in [0,1], also where
 * albedo, roughness or normals are not; a NaN or infinity of color, direct or specular itself passes through, as does
 * a sum beyond the range of output's format. */
typedef enum vkao_composite_mode {
    VKAO_COMPOSITE_MULTIPLY = 0, /* rgb = color * mix(tint, 1, a), a = mix(1, ao, strength) */
    VKAO_COMPOSITE_INDIRECT = 1, /* rgb = direct + color * mix(tint, 1, a): AO on indirect light only */
    VKAO_COMPOSITE_AO_ONLY = 2,  /* rgb = mix(tint, 1, a), alpha 1; color is not read */
    /* To look at what the stages saw, at their own resolution; alpha 1. For frames with SSAO. */
    VKAO_COMPOSITE_NOISY_AO = 3,     /* before the blur; needs BLUR at full resolution, and no bent normals */
    VKAO_COMPOSITE_NORMALS = 4,      /* view space, * 0.5 + 0.5, blue towards the eye */
    VKAO_COMPOSITE_BENT_NORMALS = 5, /* the same of images.bent_normals */
    VKAO_COMPOSITE_VIEW_Z = 6,       /* view z / debug_distance */
    VKAO_COMPOSITE_MODE_MAX_ENUM = 0x7fffffff
} vkao_composite_mode;

/* Occlusion of indirect specular light: images.specular is added times it. */
typedef enum vkao_specular {
    VKAO_SPECULAR_NONE = 0,      /* images.specular is not read */
    VKAO_SPECULAR_FROM_AO = 1,   /* from AO and roughness (Lagarde and de Rousiers 2014) */
    VKAO_SPECULAR_FROM_BENT = 2, /* from the cone around the bent normal (Oat and Sander 2007) */
    VKAO_SPECULAR_MAX_ENUM = 0x7fffffff
} vkao_specular;

typedef struct vkao_composite_params {
    uint32_t struct_size;
    vkao_composite_mode mode;
    float strength;    /* [0,1] 0 = as if open everywhere. Default 1 */
    float tint[3];     /* [0,1] linear colour of full occlusion. Default black */
    uint32_t reserved; /* zero */
    /* VK_TRUE: brighten AO per channel by the light that bounces on, from images.albedo (Jimenez et al. 2016). */
    VkBool32 multi_bounce;
    vkao_specular specular; /* MULTIPLY and INDIRECT; needs images.specular and images.normals. Default NONE */
    float debug_distance;   /* (0,inf) scene units that VIEW_Z shows as 1; 0 = 100. Default 100 */
} vkao_composite_params;

static inline vkao_composite_params vkao_composite_params_default(void)
{
    vkao_composite_params p;
    memset(&p, 0, sizeof p);
    p.struct_size = (uint32_t)sizeof p;
    p.strength = 1.0f;
    p.debug_distance = 100.0f;
    return p;
}

/* --- Presets: one setting for every scene --- */

typedef enum vkao_quality {
    VKAO_QUALITY_FAST = 0, /* half resolution */
    VKAO_QUALITY_DEFAULT = 1,
    VKAO_QUALITY_HIGH = 2,
    VKAO_QUALITY_BEST = 3,
    VKAO_QUALITY_MAX_ENUM = 0x7fffffff
} vkao_quality;

/* Sets what a preset decides and leaves the rest (radius, falloff, intensity ...) alone: half_resolution of the frame;
 * method, slice_count, step_count, bias, thickness; blur radius, sharpness, normal_power. Each pointer may be NULL; the
 * structs come from the *_default() functions. Errors: INVALID_ARGUMENT for an unknown quality. */
VKAO_API vkao_result vkao_preset(vkao_quality quality, vkao_frame_info *frame, vkao_ssao_params *ssao,
                                 vkao_blur_params *blur);

/* Record one stage. The frame must have been built for it. Arguments are read before the call returns.
 * Errors: INVALID_ARGUMENT; then nothing was recorded.
 *
 * prepare reads depth over view->valid and writes the frame's scratch. It comes first each time a frame with SSAO
 * or BLUR is recorded; the other stages then see the scratch until other work reuses its memory. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_cmd_prepare(const vkao_frame *frame, VkCommandBuffer cmd,
                                                      const vkao_view *view);
VKAO_API VKAO_MUST_CHECK vkao_result vkao_cmd_ssao(const vkao_frame *frame, VkCommandBuffer cmd,
                                                   const vkao_view *view, const vkao_ssao_params *params);
/* Reads ao_noisy up to params->radius texels around view->rect, inside view->valid: record ssao there first. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_cmd_blur(const vkao_frame *frame, VkCommandBuffer cmd,
                                                   const vkao_view *view, const vkao_blur_params *params);
VKAO_API VKAO_MUST_CHECK vkao_result vkao_cmd_composite(const vkao_frame *frame, VkCommandBuffer cmd,
                                                        const vkao_view *view, const vkao_composite_params *params);

/* Record every stage that the frame was built for, in order. Params of absent stages must be NULL. All arguments
 * are checked before the first command is recorded. ao and output are written in view->rect only; ao_noisy also
 * in the border that the blur reads. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_cmd_all(const vkao_frame *frame, VkCommandBuffer cmd,
                                                  const vkao_view *view, const vkao_ssao_params *ssao,
                                                  const vkao_blur_params *blur,
                                                  const vkao_composite_params *composite);

#ifdef __cplusplus
}
#endif
#endif /* VKAO_H_ */
