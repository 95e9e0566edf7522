/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Gradus: the C API, the only public header. C99; no exception crosses it; every function may be called from any thread.
 *
 * Conventions
 *   - Handles are 64-bit values, never addresses: 0 is "none", a freed or foreign handle is refused with a code.
 *   - Every function that can fail returns a GradusError; the text of the first error of a thread is kept until read.
 *   - Every struct starts with struct_size = sizeof(struct): an older caller works, a newer one is refused.
 *   - Arrays are (pointer, count); they are copied before the call returns, unless said otherwise.
 *   - Lengths in metres, angles in radians, radiometric values scene-linear RGB, time in frames relative to the frame rendered.
 *   - Matrices are 16 floats, column-major, object (or camera, light) to world.
 *   - Images and planes: row 0 is the bottom row, x to the right, y up; channels interleaved.
 */
#ifndef GRADUS_H
#define GRADUS_H

#include <stddef.h>
#include <stdint.h>

#define GRADUS_VERSION_MAJOR 0
#define GRADUS_VERSION_MINOR 1
#define GRADUS_VERSION_PATCH 0

#if defined(GRADUS_BUILD)
#define GRADUS_API __attribute__((visibility("default")))
#else
#define GRADUS_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* clang-format off */ /* aligned by hand, as tables */

/* ------------------------------------------------------------------------------------------------ errors and versions */

typedef enum GradusError {
  GRADUS_OK = 0,
  GRADUS_ERROR_UNKNOWN = 1,
  GRADUS_ERROR_INVALID_ARGUMENT = 2,
  GRADUS_ERROR_INVALID_OPERATION = 3,
  GRADUS_ERROR_OUT_OF_MEMORY = 4,
  GRADUS_ERROR_UNSUPPORTED = 5,
  GRADUS_ERROR_CANCELLED = 6,
  GRADUS_TIMEOUT = 7               /* no error: the time to wait is over and the render is still running. The error slot stays as it was. */
} GradusError;

/* major·10000 + minor·100 + patch of the library that answers. Works before anything else. */
GRADUS_API uint32_t gradus_version(void);
/* "0.1.0 (commit abc1234)". Static text. */
GRADUS_API const char* gradus_version_text(void);
/* Hash of all struct layouts and enum values of this header; the caller compares it with its own. FNV-1a, 64 bit, over the ASCII text
 * "Name:size:offset,offset,…;" of every struct and then "Name:value,value,…;" of every enum, each in order of declaration, names without
 * the prefix Gradus, numbers decimal, the ellipsis meaning repetition only: e.g. "DeviceSettings:24:0,4,8,16;" and "Domain:0,1,2;". */
GRADUS_API uint64_t gradus_abi_hash(void);
/* Reads and clears the calling thread's error slot. `text` (may be NULL) stays valid until the thread's next call. */
GRADUS_API GradusError gradus_error(const char** text);
/* Size in bytes and field offsets of public struct `name` (without prefix "Gradus"), for the caller's own check.
 * Fills at most `capacity` offsets in order of declaration; *field_count receives how many there are. */
GRADUS_API GradusError gradus_struct_layout(const char* name, size_t* size, size_t* offsets, size_t capacity, size_t* field_count);

/* ------------------------------------------------------------------------------------------------ device */

typedef uint64_t GradusDevice;
typedef uint64_t GradusScene;
typedef uint64_t GradusRender;
typedef uint64_t GradusFrame;

typedef struct GradusDeviceSettings {
  uint32_t struct_size;
  uint32_t threads;          /* 0 = all */
  const char* color_config;  /* path of the OpenColorIO configuration, UTF-8; NULL or unreadable = built-in sRGB/linear */
  const char* denoiser_path; /* file or folder of Open Image Denoise 2, UTF-8, for where the process has not loaded it; may be NULL */
} GradusDeviceSettings;

/* Creates the object that owns threads, Embree and colour. Checks Embree's version and traces one ray: UNSUPPORTED if that
 * goes wrong (a foreign Embree or TBB in the process). */
GRADUS_API GradusError gradus_device_create(const GradusDeviceSettings* settings, GradusDevice* device);
GRADUS_API GradusError gradus_device_release(GradusDevice device);
/* Takes the oldest warning about the device (colour management) not yet taken; *text is NULL when there is none; valid until the thread's
 * next call. */
GRADUS_API GradusError gradus_device_warning(GradusDevice device, const char** text);

typedef struct GradusColorSpace {
  uint32_t struct_size;
  uint32_t curve_count;      /* samples of the curve over [0, 1]; 0 = identity */
  const char* name;
  const float* curve;        /* encoded -> linear, same for R, G, B */
  float matrix[9];           /* row-major, applied after the curve, into scene-linear */
} GradusColorSpace;
/* Overrides a colour space by values baked elsewhere (for a configuration that this OpenColorIO cannot read). */
GRADUS_API GradusError gradus_device_set_color_space(GradusDevice device, const GradusColorSpace* space);

