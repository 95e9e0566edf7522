#include "render/memory_estimate.h"

#include <algorithm>
#include <bit>
#include <filesystem>
#include <system_error>

#include "film/planes.h"
#include "film/replay_map.h"
#include "schema/pass_table.h"

namespace gradus::render {
namespace {

// Bytes per pixel, as measured by tests/memory/memory_estimate_test.cpp.
constexpr uint64_t kPicture = 8 * sizeof(float);  // the shown and the delivered image, RGBA each
constexpr uint64_t kReconstruction =
    260;                             // images, features or weights, and the work space of a solver or a regression
constexpr uint64_t kDenoiser = 900;  // the network of Open Image Denoise, with its input and output
constexpr uint64_t kReconstructedComponent = 48;  // images of a component, while those of the others are made
constexpr uint64_t kWindowFrame = 100;            // a frame of a window, while the window is solved
constexpr uint64_t kJoinedComponent = 16;         // a component of a frame that REGULARIZED joins with others
constexpr uint64_t kJoinedAlpha = 8;              // the alpha of such a frame
constexpr uint64_t kJoinedLightPass = 48;         // a light pass of joined frames, and of the one that is added

uint64_t frame_bytes(const Plan& plan) {
  std::vector<film::ChannelInfo> channels = film::channels_of_passes(plan.passes);
  channels.insert(channels.end(), plan.scene_channels.begin(), plan.scene_channels.end());
  return film::film_bytes_per_pixel(
      plan.components.count(), plan.gradients, channels,
      {plan.non_specular_vertices, plan.non_specular_details, plan.component_motion, plan.component_motion});
}

uint64_t reconstruction_bytes(const Plan& plan) {
  const auto components = uint64_t(plan.components.count());
  uint64_t bytes = kPicture;
  if (plan.solves || plan.adaptive) bytes += kReconstruction;
  if (components > 1) bytes += components * kReconstructedComponent;
  if (plan.denoises) bytes += kDenoiser;
  return bytes;
}

std::string gibibytes(uint64_t bytes) { return std::to_string((bytes + (uint64_t{1} << 29)) >> 30) + " GiB"; }

}  // namespace

uint64_t estimated_memory(const Plan& plan) {
  return uint64_t(plan.sampled.area()) * (frame_bytes(plan) + reconstruction_bytes(plan));
}

uint64_t estimated_memory(const Plan& plan, const reconstruct::WindowShape& windows) {
  const auto components = uint64_t(plan.components.count());
  // REGULARIZED holds one record for all components of a frame. Other methods solve the window of each by itself.
  const bool has_alpha = plan.channels > 3;
  const uint64_t of_components =
      (components > 1 || has_alpha ? components * kJoinedComponent : 0) + (has_alpha ? kJoinedAlpha : 0);
  const bool joins = plan.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED;
  const uint64_t of_frame = joins ? kWindowFrame + of_components : components * kWindowFrame;
  const uint64_t of_window = uint64_t(windows.frames) * of_frame;
  const auto light_passes =
      uint64_t(std::popcount(plan.passes & schema::light_passes()) +
               std::ranges::count(plan.scene_channels, film::ValueType::kRadiance, &film::ChannelInfo::type));
  const uint64_t of_light = joins && light_passes > 0 ? (light_passes + 1) * kJoinedLightPass : 0;
  return uint64_t(plan.sampled.area()) * (2 * frame_bytes(plan) + reconstruction_bytes(plan) + of_window + of_light);
}

// A frame is stored in two files, the second with its pixel correspondence to the previous frame.
uint64_t estimated_files(const Plan& plan, int frames) {
  return uint64_t(plan.sampled.area()) * uint64_t(frames) * 2 * (frame_bytes(plan) + sizeof(int32_t) + sizeof(Vec2));
}

std::string memory_warning(uint64_t estimate, uint64_t available) {
  if (available == 0 || estimate <= available) return "";
  return "the render takes about " + gibibytes(estimate) + " of memory, and the machine has " + gibibytes(available) +
         ": render fewer pixels, passes or components";
}

std::string disk_warning(uint64_t estimate, const std::string& folder) {
  std::error_code unknown;
  const std::filesystem::space_info space = std::filesystem::space(folder, unknown);
  if (unknown || estimate <= space.available) return "";
  return "files of the animation in " + folder + " take up to " + gibibytes(estimate) + ", and there is room for " +
         gibibytes(space.available);
}

}  // namespace gradus::render
