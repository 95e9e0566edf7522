#include "api/layout.h"

#include <string>

#include "api/for_each.h"
#include "gradus/gradus.h"

namespace gradus::api {
namespace {

#define GRADUS_FIELD(name, field) {#field, offsetof(Gradus##name, field), sizeof(Gradus##name::field)},
#define GRADUS_FIELDS(name, ...) constexpr FieldLayout k##name##Fields[] = {GRADUS_FOR_EACH(GRADUS_FIELD, name, __VA_ARGS__)};
#define GRADUS_VALUE(name, value) int64_t{GRADUS_##value},
#define GRADUS_VALUES(name, ...) constexpr int64_t k##name##Values[] = {GRADUS_FOR_EACH(GRADUS_VALUE, name, __VA_ARGS__)};

// clang-format off
GRADUS_FIELDS(DeviceSettings, struct_size, threads, color_config, denoiser_path)
GRADUS_FIELDS(ColorSpace, struct_size, curve_count, name, curve, matrix)
GRADUS_FIELDS(Attribute, struct_size, domain, channels, is_uv, name, data)
GRADUS_FIELDS(Mesh, struct_size, key_count, key_times, vertex_count, positions, corner_count, corner_vertices, triangle_count,
  triangle_corners, triangle_faces, face_count, face_materials, normal_domain, attribute_count, normals, attributes, default_uv,
  generated_location, generated_size, generated_points, name, shutter_positions, shutter_key_count, reserved)
GRADUS_FIELDS(Instances, struct_size, reserved, count, meshes, ids, matrices, matrices_previous, matrices_next, visibility, random_ids,
  pass_indices, colors, generated, uvs, shadow_terminator_offsets, material_first, material_count, materials_size, materials, name_index,
  name_count, names, shutter_first, shutter_count, shutter_size, shutter_matrices)
GRADUS_FIELDS(Light, struct_size, type, flags, visibility, matrix, strength, radius, angle, size, spread, cone, blend,
  sun_radiance_per_irradiance, material, max_bounces, pass_index, name)
GRADUS_FIELDS(Camera, struct_size, type, matrix, matrix_previous, matrix_next, window, window_previous, window_next, clip_start,
  clip_end, aperture_radius, focus_distance, blades, blade_rotation, aperture_ratio, panorama, fisheye_fov, fisheye_polynomial,
  eye_offset, convergence_distance, pole_merge_from, pole_merge_to, shutter_key_count, shutter_open, shutter_close,
  shutter_curve_count, reserved, shutter_curve, shutter_matrices, shutter_windows)
GRADUS_FIELDS(World, struct_size, visibility, material, importance, map_size, mist_start, mist_depth, mist_falloff, ao_distance)
GRADUS_FIELDS(ImageTile, struct_size, number, source, width, height, reserved, path, data, data_size)
GRADUS_FIELDS(Image, struct_size, alpha_mode, is_float, tile_count, tiles, color_space, name)
GRADUS_FIELDS(Input, node, output, value)
GRADUS_FIELDS(Node, op, mode, first_input, input_count, first_float, float_count, resource)
GRADUS_FIELDS(Material, struct_size, node_count, nodes, inputs, input_count, floats, float_count, names, name_count, surface,
  pass_index, sample_as_light, transparent_shadow, uses_fallback, name)
GRADUS_FIELDS(Settings, struct_size, width, height, region, samples, min_samples, noise_threshold, time_limit, seed, use_animated_seed,
  frame, integrator, reconstruction, reconstruction_alpha, max_bounces, diffuse_bounces, glossy_bounces, transmission_bounces,
  volume_bounces, transparent_max_bounces, clamp_direct, clamp_indirect, pixel_filter, filter_width, film_exposure, film_transparent,
  roughness_threshold, strict, threads, alpha_threshold, use_sky, independent_sampler, passes, first_sample,
  denoiser, use_decomposition, component_passes, components,
  component_replays)
GRADUS_FIELDS(OptionInfo, struct_size, type, name, doc, default_value, minimum, maximum, choices)
GRADUS_FIELDS(Progress, struct_size, phase, fraction, seconds, samples_done, version, memory_bytes, peak_memory_bytes)
GRADUS_FIELDS(SequenceSettings, struct_size, step, first, last, window_size, window_overlap, folder, with_flow, reserved)

GRADUS_VALUES(Error, OK, ERROR_UNKNOWN, ERROR_INVALID_ARGUMENT, ERROR_INVALID_OPERATION, ERROR_OUT_OF_MEMORY, ERROR_UNSUPPORTED,
  ERROR_CANCELLED, TIMEOUT)
GRADUS_VALUES(Domain, DOMAIN_POINT, DOMAIN_FACE, DOMAIN_CORNER)
GRADUS_VALUES(Visibility, VISIBLE_CAMERA, VISIBLE_DIFFUSE, VISIBLE_GLOSSY, VISIBLE_TRANSMISSION, VISIBLE_VOLUME, VISIBLE_SHADOW,
  VISIBLE_ALL, HOLDOUT, SHADOW_CATCHER, MAY_MOVE)
GRADUS_VALUES(LightType, LIGHT_POINT, LIGHT_SPOT, LIGHT_SUN, LIGHT_RECTANGLE, LIGHT_ELLIPSE)
GRADUS_VALUES(LightFlags, LIGHT_NO_SHADOW, LIGHT_SPOT_COSINE, LIGHT_DISK_FACING, LIGHT_NO_MIS)
GRADUS_VALUES(CameraType, CAMERA_PERSPECTIVE, CAMERA_ORTHOGRAPHIC, CAMERA_PANORAMA)
GRADUS_VALUES(Panorama, PANORAMA_EQUIRECTANGULAR, PANORAMA_CUBE_FACE, PANORAMA_MIRROR_BALL, PANORAMA_FISHEYE_EQUIDISTANT,
  PANORAMA_FISHEYE_EQUISOLID, PANORAMA_FISHEYE_POLYNOMIAL, PANORAMA_CYLINDER)
GRADUS_VALUES(MistFalloff, MIST_QUADRATIC, MIST_LINEAR, MIST_INVERSE_QUADRATIC)
GRADUS_VALUES(ImageSource, IMAGE_FILE, IMAGE_ENCODED, IMAGE_FLOAT, IMAGE_BYTE)
GRADUS_VALUES(AlphaMode, ALPHA_STRAIGHT, ALPHA_PREMULTIPLIED, ALPHA_CHANNEL_PACKED, ALPHA_NONE)
GRADUS_VALUES(ObjectKind, KIND_MESH, KIND_IMAGE, KIND_MATERIAL)
GRADUS_VALUES(Integrator, INTEGRATOR_AUTO, INTEGRATOR_PATH, INTEGRATOR_GRADIENT, INTEGRATOR_BIDIRECTIONAL, INTEGRATOR_METROPOLIS)
GRADUS_VALUES(Reconstruction, RECONSTRUCTION_AUTO, RECONSTRUCTION_NONE, RECONSTRUCTION_L2, RECONSTRUCTION_WEIGHTED, RECONSTRUCTION_L1,
  RECONSTRUCTION_REGULARIZED)
GRADUS_VALUES(Denoiser, DENOISER_NONE, DENOISER_AUTO, DENOISER_OIDN)
GRADUS_VALUES(PixelFilter, FILTER_BOX, FILTER_GAUSSIAN, FILTER_BLACKMAN_HARRIS)
GRADUS_VALUES(Pass, PASS_COMBINED, PASS_NOISY_IMAGE, PASS_DEPTH, PASS_MIST, PASS_NORMAL, PASS_POSITION, PASS_UV, PASS_VECTOR,
  PASS_OBJECT_INDEX, PASS_MATERIAL_INDEX, PASS_EMISSION, PASS_ENVIRONMENT, PASS_DIFFUSE_DIRECT, PASS_DIFFUSE_INDIRECT,
  PASS_DIFFUSE_COLOR, PASS_GLOSSY_DIRECT, PASS_GLOSSY_INDIRECT, PASS_GLOSSY_COLOR, PASS_TRANSMISSION_DIRECT, PASS_TRANSMISSION_INDIRECT,
  PASS_TRANSMISSION_COLOR, PASS_AMBIENT_OCCLUSION, PASS_DENOISING_NORMAL, PASS_DENOISING_ALBEDO, PASS_DENOISING_DEPTH,
  PASS_SAMPLE_COUNT, PASS_GRADIENT_X, PASS_GRADIENT_Y, PASS_VARIANCE, PASS_FALLBACK, PASS_ERROR, PASS_GRADIENT_T, PASS_GRADIENT_T_LINK, PASS_COUNT)
GRADUS_VALUES(ComponentPass, COMPONENT_COLOR, COMPONENT_REFLECTANCE, COMPONENT_IRRADIANCE, COMPONENT_NORMAL, COMPONENT_MOTION,
  COMPONENT_TRACKED, COMPONENT_IRRADIANCE_MOTION, COMPONENT_IRRADIANCE_TRACKED, COMPONENT_DEPTH, COMPONENT_UV,
  COMPONENT_OBJECT_INDEX, COMPONENT_FACE_INDEX, COMPONENT_EMIT, COMPONENT_PASS_COUNT)
GRADUS_VALUES(OptionType, OPTION_INT, OPTION_FLOAT, OPTION_BOOL, OPTION_ENUM, OPTION_TEXT)
GRADUS_VALUES(Phase, PHASE_WAITING, PHASE_SAMPLING, PHASE_RECONSTRUCTING, PHASE_DONE, PHASE_CANCELLED, PHASE_FAILED)
// clang-format on

#define GRADUS_STRUCT(name) \
  StructLayout { #name, sizeof(Gradus##name), k##name##Fields }
#define GRADUS_ENUM(name) \
  EnumLayout { #name, k##name##Values }

constexpr StructLayout kStructs[] = {
    GRADUS_STRUCT(DeviceSettings),   GRADUS_STRUCT(ColorSpace), GRADUS_STRUCT(Attribute),  GRADUS_STRUCT(Mesh),
    GRADUS_STRUCT(Instances),        GRADUS_STRUCT(Light),      GRADUS_STRUCT(Camera),     GRADUS_STRUCT(World),
    GRADUS_STRUCT(ImageTile),        GRADUS_STRUCT(Image),      GRADUS_STRUCT(Input),      GRADUS_STRUCT(Node),
    GRADUS_STRUCT(Material),         GRADUS_STRUCT(Settings),   GRADUS_STRUCT(OptionInfo), GRADUS_STRUCT(Progress),
    GRADUS_STRUCT(SequenceSettings),
};
constexpr EnumLayout kEnums[] = {
    GRADUS_ENUM(Error),      GRADUS_ENUM(Domain),        GRADUS_ENUM(Visibility),     GRADUS_ENUM(LightType),   GRADUS_ENUM(LightFlags),
    GRADUS_ENUM(CameraType), GRADUS_ENUM(Panorama),      GRADUS_ENUM(MistFalloff),    GRADUS_ENUM(ImageSource), GRADUS_ENUM(AlphaMode),
    GRADUS_ENUM(ObjectKind), GRADUS_ENUM(Integrator),    GRADUS_ENUM(Reconstruction), GRADUS_ENUM(Denoiser),    GRADUS_ENUM(PixelFilter),
    GRADUS_ENUM(Pass),       GRADUS_ENUM(ComponentPass), GRADUS_ENUM(OptionType),     GRADUS_ENUM(Phase),
};

std::string abi_text() {
  std::string text;
  const auto list = [&text](const char* name) { text.append(name).append(":"); };
  for (const StructLayout& s : kStructs) {
    list(s.name);
    text.append(std::to_string(s.size)).append(":");
    for (const FieldLayout& f : s.fields) text.append(std::to_string(f.offset)).append(",");
    text.back() = ';';
  }
  for (const EnumLayout& e : kEnums) {
    list(e.name);
    for (const int64_t value : e.values) text.append(std::to_string(value)).append(",");
    text.back() = ';';
  }
  return text;
}

}  // namespace

std::span<const StructLayout> struct_layouts() { return kStructs; }
std::span<const EnumLayout> enum_layouts() { return kEnums; }

const StructLayout* find_struct(std::string_view name) {
  for (const StructLayout& s : kStructs) {
    if (name == s.name) return &s;
  }
  return nullptr;
}

uint64_t abi_hash() {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : abi_text()) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3u;
  }
  return hash;
}

}  // namespace gradus::api