/* ------------------------------------------------------------------------------------------------ scene */

/* Objects of a scene are named by 64-bit keys of the caller, 0 = none. Setting a key again replaces the object. */

typedef enum GradusDomain { GRADUS_DOMAIN_POINT = 0, GRADUS_DOMAIN_FACE = 1, GRADUS_DOMAIN_CORNER = 2 } GradusDomain;

typedef struct GradusAttribute {
  uint32_t struct_size;
  uint32_t domain;           /* GradusDomain */
  uint32_t channels;         /* 1 to 4 */
  uint32_t is_uv;            /* a UV map: answers UV Map nodes and texture coordinates */
  const char* name;          /* UTF-8 */
  const float* data;         /* channels per element, element count of the domain */
} GradusAttribute;

typedef struct GradusMesh {
  uint32_t struct_size;
  uint32_t key_count;               /* time keys of positions, at least 1 */
  const float* key_times;           /* frames relative to the one rendered, ascending; NULL if key_count is 1 */
  size_t vertex_count;
  const float* positions;           /* 3 per vertex, key after key */
  size_t corner_count;
  const int32_t* corner_vertices;   /* vertex of each corner */
  size_t triangle_count;
  const uint32_t* triangle_corners; /* 3 corners per triangle */
  const int32_t* triangle_faces;    /* face of each triangle; NULL = one face per triangle */
  size_t face_count;
  const int32_t* face_materials;    /* material slot of each face; NULL = slot 0 */
  uint32_t normal_domain;           /* GradusDomain of `normals`; NULL normals: FACE = flat, POINT = smooth */
  uint32_t attribute_count;
  const float* normals;             /* 3 per element of normal_domain; CORNER: 0 for the smooth normal of its vertex */
  const GradusAttribute* attributes;
  const char* default_uv;           /* name of the UV map that unnamed look-ups take; may be NULL */
  float generated_location[3];      /* texture space: generated = (p - location) / (2 size) + 1/2 */
  float generated_size[3];
  const float* generated_points;    /* undeformed coordinates, 3 per vertex; NULL = positions */
  const char* name;
  const float* shutter_positions;   /* 3 per vertex, key after key, evenly from the opening of the shutter to its closing */
  uint32_t shutter_key_count;       /* 0 = stands still while it is open; else 2 to 129 */
  uint32_t reserved;
} GradusMesh;

typedef enum GradusVisibility {
  GRADUS_VISIBLE_CAMERA = 1,
  GRADUS_VISIBLE_DIFFUSE = 2,
  GRADUS_VISIBLE_GLOSSY = 4,
  GRADUS_VISIBLE_TRANSMISSION = 8,
  GRADUS_VISIBLE_VOLUME = 16,
  GRADUS_VISIBLE_SHADOW = 32,
  GRADUS_VISIBLE_ALL = 63,
  GRADUS_HOLDOUT = 64,
  GRADUS_SHADOW_CATCHER = 128,
  GRADUS_MAY_MOVE = 256 /* a hint: other frames may show it elsewhere or in another shape; what rests is kept from frame to frame */
} GradusVisibility;

/* All instances of the scene, as arrays of length count. Optional arrays may be NULL. */
typedef struct GradusInstances {
  uint32_t struct_size;
  uint32_t reserved;
  size_t count;
  const uint64_t* meshes;            /* mesh keys */
  const uint64_t* ids;               /* stable identity over frames; NULL = index */
  const float* matrices;             /* 16 each */
  const float* matrices_previous;    /* one frame before; NULL = at rest; not finite: it is not there, or as another mesh */
  const float* matrices_next;
  const uint32_t* visibility;        /* GradusVisibility bits; NULL = all */
  const uint32_t* random_ids;        /* Object Info > Random is random_id / 2^32 */
  const int32_t* pass_indices;
  const float* colors;               /* 4 each, Object Info > Color */
  const float* generated;            /* 3 each: coordinates on the instancer */
  const float* uvs;                  /* 2 each: UV on the instancer */
  const float* shadow_terminator_offsets; /* cosine below which lights' shadow rays leave faces with smooth normals from above; NULL = 0 */
  const uint32_t* material_first;    /* first entry of the instance in `materials`; NULL = no materials */
  const uint32_t* material_count;
  size_t materials_size;
  const uint64_t* materials;         /* material keys by slot; key 0 = default grey */
  const uint32_t* name_index;        /* index into names, for messages */
  size_t name_count;
  const char* const* names;
  const uint32_t* shutter_first;     /* first matrix of the instance in shutter_matrices; NULL = nothing moves while the shutter is open */
  const uint32_t* shutter_count;     /* 0 = at rest; else 2 to 129, evenly from the opening of the shutter to its closing */
  size_t shutter_size;
  const float* shutter_matrices;     /* 16 each */
} GradusInstances;

