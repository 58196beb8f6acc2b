/* SPDX-License-Identifier: MIT
 *
 * vkao.h - screen-space ambient occlusion recorded into the caller's Vulkan command buffer.
 *
 * Three objects. A vkao_context holds what is known of a device. A vkao_effect is compiled for
 * settings that select code. A vkao_frame holds the images and the scratch memory of an effect.
 * Recording takes a frame, a view and a vkao_params, which holds all that may change from one
 * recording to the next.
 *
 * The library never creates a device, submits, waits, maps memory or calls a Vulkan function it was
 * not handed. vkao_cmd_* functions allocate nothing, but where they compile on a CPU, see
 * vkao_cmd_record. There is no global state: contexts are independent.
 *
 * Ambient occlusion is stored as visibility in [0,1]: 1 = open, 0 = fully occluded. Before the blur
 * it is an estimate that may lie on both sides of that, in ao_noisy and in the ao of effects
 * without BLUR; it is right as a mean, and UNORM formats clamp it to [0,1]. Nothing that vkao
 * writes is NaN or infinite, whatever depth, normals and ao_noisy hold; colours are the caller's,
 * see vkao_composite_mode. Lengths are scene units of the projection matrix unless a name says
 * texels. Matrices are column-major, m[column * 4 + row], as in GLSL. Texel (0,0) is the image's
 * first; NDC (-1,-1) is the corner of that texel in a full-image viewport, as when Vulkan
 * rasterises with a positive viewport height. An engine with a negative viewport height negates row
 * 1 of the matrix: m[1], m[5], m[9], m[13].
 *
 * Synchronization contract, the same for every vkao_cmd_* function:
 *  - Before: images that a stage reads are visible to COMPUTE_SHADER / SHADER_READ in their
 *    declared layout. The external dependency of the depth pass does it for depth and normals:
 *    srcStageMask LATE_FRAGMENT_TESTS | COLOR_ATTACHMENT_OUTPUT, srcAccessMask
 *    DEPTH_STENCIL_ATTACHMENT_WRITE | COLOR_ATTACHMENT_WRITE, dstStageMask COMPUTE_SHADER,
 *    dstAccessMask SHADER_READ.
 *  - Before: images that a stage writes are in VK_IMAGE_LAYOUT_GENERAL, and earlier accesses to
 *    them have finished before COMPUTE_SHADER and TRANSFER: the barrier has dstStageMask
 *    COMPUTE_SHADER | TRANSFER and dstAccessMask SHADER_WRITE | TRANSFER_WRITE, for output in
 *    color's image SHADER_READ as well. The other two masks are those of what the image was last
 *    used for:
 *        last use                         srcStageMask             srcAccessMask
 *        read by a shader                 the shader's             0
 *        written by a shader, or by vkao  the shader's             SHADER_WRITE
 *        copied from                      TRANSFER                 0
 *        copied to, or cleared            TRANSFER                 TRANSFER_WRITE
 *        drawn to                         COLOR_ATTACHMENT_OUTPUT  COLOR_ATTACHMENT_WRITE
 *        none                             TOP_OF_PIPE              0
 *    oldLayout may be UNDEFINED if texels outside view.rect need not be kept. AO that a fragment
 *    shader has read in the frame before, and that is made anew:
 *        const VkImageMemoryBarrier anew = {
 *            VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, NULL,
 *            0, VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
 *            VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL,
 *            VK_QUEUE_FAMILY_IGNORED, VK_QUEUE_FAMILY_IGNORED,
 *            ao_image, {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
 *        vkCmdPipelineBarrier(
 *            cmd, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
 *            VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
 *            0, 0, NULL, 0, NULL, 1, &anew);
 *  - After: written images were last touched by COMPUTE_SHADER / SHADER_WRITE, still in GENERAL.
 *    The barrier to your own next use is yours. A copy that the library made counts as such a
 *    write.
 *  - After: images that were read are still being read by COMPUTE_SHADER. Whoever writes them next
 *    waits: the next frame's depth pass needs COMPUTE_SHADER in srcStageMask of its first external
 *    dependency, with dstStageMask EARLY_FRAGMENT_TESTS | COLOR_ATTACHMENT_OUTPUT, srcAccessMask 0,
 *    and for the change of layout dstAccessMask DEPTH_STENCIL_ATTACHMENT_WRITE |
 *    COLOR_ATTACHMENT_WRITE.
 *  - Between vkao calls on one queue the library's own barriers order everything, scratch included,
 *    also across submits. Across queues, a semaphore is yours, and across families the transfer of
 *    your images. What the other queue did has finished before the stages in which the semaphore is
 *    waited for: these are srcStageMask then, with srcAccessMask 0.
 *  - State left behind: compute pipeline, compute descriptor set 0, push constants. Nothing else
 *    changes.
 *  - Record outside a render pass, in any command buffer whose queue family supports compute.
 *
 * Struct rule: set struct_size = sizeof (the *_default() functions do; other languages call the
 * exported *_init(), which write no more bytes than they are given). A smaller struct of an
 * earlier 0.2 is accepted: its missing bytes read as zero, and zero always means the behaviour from
 * before the field existed. A larger struct is accepted only if the bytes that the library does not
 * know are zero. A size that no version can have is refused and nothing is read beyond it; so is a
 * context info that is too short for its log, without a word. No struct has implicit padding on
 * 64-bit targets. Enums only grow.
 *
 * On any error nothing has been created or recorded, and *out is NULL. Each is logged, naming the
 * argument or member, but where there is no log: if ctx, effect or frame is NULL, or the context
 * info, or that is too short; and by vkao_preset.
 */
