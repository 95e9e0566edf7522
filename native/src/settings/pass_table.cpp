#include "settings/pass_table.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace gradus {
namespace {

constexpr uint32_t kNone = GRADUS_PASS_COUNT;

// clang-format off
constexpr PassInfo kPasses[] = {
    {GRADUS_PASS_COMBINED,              "Combined",              4, PassKind::Image,    kNone},
    {GRADUS_PASS_NOISY_IMAGE,           "Noisy Image",           4, PassKind::Image,    kNone},
    {GRADUS_PASS_DEPTH,                 "Depth",                 1, PassKind::First,    kNone},
    {GRADUS_PASS_MIST,                  "Mist",                  1, PassKind::Average,  kNone},
    {GRADUS_PASS_NORMAL,                "Normal",                3, PassKind::Average,  kNone},
    {GRADUS_PASS_POSITION,              "Position",              3, PassKind::Average,  kNone},
    {GRADUS_PASS_UV,                    "UV",                    3, PassKind::Average,  kNone},
    {GRADUS_PASS_VECTOR,                "Vector",                4, PassKind::Weighted, kNone},
    {GRADUS_PASS_OBJECT_INDEX,          "Object Index",          1, PassKind::First,    kNone},
    {GRADUS_PASS_MATERIAL_INDEX,        "Material Index",        1, PassKind::First,    kNone},
    {GRADUS_PASS_EMISSION,              "Emission",              3, PassKind::Radiance, kNone},
    {GRADUS_PASS_ENVIRONMENT,           "Environment",           3, PassKind::Radiance, kNone},
    {GRADUS_PASS_DIFFUSE_DIRECT,        "Diffuse Direct",        3, PassKind::Light,    GRADUS_PASS_DIFFUSE_COLOR},
    {GRADUS_PASS_DIFFUSE_INDIRECT,      "Diffuse Indirect",      3, PassKind::Light,    GRADUS_PASS_DIFFUSE_COLOR},
    {GRADUS_PASS_DIFFUSE_COLOR,         "Diffuse Color",         3, PassKind::Color,    kNone},
    {GRADUS_PASS_GLOSSY_DIRECT,         "Glossy Direct",         3, PassKind::Light,    GRADUS_PASS_GLOSSY_COLOR},
    {GRADUS_PASS_GLOSSY_INDIRECT,       "Glossy Indirect",       3, PassKind::Light,    GRADUS_PASS_GLOSSY_COLOR},
    {GRADUS_PASS_GLOSSY_COLOR,          "Glossy Color",          3, PassKind::Color,    kNone},
    {GRADUS_PASS_TRANSMISSION_DIRECT,   "Transmission Direct",   3, PassKind::Light,    GRADUS_PASS_TRANSMISSION_COLOR},
    {GRADUS_PASS_TRANSMISSION_INDIRECT, "Transmission Indirect", 3, PassKind::Light,    GRADUS_PASS_TRANSMISSION_COLOR},
    {GRADUS_PASS_TRANSMISSION_COLOR,    "Transmission Color",    3, PassKind::Color,    kNone},
    {GRADUS_PASS_AMBIENT_OCCLUSION,     "Ambient Occlusion",     3, PassKind::Average,  kNone},
    {GRADUS_PASS_DENOISING_NORMAL,      "Denoising Normal",      3, PassKind::Feature,  kNone},
    {GRADUS_PASS_DENOISING_ALBEDO,      "Denoising Albedo",      3, PassKind::Feature,  kNone},
    {GRADUS_PASS_DENOISING_DEPTH,       "Denoising Depth",       1, PassKind::Feature,  kNone},
    {GRADUS_PASS_SAMPLE_COUNT,          "Debug Sample Count",    1, PassKind::Derived,  kNone},
    {GRADUS_PASS_GRADIENT_X,            "Gradient X",            3, PassKind::Derived,  kNone},
    {GRADUS_PASS_GRADIENT_Y,            "Gradient Y",            3, PassKind::Derived,  kNone},
    {GRADUS_PASS_VARIANCE,              "Variance",              3, PassKind::Derived,  kNone},
    {GRADUS_PASS_FALLBACK,              "Fallback",              1, PassKind::Derived,  kNone},
    {GRADUS_PASS_ERROR,                 "Error",                 1, PassKind::Solved,   kNone},
    {GRADUS_PASS_GRADIENT_T,            "Gradient T",            3, PassKind::Sequence, kNone},
    {GRADUS_PASS_GRADIENT_T_LINK,       "Gradient T Link",       3, PassKind::Sequence, kNone},
};
constexpr ComponentPassInfo kComponentPasses[] = {
    {GRADUS_COMPONENT_COLOR,              "Color",              3},
    {GRADUS_COMPONENT_REFLECTANCE,        "Reflectance",        3},
    {GRADUS_COMPONENT_IRRADIANCE,         "Irradiance",         3},
    {GRADUS_COMPONENT_NORMAL,             "Normal",             3},
    {GRADUS_COMPONENT_MOTION,             "Motion",             4},
    {GRADUS_COMPONENT_TRACKED,            "Tracked",            1},
    {GRADUS_COMPONENT_IRRADIANCE_MOTION,  "Irradiance Motion",  4},
    {GRADUS_COMPONENT_IRRADIANCE_TRACKED, "Irradiance Tracked", 1},
    {GRADUS_COMPONENT_DEPTH,              "Depth",              1},
    {GRADUS_COMPONENT_UV,                 "UV",                 3},
    {GRADUS_COMPONENT_OBJECT_INDEX,       "Object Index",       1},
    {GRADUS_COMPONENT_FACE_INDEX,         "Face Index",         1},
    {GRADUS_COMPONENT_EMIT,               "Emit",               3},
};
// clang-format on

template <class Table>
constexpr bool is_in_order(const Table& table, uint32_t count) {
  for (uint32_t i = 0; i < std::size(table); ++i) {
    if (table[i].pass != i) return false;
  }
  return std::size(table) == count;
}
static_assert(is_in_order(kPasses, GRADUS_PASS_COUNT), "one row per GradusPass, in order");
static_assert(is_in_order(kComponentPasses, GRADUS_COMPONENT_PASS_COUNT), "one row per GradusComponentPass, in order");

uint64_t passes_that(bool (*are_such)(PassKind)) {
  uint64_t passes = 0;
  for (const PassInfo& info : kPasses) {
    if (are_such(info.kind)) passes |= uint64_t{1} << info.pass;
  }
  return passes;
}

bool is_stored(PassKind kind) {
  return kind != PassKind::Image && kind != PassKind::Derived && kind != PassKind::Solved && kind != PassKind::Sequence;
}

}  // namespace