typedef enum GradusLightType {
  GRADUS_LIGHT_POINT = 0,
  GRADUS_LIGHT_SPOT = 1,
  GRADUS_LIGHT_SUN = 2,
  GRADUS_LIGHT_RECTANGLE = 3,
  GRADUS_LIGHT_ELLIPSE = 4
} GradusLightType;

typedef enum GradusLightFlags {
  GRADUS_LIGHT_NO_SHADOW = 1,
  GRADUS_LIGHT_SPOT_COSINE = 2,    /* Blender before 4.0: spots carry one more cosine */
  GRADUS_LIGHT_DISK_FACING = 4,    /* Blender before 4.1, or soft falloff: a round light is a disk facing the receiver */
  GRADUS_LIGHT_NO_MIS = 8
} GradusLightFlags;

typedef struct GradusLight {
  uint32_t struct_size;
  uint32_t type;                   /* GradusLightType */
  uint32_t flags;                  /* GradusLightFlags */
  uint32_t visibility;             /* GradusVisibility bits */
  float matrix[16];                /* shines along local -Z; scale is ignored, it is in the sizes */
  float strength[3];               /* point, spot: intensity W/sr; sun: irradiance W/m2 facing it; area: radiance */
  float radius;                    /* point, spot: m */
  float angle;                     /* sun: full angle of the disk */
  float size[2];                   /* area: full width and height, m */
  float spread;                    /* area: full angle of emission, pi = Lambertian */
  float cone;                      /* spot: full angle */
  float blend;                     /* spot: 0..1 */
  float sun_radiance_per_irradiance; /* sun with an angle: 0 = 1/(pi sin^2(angle/2)) */
  uint64_t material;               /* emission program that multiplies strength; 0 = constant */
  uint32_t max_bounces;            /* 0xffffffff = no limit */
  int32_t pass_index;
  const char* name;
} GradusLight;

typedef enum GradusCameraType {
  GRADUS_CAMERA_PERSPECTIVE = 0,
  GRADUS_CAMERA_ORTHOGRAPHIC = 1,
  GRADUS_CAMERA_PANORAMA = 2
} GradusCameraType;

/* What a panorama's film measures, and so its window, x and y. Angles in radians; r = length of (x, y). */
typedef enum GradusPanorama {
  GRADUS_PANORAMA_EQUIRECTANGULAR = 0,       /* longitude to the right of the view axis, latitude */
  GRADUS_PANORAMA_CUBE_FACE = 1,             /* equiangular: the angles of the direction's slopes */
  GRADUS_PANORAMA_MIRROR_BALL = 2,           /* radii of the ball */
  GRADUS_PANORAMA_FISHEYE_EQUIDISTANT = 3,   /* r = angle from the view axis */
  GRADUS_PANORAMA_FISHEYE_EQUISOLID = 4,     /* r = sine of half the angle */
  GRADUS_PANORAMA_FISHEYE_POLYNOMIAL = 5,    /* the angle is minus fisheye_polynomial of r */
  GRADUS_PANORAMA_CYLINDER = 6               /* longitude, height on a cylinder of radius 1 */
} GradusPanorama;

typedef struct GradusCamera {
  uint32_t struct_size;
  uint32_t type;                   /* GradusCameraType */
  float matrix[16];                /* looks along -Z, y up; normalised */
  float matrix_previous[16];       /* one frame before and after, for vectors; equal to matrix if at rest; not finite: a cut */
  float matrix_next[16];
  float window[4];                 /* left, right, bottom, top of the FULL frame on the plane at distance 1
                                      (perspective), in metres (orthographic) or as GradusPanorama says, shift included */
  float window_previous[4];
  float window_next[4];
  float clip_start;
  float clip_end;
  float aperture_radius;           /* 0 = pinhole */
  float focus_distance;            /* along the view axis; panorama: along the ray */
  uint32_t blades;                 /* below 3: round */
  float blade_rotation;
  float aperture_ratio;            /* anamorphic: width divided by it */
  uint32_t panorama;               /* GradusPanorama */
  float fisheye_fov;               /* angle of the image circle; nothing is seen outside */
  float fisheye_polynomial[5];     /* from the constant term on; what r measures is up to the coefficients */
  float eye_offset;                /* spherical stereo: the eye's distance to the right of the centre, wherever a ray goes; 0 = none */
  float convergence_distance;      /* where the rays of both eyes meet; 0 = parallel */
  float pole_merge_from;           /* altitudes between which the offset fades out; to = 0: it does not */
  float pole_merge_to;
  uint32_t shutter_key_count;      /* 0 = at rest while the shutter is open; else 2 to 129, evenly from its opening to its closing */
  float shutter_open;              /* frames relative to the one rendered; the frame is a moment where close <= open */
  float shutter_close;
  uint32_t shutter_curve_count;    /* below 2: open all the time */
  uint32_t reserved;
  const float* shutter_curve;      /* how far it is open, evenly from opening to closing, linear in between; any scale */
  const float* shutter_matrices;   /* 16 for each key */
  const float* shutter_windows;    /* 4 for each key; NULL = window */
} GradusCamera;