#ifndef VKAO_H_
#define VKAO_H_

#include <stdint.h>
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

/* NAME_init: the default of each member that lies within size bytes, sizeof of the caller's struct,
 * to which it sets struct_size; what is unknown to the library is zero. NULL is ignored.
 * NAME_default: the same, inline, so that programs keep working with a library whose structs have
 * grown. */
#define VKAO_DEFAULT(name)                                                                         \
    VKAO_API void name##_init(name *out, uint32_t size);                                           \
    static inline name name##_default(void)                                                        \
    {                                                                                              \
        name out;                                                                                  \
        name##_init(&out, sizeof out);                                                             \
        return out;                                                                                \
    }

#ifdef __cplusplus
extern "C" {
#endif

#define VKAO_VERSION_MAJOR 0
#define VKAO_VERSION_MINOR 2
#define VKAO_VERSION_PATCH 0
#define VKAO_MIN_API_VERSION VK_API_VERSION_1_1 /* no extension needed */

/* Version of the linked library, packed as VK_MAKE_API_VERSION(0, major, minor, patch). */
VKAO_API uint32_t vkao_version(void);

typedef enum vkao_result {
    VKAO_SUCCESS = 0,
    VKAO_ERROR_INVALID_ARGUMENT = -1, /* caller bug; the log names the field and its value */
    /* device lacks a feature, format or limit; the log says which */
    VKAO_ERROR_UNSUPPORTED = -2,
    VKAO_ERROR_OUT_OF_HOST_MEMORY = -3,
    VKAO_ERROR_OUT_OF_DEVICE_MEMORY = -4,
    VKAO_ERROR_VULKAN = -1000, /* any other VkResult: this plus it. So is every value below */
    VKAO_RESULT_MAX_ENUM = 0x7fffffff
} vkao_result;

/* Static English text, never NULL, for unknown values too. */
VKAO_API const char *vkao_result_string(vkao_result result);
/* The VkResult that a Vulkan call failed with. VK_SUCCESS if the error did not come from Vulkan. */
VKAO_API VkResult vkao_vk_result(vkao_result result);

typedef enum vkao_log_level {
    VKAO_LOG_DEFAULT = 0, /* in vkao_context_info: VKAO_LOG_WARNING */
    VKAO_LOG_ERROR = 1,   /* a call is about to return an error */
    VKAO_LOG_WARNING = 2, /* the result is right but probably not what was meant */
    VKAO_LOG_INFO = 3,    /* scratch memory that a frame allocates; at creation only */
    VKAO_LOG_LEVEL_MAX_ENUM = 0x7fffffff
} vkao_log_level;

/* message: UTF-8, no newline, valid during the call. Runs on the thread that called vkao; must not
 * call vkao. */
typedef void (*vkao_log_fn)(void *user_data, vkao_log_level level, const char *message);

typedef enum vkao_ssao_method {
    /* Points in the full sphere (Mittring 2007). Two forms, see vkao_sphere_form. Needs no
     * normals. */
    VKAO_SSAO_SPHERE = 0,
    /* Cosine-distributed points in the normal-oriented hemisphere (Filion and McNaughton 2008).
     * Those that fall beside the image count as open: with a radius as wide as what the image shows
     * AO gets lighter, and near 1 with twice that, where horizons stay dark. */
    VKAO_SSAO_HEMISPHERE = 1,
    /* Horizons, true-horizon form (Bavoil et al. 2008). */
    VKAO_SSAO_HBAO = 2,
    /* Cosine-weighted horizons (Jimenez et al. 2016), normalised so that an open wall is exactly
     * 1. */
    VKAO_SSAO_GTAO = 3,
    /* Visibility bitmask (Therrien et al. 2023) with cosine-correct sectors, first hits and
     * thickness: the closest to ray-traced AO for its time. */
    VKAO_SSAO_VBAO = 4,
    /* Cosine-distributed rays marched through the depth image: slow, the yardstick of the
     * others. */
    VKAO_SSAO_RAYMARCH = 5,
    VKAO_SSAO_METHOD_MAX_ENUM = 0x7fffffff
} vkao_ssao_method;

/* --- Context: what is known of a VkDevice --- */

/* Thread-safety: any number of threads may use one context at once; destroying it is the
 * exception. */
typedef struct vkao_context vkao_context;

/* Called while a stage is being recorded, where it begins and where it ends: to write timestamps,
 * for example. name: "prepare", "ssao", "blur", "upsample" or "composite". Must not call vkao. */
typedef void (*vkao_mark_fn)(void *user_data, VkCommandBuffer cmd, const char *name,
                             VkBool32 begins);

typedef struct vkao_context_info {
    uint32_t struct_size;
    vkao_log_level log_level; /* most verbose level delivered. Default VKAO_LOG_WARNING */

    /* Handles must outlive the context. Instance and device were created for apiVersion >=
     * VKAO_MIN_API_VERSION. */
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;

    /* Used to look up every Vulkan function; the library links none. Both required. */
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    PFN_vkGetDeviceProcAddr get_device_proc_addr;

    /* Features that the device was created with, and the chain behind them as vkCreateDevice got
     * it; must include vkao_add_required_features(). Required; read during vkao_context_create
     * only. A chain that has VkPhysicalDevice16BitStorageFeatures or
     * VkPhysicalDeviceVulkan11Features with storageBuffer16BitAccess makes SSAO a twentieth faster
     * on CPUs. */
    const VkPhysicalDeviceFeatures2 *enabled_features;
    /* Host allocations of the library and of the driver on its behalf. NULL = malloc and the
     * driver's default. Copied; its functions and pUserData must stay valid while any object of
     * this context lives. */
    const VkAllocationCallbacks *allocator;

    vkao_log_fn log; /* NULL = silent */
    void *log_user_data;
    vkao_mark_fn mark; /* NULL = none */
    void *mark_user_data;
    /* VK_TRUE: name objects and label stages through VK_EXT_debug_utils, if the instance enabled
     * it. */
    VkBool32 debug_labels;
    uint32_t padding; /* zero */
} vkao_context_info;

VKAO_DEFAULT(vkao_context_info)

/* Sets the members that vkao needs to VK_TRUE, leaves the others alone. NULL is ignored. Call
 * before vkCreateDevice. */
VKAO_API void vkao_add_required_features(VkPhysicalDeviceFeatures *features);

/* Compiles nothing, allocates no device memory. Errors: INVALID_ARGUMENT, UNSUPPORTED,
 * OUT_OF_HOST_MEMORY. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_context_create(const vkao_context_info *info,
                                                         vkao_context **out);

/* All effects and frames of the context must be destroyed first; if not, nothing happens but an
 * error in the log. NULL is ignored. Legal after device loss. */
VKAO_API void vkao_context_destroy(vkao_context *ctx);

/* --- Effect: settings that select code, compiled --- */

typedef uint32_t vkao_stage_flags;
/* What they read and write of vkao_images; settings say which of it there is. */
#define VKAO_STAGE_SSAO 0x1u /* reads depth, normals, thickness, second_depth; writes ao_noisy */
#define VKAO_STAGE_BLUR 0x2u /* reads ao_noisy, depth, normals; writes ao, bent_normals */
/* reads ao, color, direct, albedo, specular, normals, bent_normals, and ao_noisy for the mode that
 * shows it; writes output */
#define VKAO_STAGE_COMPOSITE 0x4u
#define VKAO_STAGE_ALL 0x7u
/* For vkao_cmd_stage only: effects with SSAO or BLUR have it. Depth -> view z in scratch. */
#define VKAO_STAGE_PREPARE 0x8u

typedef enum vkao_depth_encoding {
    /* Device depth z/w in [0,1] as rasterised with the view's own matrix: standard, reversed or
     * infinite far. Exactly 1, or 0 if it is reversed, is background, the other the near plane; for
     * a range of depth see vkao_view.projection. Depth of an oblique near plane is of another
     * matrix, which nothing can tell by looking: give VIEW_Z instead. */
    VKAO_DEPTH_PROJECTED = 0,
    VKAO_DEPTH_VIEW_Z = 1, /* positive distance along the view axis */
    /* positive distance from the eye (the Z channel of some ray tracers) */
    VKAO_DEPTH_DISTANCE = 2,
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

typedef enum vkao_projection {
    VKAO_PROJECTION_PERSPECTIVE = 0,
    VKAO_PROJECTION_ORTHOGRAPHIC = 1,
    VKAO_PROJECTION_MAX_ENUM = 0x7fffffff
} vkao_projection;

/* How an occluder at distance t from the shaded point counts, for reach R. */
typedef enum vkao_falloff {
    VKAO_FALLOFF_SMOOTH = 0,    /* weight 1 - (t/R)^2 */
    VKAO_FALLOFF_THRESHOLD = 1, /* weight 1 up to R, then 0 */
    /* SPHERE and HEMISPHERE look at points within R, but at what hides these from the eye, which
     * may be farther away: by a difference in depth of d > R it counts q^2 (3 - 2 q), q = R/d. What
     * is seen beside things in front of it is darkened a little far beyond R. */
    VKAO_FALLOFF_MAX_ENUM = 0x7fffffff
} vkao_falloff;

/* What VBAO and RAYMARCH know of how thick a texel's surface is, along the view axis. */
typedef enum vkao_thickness_input {
    VKAO_THICKNESS_AS_SEEN = 0,    /* nothing: guessed, see params.thickness */
    VKAO_THICKNESS_GIVEN = 1,      /* images.thickness has it, in scene units */
    VKAO_THICKNESS_BACK_DEPTH = 2, /* images.thickness has where it ends, encoded as depth is */
    VKAO_THICKNESS_MAX_ENUM = 0x7fffffff
} vkao_thickness_input;

typedef enum vkao_sphere_form {
    /* Range-checked and rescaled by the '50 %' rule: visibility = min(1, 2 * (1 - blocked)), so
     * that a wall, which fills half the sphere, is open. */
    VKAO_SPHERE_RESCALED = 0,
    /* The textbook form: blocking factor mean(1 / (1 + dz^2)), dz = blocking_scale * max(0, scene z
     * - point z); visibility = 1 - factor. Greys flat walls and outlines convex edges; ignores
     * falloff and bias. */
    VKAO_SPHERE_LITERAL = 1,
    VKAO_SPHERE_FORM_MAX_ENUM = 0x7fffffff
} vkao_sphere_form;

/* Alpha is color's in MULTIPLY and INDIRECT. What light is multiplied by is always finite and in
 * [0,1], also where albedo, roughness or normals are not; a NaN or infinity of color, direct or
 * specular itself passes through, as does a sum beyond the range of output's format. */
typedef enum vkao_composite_mode {
    VKAO_COMPOSITE_MULTIPLY = 0, /* rgb = color * mix(tint, 1, a), a = mix(1, ao, strength) */
    /* rgb = direct + color * mix(tint, 1, a): AO on indirect light only */
    VKAO_COMPOSITE_INDIRECT = 1,
    VKAO_COMPOSITE_AO_ONLY = 2, /* rgb = mix(tint, 1, a), alpha 1; color is not read */
    /* To look at what the stages saw, at their own resolution; alpha 1. For effects with SSAO. */
    /* before the blur; needs BLUR at full resolution, and no bent normals */
    VKAO_COMPOSITE_NOISY_AO = 3,
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

/* Has to call job(data, i) once for each i < count, in any order and in any threads, and to return
 * when all are done; count may be 0. */
typedef void (*vkao_parallel_fn)(void *user_data, uint32_t count,
                                 void (*job)(void *data, uint32_t i), void *data);

typedef struct vkao_effect_info {
    uint32_t struct_size;
    /* at least one. Default SSAO and BLUR. Without BLUR, SSAO writes `ao` itself */
    vkao_stage_flags stages;
    /* VK_TRUE: SSAO and BLUR run on every second texel of every second row, and BLUR ends with a
     * depth- and normal-aware upsampling: a fourth of the work and of the scratch. Lengths keep
     * their meaning; blur_radius counts half-resolution texels. Needs both stages, and no noisy_ao.
     * view.valid must begin at even texels. */
    VkBool32 half_resolution;

    /* --- What the images hold --- */
    vkao_depth_encoding depth_encoding;
    /* Bits that a PROJECTED depth had before it was copied into an image of more: 16 or 24, fixed
     * point; 32, float. 0 = as the format of images.depth says. Too many let walls occlude
     * themselves by the steps of the depth. */
    uint32_t depth_bits;
    vkao_projection projection; /* of the views to come */
    vkao_normal_encoding normal_encoding;
    /* Of images.bent_normals. 0 = as normal_encoding, or XYZ_SNORM if that is FROM_DEPTH. */
    vkao_normal_encoding bent_encoding;
    VkFormat ao_format; /* of images.ao, where it is written. UNDEFINED = R8_UNORM */
    /* VK_TRUE: BLUR writes images.bent_normals. GTAO, VBAO, RAYMARCH; needs both stages */
    VkBool32 bent_normals;
    /* VK_TRUE: SSAO leaves what BLUR reads in images.ao_noisy. Needs both stages */
    VkBool32 noisy_ao;

    /* --- SSAO --- */
    vkao_ssao_method method; /* Default VBAO */
    vkao_falloff falloff;
    vkao_sphere_form sphere_form; /* SPHERE only */
    /* [0,1024] points per texel of SPHERE and HEMISPHERE, rays of RAYMARCH; 0 = 16. HEMISPHERE and
     * SPHERE_RESCALED take pairs: an odd count becomes one more. Default 16 */
    uint32_t sample_count;
    /* [0,64] HBAO, GTAO, VBAO: directions, each marched to both sides; 0 = 1. Default 1 */
    uint32_t slice_count;
    /* [0,256] samples on each side of a slice, or on each ray of RAYMARCH; 0 = 9. Default 9 */
    uint32_t step_count;
    /* VBAO, RAYMARCH: with true thickness light passes behind what is thin and not through what is
     * thick. It then has no cap, and RAYMARCH does not guess. Default AS_SEEN */
    vkao_thickness_input thickness_input;
    /* VK_TRUE: images.second_depth has what lies behind the first layer, and hides too. VBAO,
     * RAYMARCH */
    VkBool32 second_layer;

    /* --- Blur. Separable, cross-bilateral: a mean whose taps count less the further they lie off
     * the surface that the local depth slope continues, and the more their normal turns away. The
     * noise of SSAO repeats after 4 texels along a row, in other directions in each row; that of 4
     * or more slices after 2, in rows and columns. A radius of 2, or 1 with so many slices, leaves
     * none of it where a surface goes on. On GPUs one of up to 3 takes one dispatch, a larger one
     * two. The larger, the longer drivers in software compile at the first use: seconds at 16. It
     * ends the chain, as intensity and power are right only after the noise is gone. --- */
    /* [0,16] texels on each side; those near the ends count less. 0: intensity and power alone.
     * Default 3 */
    uint32_t blur_radius;
    /* [0,128] edge stopping by normals: weight max(0, n.n')^blur_normal_power; 0 = ignore them, as
     * without a normals image. 8 is a good value, and on CPUs the blur takes twice as long.
     * Default 0 */
    float blur_normal_power;

    /* --- Composite --- */
    vkao_composite_mode composite_mode;
    /* VK_TRUE: brighten AO per channel by the light that bounces on, from images.albedo (Jimenez et
     * al. 2016). */
    VkBool32 multi_bounce;
    /* MULTIPLY and INDIRECT; needs images.specular and images.normals. Default NONE */
    vkao_specular specular;

    /* --- Compilation; read during vkao_effect_create only --- */
    VkPipelineCache pipeline_cache; /* optional, the caller's */
    /* Optional: compiles passes side by side; log and allocator are then called from its threads.
     * NULL = one after the other. */
    vkao_parallel_fn parallel;
    void *parallel_user_data;
} vkao_effect_info;

VKAO_DEFAULT(vkao_effect_info)

/* Immutable once created; owns no device memory. Thread-safety: any number of threads may create
 * effects and use one at once; destroying it is the exception. */
typedef struct vkao_effect vkao_effect;

/* Compiles the passes of exactly these settings, counts known and choices made. Passes that a
 * living effect of the context has alike are shared with it, and not looked for in pipeline_cache.
 * Takes milliseconds to seconds, so call it while loading or in a thread. Errors:
 * INVALID_ARGUMENT, UNSUPPORTED, OUT_OF_*_MEMORY, VULKAN. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_effect_create(const vkao_context *ctx,
                                                        const vkao_effect_info *info,
                                                        vkao_effect **out);

/* What the effect was compiled for, with every 0 that stands for a default replaced by it. The
 * members for compilation are zero. Writes the members that lie within size bytes, sizeof *out;
 * without an effect all are zero but struct_size. */
VKAO_API void vkao_effect_settings(const vkao_effect *effect, vkao_effect_info *out, uint32_t size);

/* All frames of the effect must be destroyed first; if not, nothing happens but an error in the
 * log. NULL is ignored. Legal after device loss. */
VKAO_API void vkao_effect_destroy(vkao_effect *effect);

/* --- Frame: the images that one frame in flight works on --- */

/* A caller-owned image as the library sees it: a 2D view with one mip level, one array layer and
 * one sample, of any level and layer of its image. Layered or stereo images need one view and one
 * frame per layer. Multisampled depth is resolved first: sample 0, MIN or MAX, never the average,
 * which is the depth of nothing. sRGB images are written through a UNORM view, for which the image
 * needs MUTABLE_FORMAT. Usage has SAMPLED where it is read and STORAGE where it is written, which
 * vkao cannot see: validation layers do. All zero = slot not used; one that is given and that SSAO
 * would use by other settings is a warning when the frame is created. */
typedef struct vkao_image {
    VkImageView view;
    /* Read slots: SHADER_READ_ONLY_OPTIMAL, DEPTH_STENCIL_READ_ONLY_OPTIMAL,
     * DEPTH_READ_ONLY_OPTIMAL family or GENERAL. Written slots: GENERAL. */
    VkImageLayout layout;
    VkFormat format; /* format of the view; UNDEFINED = slot not used */
    /* Optional, of `ao` only: the image behind the view, if the view is of mip level 0 and array
     * layer 0 and usage has TRANSFER_DST. The library then copies rows into it where that is
     * faster: a CPU saves a tenth of BLUR's time, and a sixth at half resolution. Waiting for the
     * stage's shader writes waits for the copies too. Leave it out for views of other levels and
     * layers. Validation layers whose messages of type PERFORMANCE are heard say of each copy that
     * GENERAL is not the best layout to copy to. That makes no difference to a CPU, and on GPUs
     * nothing is copied. */
    VkImage image;
} vkao_image;

/* Image usage: read slots SAMPLED, written slots STORAGE; ao_noisy, ao and bent_normals both, where
 * one stage of the effect writes them and another reads them. All images have the frame's extent,
 * which vkao cannot see either, and of smaller ones validation layers may say nothing: a resize
 * needs a new frame. */
typedef struct vkao_images {
    uint32_t struct_size;
    uint32_t padding; /* zero */
    /* depth-aspect view, or a one-component float format: see vkao_depth_encoding */
    vkao_image depth;
    /* optional: see vkao_normal_encoding, whose components and sign the format has to have. It is
     * not sRGB, which is decoded as colour is */
    vkao_image normals;
    /* R8/R16 unorm, R16/R32 float. Input of BLUR without SSAO; see effect.noisy_ao. A texel that is
     * not finite makes itself and its row within blur_radius open, and so lighter what is around */
    vkao_image ao_noisy;
    /* as ao_noisy; unused = scratch if COMPOSITE reads it. Input if only COMPOSITE */
    vkao_image ao;
    /* lit colour or indirect light, float, UNORM, SNORM or sRGB; MULTIPLY and INDIRECT */
    vkao_image color;
    vkao_image direct; /* direct light, INDIRECT only; as color */
    /* storage-capable colour format; may be color's image if both are GENERAL */
    vkao_image output;
    /* Mean unoccluded direction in the space of the normals, of length 1: see effect.bent_normals;
     * of a format that can hold effect.bent_encoding, by default the normals' or XYZ_SNORM.
     * Half floats may be cut off by the driver, which leaves .9996 of it in the mean. Background is
     * the zero vector, which is stored as xyz 0 (UNORM .5). Octahedral codes have none: there it is
     * (0,0), the code of +z. Input if only COMPOSITE. */
    vkao_image bent_normals;
    vkao_image albedo; /* diffuse reflectance in rgb, for multi_bounce; as color */
    /* indirect specular light in rgb, roughness in alpha, for effect.specular; as color, of a
     * format with alpha */
    vkao_image specular;
    /* For effect.thickness_input, format as depth. What is not above 0, no number, or not behind
     * depth is unknown, and taken to be 1.5 radii, as is what is thicker. params.thickness scales
     * it. */
    vkao_image thickness;
    /* For effect.second_layer, encoding and format as depth: of each texel the front of what lies
     * next behind depth; background where there is nothing. */
    vkao_image second_depth;
} vkao_images;

VKAO_DEFAULT(vkao_images)

/* Descriptor sets plus scratch memory. Recording does not modify it. Thread-safety: recording one
 * frame from several threads is fine; update and destroy need exclusive access. */
typedef struct vkao_frame vkao_frame;

typedef struct vkao_frame_info {
    uint32_t struct_size;
    uint32_t padding; /* zero */
    /* texels; size of every image, at least 1, at most 65,535 and maxImageDimension2D; 8 columns
     * and 2 rows less than the latter where scratch is images, which have a border: on a GPU, and
     * on a CPU where a buffer would have more bytes than maxStorageBufferRange, or more texels than
     * maxTexelBufferElements */
    VkExtent2D extent;
    const vkao_images *images; /* read during the call only */
    /* Place scratch here instead of allocating: DEVICE_LOCAL memory satisfying
     * vkao_frame_scratch(), kept until destroy. Frames on one queue may share it, and you may alias
     * it outside vkao recordings. */
    VkDeviceMemory scratch_memory; /* VK_NULL_HANDLE = the library allocates exactly one block */
    VkDeviceSize scratch_offset;   /* bytes; multiple of the queried alignment; 0 without memory */
} vkao_frame_info;

VKAO_DEFAULT(vkao_frame_info)

/* Exact device memory for this info: the one allocation that vkao_frame_create would make. Views
 * may still be null; only extent, formats, used slots and whether ao has an image matter. Errors as
 * vkao_frame_create. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_frame_scratch(const vkao_effect *effect,
                                                        const vkao_frame_info *info,
                                                        VkMemoryRequirements *out);

/* Errors: INVALID_ARGUMENT, UNSUPPORTED (a slot's format, extent over the device's limit),
 * OUT_OF_*_MEMORY, VULKAN. On a CPU it may compile: passes that use images, for a frame so large
 * that buffers cannot hold it, and what ends with AO that is not copied, for the first frame of an
 * effect without images.ao.image. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_frame_create(const vkao_effect *effect,
                                                       const vkao_frame_info *info,
                                                       vkao_frame **out);

/* Points the frame at other images with the same used slots, formats and extent (rotating or
 * transient images). No allocation. The frame must not be in use by a pending command buffer, and
 * what it was recorded into before has to be recorded anew. On error the frame is unchanged. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_frame_update(vkao_frame *frame,
                                                       const vkao_images *images);

/* The frame must not be in use by a pending command buffer, nor what it was recorded into submitted
 * any more: wait for its fence first. NULL is ignored. Legal after device loss. */
VKAO_API void vkao_frame_destroy(vkao_frame *frame);

/* --- Recording: what may change each time --- */

/* Which way the camera looks along the view-space z axis. A perspective matrix says so itself. In
 * an orthographic one depths 0 and 1 are taken to be the near and far planes, and the plane that
 * lies farther from the eye to be in front of it. Name the axis if the near plane is behind the
 * eye, as a wrong guess is not noticed, or if a range of depth is folded into the matrix. */
typedef enum vkao_view_axis {
    VKAO_VIEW_AXIS_FROM_MATRIX = 0,
    VKAO_VIEW_AXIS_NEGATIVE_Z = 1, /* right-handed view space, as OpenGL */
    VKAO_VIEW_AXIS_POSITIVE_Z = 2, /* left-handed view space, as Direct3D */
    VKAO_VIEW_AXIS_MAX_ENUM = 0x7fffffff
} vkao_view_axis;

/* What the images show. Texels at or beyond the far plane, not in front of the camera, or not
 * finite are background: AO = 1, and they occlude nothing. So are those nearer than 1e-15 or
 * farther than 1e15 scene units. */
typedef struct vkao_view {
    uint32_t struct_size;
    vkao_view_axis axis; /* of orthographic matrices; must not contradict others */
    /* Texels that hold depth and normals; nothing outside is read. All 0 = the whole image. For
     * dynamic resolution set this alone: viewport and rect follow. */
    VkRect2D valid;
    /* Texels that NDC [-1,1] spans; may reach beyond the image, or lie beside it. All 0 = valid.
     * Set it when the projection belongs to another rectangle than valid: overscan, a cropped data
     * window, one view of an atlas. */
    VkRect2D viewport;
    /* Texels to write, inside valid. All 0 = valid. Use it to split work; the parts add up to the
     * whole. */
    VkRect2D rect;
    /* View space to Vulkan clip space: the matrix that depth was drawn with, a jitter for temporal
     * filters included. Perspective or orthographic as effect.projection says; off-centre,
     * y-flipped, either hand, reversed or infinite depth are all read off the matrix. Finite, no
     * shear, no rotation; a texel spans 1e-15 to 1e15 scene units, in perspective at distance 1.
     *
     * What is done behind the matrix is folded into it. A jitter by (x, y) in NDC, of which a texel
     * is 2 / viewport.extent: add x * m[11] to m[8] and y * m[11] to m[9] in perspective, x * m[15]
     * to m[12] and y * m[15] to m[13] in orthographic views. A viewport whose minDepth and maxDepth
     * are not 0 and 1, in either order:
     *     m[10] = (maxDepth - minDepth) * m[10] + minDepth * m[11];
     *     m[14] = (maxDepth - minDepth) * m[14] + minDepth * m[15];
     * So is a matrix for OpenGL's z from -w to w, which cannot be told from others, with .5 and 1.
     * PROJECTED depth of exactly 0 or 1 is then no plane, but on the far side it is background
     * still, as are depths beyond that at infinity. The far end of the range is background where
     * the far plane is infinite, and a surface at the far plane where it is not: clear depth to 0
     * or 1. An orthographic view wants its axis. */
    float projection[16];
    /* Rotation of stored normals into view space, m[column * 3 + row]. Identity if they are
     * view-space. May scale; all 0 = none is trusted: depth gives all, more plainly than with
     * FROM_DEPTH, and bent_normals are 0. Normals need not be unit length. One that faces away from
     * the eye is turned round if it is the back of its surface that is seen. If not, as where
     * interpolation over a mesh has carried it past the outline, or if it is shorter than 0.5 or
     * not finite, the one that the neighbours' depths give takes its place. */
    float normal_to_view[9];
    uint32_t padding; /* zero */
} vkao_view;

/* projection stays zero, which is refused: the caller must set it. */
VKAO_DEFAULT(vkao_view)

typedef struct vkao_params {
    uint32_t struct_size;
    /* any; 0 = the static pattern; a frame counter if something temporal follows. The pattern lies
     * still in the image, wherever valid is: views of an atlas differ by noise, and so do one image
     * by a matrix with y up and by one with y down */
    uint32_t noise_index;
    float radius; /* (0,inf) scene units that an occluder reaches. Default 0.5 */
    /* [0,1] fraction of radius by which the scene must stand in front of a point to block it; hides
     * acne from coarse depth or interpolated normals, and the blur takes it for what depth may be
     * off by. Default 0.005 */
    float bias;
    /* [0,8] VBAO, RAYMARCH: how thick the scene is behind what is seen, relative to the measured
     * default. VBAO: .67 + 2.24 / step_count of its width in the depth image, .92 with nine steps,
     * and a twentieth as much of what it is longer, at most .38 radius and .79 of the distance to
     * the side; where something nearer hides a side, that counts as long as the other, and the
     * width half as much again. RAYMARCH: .19 radius and .42 of that distance. With THRESHOLD 1.1
     * times these. 0 = 1. Default 1 */
    float thickness;
    /* (0,inf) 1 / scene units; the constant 50 of SPHERE_LITERAL. Default 50 */
    float blocking_scale;
    /* [0,10000] edge stopping of the blur: a tap whose view z is off the continued slope by more
     * than 1 / sharpness of its own distance counts nothing. Where no normals are compared, one
     * from whose own slope the texel is off counts less, down to .33: off by the texel's slope, .3
     * texels and 3 times bias and the precision of depth. Where that leaves less than .45 of the
     * window, as on a bar or a leaf, up to .15 of all visibility around is mixed in. 0 = depth is
     * ignored. Default 200; the presets HIGH and BEST set 400 */
    float sharpness;
    /* [0,8] BLUR: scale of occlusion: 1 - intensity * (1 - visibility), clamped. Default 1:
     * physical */
    float intensity;
    float power;    /* (0,8] BLUR: exponent on visibility, after intensity. Default 1: physical */
    float strength; /* [0,1] COMPOSITE: 0 = as if open everywhere. Default 1 */
    float tint[3];  /* [0,1] COMPOSITE: linear colour of full occlusion. Default black */
    /* [0,inf) scene units that COMPOSITE_VIEW_Z shows as 1; 0 = 100. Default 100 */
    float debug_distance;
} vkao_params;

VKAO_DEFAULT(vkao_params)

/* Record every stage of the frame's effect, in order. All arguments are checked before the first
 * command is recorded, and read before the call returns. ao and output are written in view->rect
 * only; ao_noisy also in the border that the blur reads. Compiles nothing, but on a CPU the last
 * pass once more, for an effect's first recording whose intensity or power is not 1, of frames with
 * images.ao.image and of those without. Errors: INVALID_ARGUMENT, and where it compiles
 * OUT_OF_*_MEMORY and VULKAN; then nothing was recorded. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_cmd_record(const vkao_frame *frame, VkCommandBuffer cmd,
                                                     const vkao_view *view,
                                                     const vkao_params *params);

/* Record the named stages alone, which the effect must have; VKAO_STAGE_PREPARE is one of them
 * here. It reads depth over view->valid, for VBAO and where thickness is given the radius as well,
 * and writes the frame's scratch, and comes first each time. Stages share scratch memory: record
 * them in order, each once, over the same rect; to split a frame into rects, record all stages of
 * one before the next. Errors, and what compiles on a CPU: as vkao_cmd_record. */
VKAO_API VKAO_MUST_CHECK vkao_result vkao_cmd_stage(const vkao_frame *frame, VkCommandBuffer cmd,
                                                    vkao_stage_flags stages, const vkao_view *view,
                                                    const vkao_params *params);

/* --- Presets: one setting for every scene --- */

typedef enum vkao_quality {
    VKAO_QUALITY_FAST = 0, /* half resolution */
    VKAO_QUALITY_DEFAULT = 1,
    VKAO_QUALITY_HIGH = 2,
    VKAO_QUALITY_BEST = 3,
    VKAO_QUALITY_MAX_ENUM = 0x7fffffff
} vkao_quality;

/* Sets what a preset decides and leaves the rest (radius, falloff, intensity ...) alone:
 * half_resolution, method, slice_count, step_count, blur_radius and blur_normal_power of the
 * effect; bias, thickness and sharpness of the params. Each pointer may be NULL; the structs come
 * from the *_default() functions. Errors: INVALID_ARGUMENT for an unknown quality. */
VKAO_API vkao_result vkao_preset(vkao_quality quality, vkao_effect_info *effect,
                                 vkao_params *params);

/* --- Tables: what can be set. The library's own checks and defaults read them; so can panels and
 * command lines --- */

typedef enum vkao_parameter_type {
    VKAO_PARAMETER_FLOAT = 0,
    VKAO_PARAMETER_UINT = 1,
    VKAO_PARAMETER_BOOL = 2,   /* VkBool32 */
    VKAO_PARAMETER_CHOICE = 3, /* an enum */
    VKAO_PARAMETER_COLOR = 4,  /* float[3] */
    VKAO_PARAMETER_TYPE_MAX_ENUM = 0x7fffffff
} vkao_parameter_type;

typedef struct vkao_parameter {
    const char *name; /* of the member: "radius" */
    const char *unit; /* "scene units"; "" = none */
    const char *help; /* a few words, lower case */
    vkao_parameter_type type;
    VkBool32 is_compiled;       /* VK_TRUE: a member of vkao_effect_info; else of vkao_params */
    uint32_t offset;            /* of the member */
    VkBool32 above_least;       /* VK_TRUE: least itself is out of range */
    VkBool32 zero_is_standard;  /* VK_TRUE: 0 stands for the default */
    uint32_t padding;           /* zero */
    double least, most;         /* range; a CHOICE counts from 0 to most */
    double standard;            /* default */
    const char *const *choices; /* words of a CHOICE, most + 1 of them; else NULL */
    vkao_stage_flags stages;    /* that read it */
    uint32_t methods;           /* bits 1 << vkao_ssao_method of those that read it; 0 = any */
} vkao_parameter;

/* Static; *count, unless NULL: how many there are. Rows keep their size within 0.2. */
VKAO_API const vkao_parameter *vkao_parameters(uint32_t *count);

typedef struct vkao_method {
    const char *name; /* "vbao" */
    const char *help;
    VkBool32 has_bent_normals;
    uint32_t padding; /* zero */
} vkao_method;

/* Static, by vkao_ssao_method; *count, unless NULL: how many there are. Rows keep their size within
 * 0.2. */
VKAO_API const vkao_method *vkao_methods(uint32_t *count);

#ifdef __cplusplus
}
#endif
#endif /* VKAO_H_ */