const PassInfo& pass_info(uint32_t pass) {
  if (pass >= GRADUS_PASS_COUNT) throw invalid_argument("there is no pass " + std::to_string(pass));
  return kPasses[pass];
}

const ComponentPassInfo& component_pass_info(uint32_t pass) {
  if (pass >= GRADUS_COMPONENT_PASS_COUNT) throw invalid_argument("components have no pass " + std::to_string(pass));
  return kComponentPasses[pass];
}

bool wants_any(uint32_t component_passes, bool (*is_of_kind)(uint32_t component_pass)) {
  return std::any_of(std::begin(kComponentPasses), std::end(kComponentPasses),
                     [&](const ComponentPassInfo& info) { return wants(component_passes, info.pass) && is_of_kind(info.pass); });
}

uint64_t needed_passes(uint64_t passes) {
  for (const PassInfo& info : kPasses) {
    if (wants(passes, info.pass) && info.color != kNone) passes |= uint64_t{1} << info.color;
  }
  return passes;
}

std::vector<PassInfo> stored_passes(uint64_t passes) {
  std::vector<PassInfo> stored;
  const uint64_t needed = needed_passes(passes);
  for (const PassInfo& info : kPasses) {
    if (wants(needed, info.pass) && is_stored(info.kind)) stored.push_back(info);
  }
  return stored;
}

uint64_t pass_bytes_per_pixel(uint64_t passes) {
  uint64_t floats = 0;
  for (const PassInfo& info : stored_passes(passes)) {
    floats += info.channels * (is_in_halves(info.kind) ? 2 : 1) + (info.kind == PassKind::Weighted ? 1 : 0);
  }
  return floats * sizeof(float);
}

uint64_t feature_passes() {
  return passes_that([](PassKind kind) { return kind == PassKind::Feature; });
}

uint64_t light_passes() { return passes_that(is_of_light); }

}  // namespace gradus