typedef enum GradusMistFalloff { GRADUS_MIST_QUADRATIC = 0, GRADUS_MIST_LINEAR = 1, GRADUS_MIST_INVERSE_QUADRATIC = 2 } GradusMistFalloff;

typedef struct GradusWorld {
  uint32_t struct_size;
  uint32_t visibility;             /* GradusVisibility bits */
  uint64_t material;               /* Background program; 0 = black */
  uint32_t importance;             /* 0 = none, 1 = automatic, 2 = map_size */
  uint32_t map_size;
  float mist_start;
  float mist_depth;
  uint32_t mist_falloff;           /* GradusMistFalloff */
  float ao_distance;               /* 0 = unlimited */
} GradusWorld;

typedef enum GradusImageSource {
  GRADUS_IMAGE_FILE = 0,           /* path */
  GRADUS_IMAGE_ENCODED = 1,        /* data: bytes of a file (packed) */
  GRADUS_IMAGE_FLOAT = 2,          /* data: float RGBA, width·height, bottom row first */
  GRADUS_IMAGE_BYTE = 3            /* data: byte RGBA */
} GradusImageSource;

typedef enum GradusAlphaMode {
  GRADUS_ALPHA_STRAIGHT = 0,
  GRADUS_ALPHA_PREMULTIPLIED = 1,
  GRADUS_ALPHA_CHANNEL_PACKED = 2,
  GRADUS_ALPHA_NONE = 3
} GradusAlphaMode;

typedef struct GradusImageTile {
  uint32_t struct_size;
  uint32_t number;                 /* UDIM number; 0 = not tiled */
  uint32_t source;                 /* GradusImageSource */
  uint32_t width;
  uint32_t height;
  uint32_t reserved;
  const char* path;                /* UTF-8; named in warnings, too */
  const void* data;
  size_t data_size;                /* bytes */
} GradusImageTile;

typedef struct GradusImage {
  uint32_t struct_size;
  uint32_t alpha_mode;             /* GradusAlphaMode */
  uint32_t is_float;               /* stored as float: values are in color_space, usually linear */
  uint32_t tile_count;             /* 1 for an ordinary image */
  const GradusImageTile* tiles;
  const char* color_space;         /* name in the configuration; NULL, "" or "Non-Color": data */
  const char* name;
} GradusImage;

/* Operations of the node program: gradus_nodes.h has the list with inputs, outputs and modes. */
typedef struct GradusInput {
  int32_t node;                    /* earlier node of the program, or -1: the constant `value` */
  uint32_t output;
  float value[4];
} GradusInput;

typedef struct GradusNode {
  uint32_t op;                     /* GradusOp */
  uint32_t mode;                   /* GradusMode… of that operation, or bits; 0 if it has none */
  uint32_t first_input;
  uint32_t input_count;
  uint32_t first_float;            /* parameters and tables in `floats` */
  uint32_t float_count;
  uint64_t resource;               /* image key, or index of an attribute name + 1 in `names`; 0 = none */
} GradusNode;

typedef struct GradusMaterial {
  uint32_t struct_size;
  uint32_t node_count;             /* nodes in topological order: an input refers to an earlier node only */
  const GradusNode* nodes;
  const GradusInput* inputs;
  size_t input_count;
  const float* floats;
  size_t float_count;
  const char* const* names;        /* attribute and UV map names */
  uint32_t name_count;
  int32_t surface;                 /* node whose closure output is the surface (or background, or light); -1 = none */
  int32_t pass_index;
  uint32_t sample_as_light;        /* emission takes part in next-event estimation */
  uint32_t transparent_shadow;     /* 0: the shadow of a transparent closure is opaque */
  uint32_t uses_fallback;          /* some node was replaced: pixels are marked, see pass Fallback */
  const char* name;
} GradusMaterial;

typedef enum GradusObjectKind { GRADUS_KIND_MESH = 0, GRADUS_KIND_IMAGE = 1, GRADUS_KIND_MATERIAL = 2 } GradusObjectKind;

GRADUS_API GradusError gradus_scene_create(GradusDevice device, GradusScene* scene);
GRADUS_API GradusError gradus_scene_release(GradusScene scene);
GRADUS_API GradusError gradus_scene_set_mesh(GradusScene scene, uint64_t key, const GradusMesh* mesh);
GRADUS_API GradusError gradus_scene_set_image(GradusScene scene, uint64_t key, const GradusImage* image);
GRADUS_API GradusError gradus_scene_set_material(GradusScene scene, uint64_t key, const GradusMaterial* material);
GRADUS_API GradusError gradus_scene_set_instances(GradusScene scene, const GradusInstances* instances);
GRADUS_API GradusError gradus_scene_set_lights(GradusScene scene, const GradusLight* lights, size_t count);
GRADUS_API GradusError gradus_scene_set_camera(GradusScene scene, const GradusCamera* camera);
GRADUS_API GradusError gradus_scene_set_world(GradusScene scene, const GradusWorld* world);
GRADUS_API GradusError gradus_scene_remove(GradusScene scene, uint32_t kind, uint64_t key);
/* Makes what was set the current immutable snapshot, sharing what did not change; builds acceleration structures.
 * `progress` may be NULL; a non-zero *cancel (polled by the library, may be NULL) ends it with CANCELLED within 0.25 s. */
GRADUS_API GradusError gradus_scene_commit(GradusScene scene, const volatile int32_t* cancel, float* progress);
/* Like gradus_device_warning: what commits of this scene had to leave out or replace. */
GRADUS_API GradusError gradus_scene_warning(GradusScene scene, const char** text);
/* From now on keeps what is set (0: forgets it), so that the scene can be saved. Off by default: it doubles the memory of the arrays. */
GRADUS_API GradusError gradus_scene_record(GradusScene scene, uint32_t enabled);

/* ------------------------------------------------------------------------------------------------ render */

typedef enum GradusIntegrator {
  GRADUS_INTEGRATOR_AUTO = 0,
  GRADUS_INTEGRATOR_PATH = 1,
  GRADUS_INTEGRATOR_GRADIENT = 2,
  GRADUS_INTEGRATOR_BIDIRECTIONAL = 3, /* refused until it works */
  GRADUS_INTEGRATOR_METROPOLIS = 4     /* refused until it works */
} GradusIntegrator;

typedef enum GradusReconstruction {
  GRADUS_RECONSTRUCTION_AUTO = 0,
  GRADUS_RECONSTRUCTION_NONE = 1,
  GRADUS_RECONSTRUCTION_L2 = 2,
  GRADUS_RECONSTRUCTION_WEIGHTED = 3,
  GRADUS_RECONSTRUCTION_L1 = 4,
  GRADUS_RECONSTRUCTION_REGULARIZED = 5 /* by features of the surfaces, samples and, where there are any, gradients */
} GradusReconstruction;

/* The host's: Open Image Denoise, looked for when a render starts (see GradusDeviceSettings.denoiser_path), never brought along. */
typedef enum GradusDenoiser {
  GRADUS_DENOISER_NONE = 0,
  GRADUS_DENOISER_AUTO = 1,        /* OIDN where there is one */
  GRADUS_DENOISER_OIDN = 2         /* UNSUPPORTED where there is none */
} GradusDenoiser;

typedef enum GradusPixelFilter {
  GRADUS_FILTER_BOX = 0,
  GRADUS_FILTER_GAUSSIAN = 1,
  GRADUS_FILTER_BLACKMAN_HARRIS = 2
} GradusPixelFilter;

/* Names, types, defaults, ranges and meanings of all fields: gradus_option(). */
typedef struct GradusSettings {
  uint32_t struct_size;
  uint32_t width;                  /* full frame */
  uint32_t height;
  uint32_t region[4];              /* x0, y0, x1, y1 (exclusive) of the part to deliver; all 0 = full frame */
  uint32_t samples;
  uint32_t min_samples;
  float noise_threshold;
  float time_limit;
  uint32_t seed;
  uint32_t use_animated_seed;
  int32_t frame;
  uint32_t integrator;             /* GradusIntegrator */
  uint32_t reconstruction;         /* GradusReconstruction */
  float reconstruction_alpha;      /* 0: automatic */
  uint32_t max_bounces;
  uint32_t diffuse_bounces;
  uint32_t glossy_bounces;
  uint32_t transmission_bounces;
  uint32_t volume_bounces;
  uint32_t transparent_max_bounces;
  float clamp_direct;
  float clamp_indirect;
  uint32_t pixel_filter;           /* GradusPixelFilter */
  float filter_width;
  float film_exposure;
  uint32_t film_transparent;
  float roughness_threshold;
  uint32_t strict;
  uint32_t threads;                /* 0 = those of the device */
  float alpha_threshold;           /* surfaces with less alpha are skipped by data passes */
  uint32_t use_sky;                /* the world is seen by the camera */
  uint32_t independent_sampler;    /* test switch: independent random numbers in place of the Sobol net (docs/contract.md 1.2) */
  uint64_t passes;                 /* bit i = GradusPass i is wanted; Combined always is */
  uint32_t first_sample;           /* samples are numbered first_sample … first_sample + samples - 1, for frames to merge */
  uint32_t denoiser;               /* GradusDenoiser */
  uint32_t use_decomposition;      /* the picture is sampled and reconstructed by components (docs/contract.md 3) */
  uint32_t component_passes;       /* bit i = GradusComponentPass i of each component is wanted */
  char components[512];            /* "Name=EXPR;Name=EXPR" in UTF-8, ended by 0; "" = the default set */
  uint32_t component_replays;      /* temporal differences of a component go where it goes, not where the surface goes */
} GradusSettings;

typedef enum GradusPass {
  GRADUS_PASS_COMBINED = 0,
  GRADUS_PASS_NOISY_IMAGE,
  GRADUS_PASS_DEPTH,
  GRADUS_PASS_MIST,
  GRADUS_PASS_NORMAL,
  GRADUS_PASS_POSITION,
  GRADUS_PASS_UV,
  GRADUS_PASS_VECTOR,
  GRADUS_PASS_OBJECT_INDEX,
  GRADUS_PASS_MATERIAL_INDEX,
  GRADUS_PASS_EMISSION,
  GRADUS_PASS_ENVIRONMENT,
  GRADUS_PASS_DIFFUSE_DIRECT,
  GRADUS_PASS_DIFFUSE_INDIRECT,
  GRADUS_PASS_DIFFUSE_COLOR,
  GRADUS_PASS_GLOSSY_DIRECT,
  GRADUS_PASS_GLOSSY_INDIRECT,
  GRADUS_PASS_GLOSSY_COLOR,
  GRADUS_PASS_TRANSMISSION_DIRECT,
  GRADUS_PASS_TRANSMISSION_INDIRECT,
  GRADUS_PASS_TRANSMISSION_COLOR,
  GRADUS_PASS_AMBIENT_OCCLUSION,
  GRADUS_PASS_DENOISING_NORMAL,
  GRADUS_PASS_DENOISING_ALBEDO,
  GRADUS_PASS_DENOISING_DEPTH,
  GRADUS_PASS_SAMPLE_COUNT,
  GRADUS_PASS_GRADIENT_X,
  GRADUS_PASS_GRADIENT_Y,
  GRADUS_PASS_VARIANCE,
  GRADUS_PASS_FALLBACK,            /* share of samples that met a replaced node; for tests and the bench */
  GRADUS_PASS_ERROR,               /* estimated squared error of Combined, mean over RGB */
  GRADUS_PASS_GRADIENT_T,          /* difference to the next frame along Gradient T Link; 0 outside of sequences (docs/contract.md 4.3) */
  GRADUS_PASS_GRADIENT_T_LINK,     /* pixels to where the next frame shows the same, x and y; 1 if it does */
  GRADUS_PASS_COUNT
} GradusPass;

/* Of a component: Path NAME and, in Blender, Path NAME followed by the pass's name. */
typedef enum GradusComponentPass {
  GRADUS_COMPONENT_COLOR = 0,      /* reconstructed; the components add up to Combined */
  GRADUS_COMPONENT_REFLECTANCE,    /* mean albedo at the first rough vertex */
  GRADUS_COMPONENT_IRRADIANCE,     /* color / reflectance, where that is at least 1e-3; color elsewhere */
  GRADUS_COMPONENT_NORMAL,         /* at the first rough vertex, in the world */
  GRADUS_COMPONENT_MOTION,         /* previous - now, now - next: pixels, y up (docs/contract.md 6.6) */
  GRADUS_COMPONENT_TRACKED,        /* 1, or a negative cause */
  GRADUS_COMPONENT_IRRADIANCE_MOTION,  /* likewise, of the light that falls on what is shown: by optical flow, in sequences */
  GRADUS_COMPONENT_IRRADIANCE_TRACKED,
  GRADUS_COMPONENT_DEPTH,          /* length of the path to the first rough vertex; 1e10 where there is none */
  /* Of the first rough vertex, or of what shines on the way: */
  GRADUS_COMPONENT_UV,             /* u, v, 1 by the default UV map; 0 without one */
  GRADUS_COMPONENT_OBJECT_INDEX,   /* pass_indices of its instance, of the first sample that met a surface; 0 where there is none */
  GRADUS_COMPONENT_FACE_INDEX,     /* its face in the mesh, likewise, from 0 on; -1 where there is none */
  GRADUS_COMPONENT_EMIT,           /* radiance that shines from there */
  GRADUS_COMPONENT_PASS_COUNT
} GradusComponentPass;

typedef enum GradusOptionType {
  GRADUS_OPTION_INT = 0,
  GRADUS_OPTION_FLOAT = 1,
  GRADUS_OPTION_BOOL = 2,
  GRADUS_OPTION_ENUM = 3,
  GRADUS_OPTION_TEXT = 4           /* default "", `maximum` bytes at most */
} GradusOptionType;

typedef struct GradusOptionInfo {
  uint32_t struct_size;
  uint32_t type;                   /* GradusOptionType */
  const char* name;                /* as in GradusSettings */
  const char* doc;
  double default_value;
  double minimum;
  double maximum;
  const char* choices;             /* enum: names in order of value, separated by spaces */
} GradusOptionInfo;

GRADUS_API uint32_t gradus_option_count(void);
GRADUS_API GradusError gradus_option(uint32_t index, GradusOptionInfo* info);
/* Fills all fields with defaults. settings->struct_size must be set. */
GRADUS_API GradusError gradus_settings_default(GradusSettings* settings);
/* Sets one option from text ("samples", "16"; enums in any case, '-' = '_'; bool 0 1 true false on off). */
GRADUS_API GradusError gradus_settings_parse(GradusSettings* settings, const char* name, const char* value);
GRADUS_API GradusError gradus_pass_info(uint32_t pass, const char** name, uint32_t* channels);
/* "Color", "Reflectance" …, static text. */
GRADUS_API GradusError gradus_component_pass_info(uint32_t pass, const char** name, uint32_t* channels);

/* How many components a set of path expressions has, as in GradusSettings.components, with Residual, which is the last. INVALID_ARGUMENT
 * and a text for users where it is none: malformed, empty, overlapping, matching no path. */
GRADUS_API GradusError gradus_components_check(const char* components, uint32_t* count);
/* Name, expression ("" for Residual) and some of the shortest paths, "EDL, EDDL", of a component. All texts valid until the thread's next
 * call; NULL: not wanted. */
GRADUS_API GradusError gradus_components_item(const char* components, uint32_t index, const char** name, const char** expression,
                                              const char** examples);
/* The component of a path, such as "ETTDL". */
GRADUS_API GradusError gradus_components_classify(const char* components, const char* path, uint32_t* index);

/* Saves what was set since recording began as a .gradus file, images packed (docs/contract.md 7.3). INVALID_OPERATION without recording.
 * `settings` are saved with it for the tool; may be NULL. */
GRADUS_API GradusError gradus_scene_save(GradusScene scene, const GradusSettings* settings, const char* path);
/* The scene is created and committed; gradus_scene_warning has what was left out. *settings (may be NULL) receives the saved settings, or defaults. */
GRADUS_API GradusError gradus_scene_load(GradusDevice device, const char* path, GradusScene* scene, GradusSettings* settings);

typedef enum GradusPhase {
  GRADUS_PHASE_WAITING = 0,
  GRADUS_PHASE_SAMPLING = 1,
  GRADUS_PHASE_RECONSTRUCTING = 2,
  GRADUS_PHASE_DONE = 3,
  GRADUS_PHASE_CANCELLED = 4,
  GRADUS_PHASE_FAILED = 5
} GradusPhase;

typedef struct GradusProgress {
  uint32_t struct_size;
  uint32_t phase;                  /* GradusPhase */
  float fraction;                  /* 0..1, never falls */
  float seconds;
  uint32_t samples_done;           /* of settings.samples, completed for every pixel */
  uint32_t version;                /* counts images that can be read: changes when there is something new to show in Combined */
  uint64_t memory_bytes;           /* of the frame and the picture, now */
  uint64_t peak_memory_bytes;
} GradusProgress;

/* Starts rendering the scene's current snapshot on the library's own threads and returns at once. The snapshot is kept:
 * the scene may be edited or released meanwhile. */
GRADUS_API GradusError gradus_render_start(GradusScene scene, const GradusSettings* settings, GradusRender* render);
/* The same, going on from the samples of `frame` (same scene and sampling settings): the result of 16 and then 48 samples has the bits of
 * 64 at once. settings.samples counts from the beginning. The frame itself does not change. */
GRADUS_API GradusError gradus_render_resume(GradusScene scene, const GradusSettings* settings, GradusFrame frame, GradusRender* render);
GRADUS_API GradusError gradus_render_poll(GradusRender render, GradusProgress* progress);
/* Asks it to stop. What was sampled stays readable; Combined is the last picture that was shown, if only at a quarter of the size, or the noisy image. */
GRADUS_API GradusError gradus_render_cancel(GradusRender render);
/* Blocks until done, cancelled or failed, or for at most `seconds` (negative: no limit). OK when it has ended well, CANCELLED or the
 * failure's code otherwise; GRADUS_TIMEOUT while it is still running. */
GRADUS_API GradusError gradus_render_wait(GradusRender render, double seconds);
GRADUS_API GradusError gradus_render_release(GradusRender render);
/* Copies a pass of the region, width·height·channels floats (`count` must match exactly); never waits for samples. While sampling: Noisy Image so
 * far, and Combined, which whoever reads it once then sees reconstructed, first at a quarter of the size; others INVALID_OPERATION until later. */
GRADUS_API GradusError gradus_render_read_pass(GradusRender render, uint32_t pass, float* pixels, size_t count);
/* The same of a component's pass (GradusComponentPass), once sampling has ended. 0 for a component to which no path of the scene belongs.
 * INVALID_ARGUMENT: none of the settings' components has that name. */
GRADUS_API GradusError gradus_render_read_component(GradusRender render, const char* component, uint32_t pass, float* pixels, size_t count);
/* The stats object of the finished frame as JSON (docs/contract.md 7.1) without the fields that only the host knows. Valid until release. */
GRADUS_API GradusError gradus_render_stats(GradusRender render, const char** json);
/* The frame of a finished render: planes with half-buffers. */
GRADUS_API GradusError gradus_render_frame(GradusRender render, GradusFrame* frame);

/* ------------------------------------------------------------------------------------------------ sequence */

/* Frames of an animation, sampled one after the other and reconstructed together, so that they do not flicker. Half of a frame's samples
 * repeat those of the frame before (docs/method.md). */
typedef uint64_t GradusSequence;

typedef struct GradusSequenceSettings {
  uint32_t struct_size;
  uint32_t step;                   /* frames between those that are rendered; at least 1 */
  int32_t first;                   /* frames that are rendered: first, first + step and so on, not beyond last */
  int32_t last;
  uint32_t window_size;            /* frames that are reconstructed together; 0 = 10 */
  uint32_t window_overlap;         /* those that two windows share, at most half; taken where window_size is not 0 */
  const char* folder;              /* where raw frames are kept and found again, UTF-8; NULL: a temporary one, which release removes */
  uint32_t with_flow;              /* 1: component passes by optical flow are asked for; a frame is delivered when the next one is there */
  uint32_t reserved;
} GradusSequenceSettings;

/* Whether frames of an animation with these settings have differences over time; *why_not says what is against it, "" nothing. Valid until
 * the thread's next call. */
GRADUS_API GradusError gradus_sequence_applies(const GradusSettings* settings, uint32_t* applies, const char** why_not);
GRADUS_API GradusError gradus_sequence_create(GradusDevice device, const GradusSequenceSettings* settings, GradusSequence* sequence);
/* Frames that must have been sampled before `frame` can be delivered: *first, *first + step … *last. */
GRADUS_API GradusError gradus_sequence_needs(GradusSequence sequence, int32_t frame, int32_t* first, int32_t* last);
/* Samples frame settings->frame on the scene's current snapshot and returns at once; the render is polled, waited for, cancelled and
 * released as any other. Frames in order, each when the render of the one before has ended. A frame that the folder holds is not sampled
 * again, or goes on from its samples where it has fewer than are asked for; one that is as the frame before neither. */
GRADUS_API GradusError gradus_sequence_sample(GradusSequence sequence, GradusScene scene, const GradusSettings* settings,
                                              GradusRender* render);
/* The scene shows settings->frame, which is not sampled here: the next follows it. For parts of a job, and frames on their own, at which windows are cut. */
GRADUS_API GradusError gradus_sequence_pass_by(GradusSequence sequence, GradusScene scene, const GradusSettings* settings);
/* Frames beyond `last` do not come after all: what is there is delivered without them. */
GRADUS_API GradusError gradus_sequence_end_at(GradusSequence sequence, int32_t last);
/* Reconstructs what is needed of the windows of `frame`; passes, stats and frame of the render are those of the delivered frame, once it
 * has ended. Frames in order. settings: other values of reconstruction, reconstruction_alpha, denoiser and film_exposure than the frames
 * were sampled for (AUTO: none other); may be NULL. */
GRADUS_API GradusError gradus_sequence_deliver(GradusSequence sequence, int32_t frame, const GradusSettings* settings,
                                               GradusRender* render);
GRADUS_API GradusError gradus_sequence_release(GradusSequence sequence);

/* ------------------------------------------------------------------------------------------------ frame */

GRADUS_API GradusError gradus_frame_save(GradusFrame frame, const char* path);
GRADUS_API GradusError gradus_frame_load(GradusDevice device, const char* path, GradusFrame* frame);
/* Adds the samples of `other` (same size, scene and settings key, other sample numbers) to `frame`. Equal to rendering them together up to
 * float rounding of the sums; bit equality needs gradus_render_resume. Numbers in between may be missing, and be added later; a render
 * does not go on from such a frame. */
GRADUS_API GradusError gradus_frame_merge(GradusFrame frame, GradusFrame other);
/* Size of the delivered region, which read_pass and reconstruct return. */
GRADUS_API GradusError gradus_frame_size(GradusFrame frame, uint32_t* width, uint32_t* height);
/* Reconstructs Combined from the planes; RGBA. alpha: weight of the primal against the gradients; 0: automatic. denoiser: GradusDenoiser.
 * error: count / 4 floats for pass Error; may be NULL. AUTO leaves the denoiser out of frames with fewer than
 * 8 samples per pixel. */
GRADUS_API GradusError gradus_frame_reconstruct(GradusFrame frame, uint32_t reconstruction, float alpha, uint32_t denoiser, float* rgba,
                                                size_t count, float* error);
GRADUS_API GradusError gradus_frame_read_pass(GradusFrame frame, uint32_t pass, float* pixels, size_t count);
/* Color and Irradiance are reconstructed as Combined is, without the denoiser. */
GRADUS_API GradusError gradus_frame_read_component(GradusFrame frame, const char* component, uint32_t pass, float* pixels, size_t count);
GRADUS_API GradusError gradus_frame_release(GradusFrame frame);

#ifdef __cplusplus
}
#endif
#endif
