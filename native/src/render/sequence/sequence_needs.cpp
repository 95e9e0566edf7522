#include "render/sequence/sequence_needs.h"

#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <filesystem>

#include "base/temporary_folder.h"
#include "frame/pass_planes.h"
#include "settings/pass_table.h"

namespace gradus {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kFloat = sizeof(float);
constexpr uint64_t kLink = sizeof(int32_t) + sizeof(Vec2);  // of a pixel (frame/links.h)

struct Sizes {
  uint64_t frame, channels, halves, kinds;  // bytes of a frame's samples; images of each half; kinds of rows in space
  uint64_t components;                      // that are reconstructed together
};

// Images of both parts of a frame, and what links them to the frame before (temporal/temporal_frame.h).
uint64_t temporal_frame_bytes(const Sizes& s) { return s.components * (2 * s.kinds * (1 + s.halves) * s.channels * kFloat + 2 * kLink); }

// Of a window's pixels: four fields and the grids of their solver (reconstruct/space_time/window_solver.h), as measured; with the errors
// what L2 makes of the noise, and of the values where the picture is not L2's.
uint64_t solver_bytes(const Sizes& s, const SequenceMethod& method) {
  const uint64_t fields = 64 * std::min<uint64_t>(s.channels, 3) / 3 + 32,
                 errors = method.reconstruction == GRADUS_RECONSTRUCTION_L2 ? 24 : 36;
  return fields + (method.with_error ? errors : 0);
}

// Of a window's pixels, by REGULARIZED (reconstruct/space_time/regularized_windows.h): components' pictures, changes and links, and of all
// together errors and weights; and what their tracks are solved to, when all frames are there.
uint64_t held_bytes(const Sizes& s) { return (s.components * (2 * s.channels + 1) + 3) * kFloat; }
uint64_t estimate_bytes(const Sizes& s) { return held_bytes(s) + (s.components * (s.channels + 1) + 2) * kFloat; }

// Of a picture's pixels, which a window holds until it is asked for; parts: components. Each has a window of its own, and the terms of its
// error, or all have one.
uint64_t picture_bytes(const Sizes& s, uint64_t parts, const SequenceMethod& method) {
  if (method.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) return ((parts > 1 ? 1 + parts : 1) * s.channels + 1) * kFloat;
  const uint64_t terms = !method.with_error ? 0 : method.reconstruction == GRADUS_RECONSTRUCTION_L2 ? 1 : 2;
  return (parts * (s.channels + 3 * terms) + 1) * kFloat;
}

// Of a frame's pixels: features of two and the regression of one of them, beside the samples of one frame.
constexpr uint64_t kRegression = (2 * 14 + 63) * kFloat;

uint64_t delivery_bytes(const Sizes& s, const SequenceMethod& method, uint64_t frames) {
  const uint64_t loading = 2 * s.frame + 2 * temporal_frame_bytes(s);
  if (method.reconstruction != GRADUS_RECONSTRUCTION_REGULARIZED) return std::max(loading, frames * solver_bytes(s, method));
  const uint64_t regressing = std::max(loading, s.frame + temporal_frame_bytes(s) + kRegression);
  return std::max(frames * held_bytes(s) + regressing, frames * estimate_bytes(s));
}

// Between two frames at once (motion/irradiance_motion.h): light, known motion and objects of both, levels, and for either way the vectors,
// images and equations of their refinement, and what OpenCV takes.
constexpr uint64_t kFlow = 440;

// The frame that is made ahead, and flows with their ways back.
uint64_t flow_bytes(const Sizes& s, const Plan& plan) {
  const auto components = uint64_t(plan.components.count()), light = uint64_t(std::popcount(plan.passes & light_passes()));
  const uint64_t pictures = 3 * (components + light) * kFloat, kinds = components + 1;
  return s.frame + 11 * kFloat + 2 * pictures + kinds * 3 * (sizeof(Vec2) + sizeof(float)) + kinds * (sizeof(Vec4) + sizeof(float));
}

std::string gibibytes(uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f GiB", double(bytes) / double(uint64_t{1} << 30));
  return text;
}

// Folders on one disk.
struct Disk {
  std::string folders;
  uint64_t bytes = 0, available = 0;
};

// Of those that can be looked at.
std::vector<Disk> disks_of(const FolderBytes& files) {
  std::map<dev_t, Disk> disks;
  for (const auto& [folder, bytes] : files) {
    std::error_code unknown;
    const fs::space_info space = fs::space(folder, unknown);
    struct stat status {};
    if (unknown || stat(folder.c_str(), &status) != 0) continue;
    Disk& disk = disks[status.st_dev];
    disk.folders += (disk.folders.empty() ? "" : " and ") + folder;
    disk.bytes += bytes;
    disk.available = space.available;
  }
  std::vector<Disk> list;
  for (const auto& [device, disk] : disks) list.push_back(disk);
  return list;
}

bool is_memory(const std::string& folder) {
  struct statfs status {};
  return statfs(folder.c_str(), &status) == 0 && (status.f_type == TMPFS_MAGIC || status.f_type == RAMFS_MAGIC);
}

}  // namespace

PlannedBytes planned_bytes(const Plan& plan, const SequenceMethod& method, const WindowShape& windows, int count, bool keeps,
                           bool with_flow) {
  const bool regularized = method.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED;
  const uint64_t area = uint64_t(plan.sampled.area()), channels = uint64_t(plan.channels);
  const Sizes sizes{frame_bytes_per_pixel(plan.components.count(), plan.gradients, plan.passes,
                                          {plan.rough_vertices, plan.rough_details, plan.component_motion, plan.component_motion}),
                    channels, uint64_t(regularized || method.with_error ? 1 : 0), uint64_t(plan.gradients && !regularized ? 3 : 1),
                    uint64_t(regularized ? plan.components.count() : 1)};
  const uint64_t all = uint64_t(count), in_window = keeps ? uint64_t(windows.frames) : std::min(all, uint64_t(windows.frames));
  const uint64_t ahead = std::min(all, uint64_t(2 * windows.frames - windows.overlap));

  const uint64_t delivered = sizes.frame + 11 * kFloat,
                 pictures = in_window * picture_bytes(sizes, uint64_t(plan.components.count()), method);
  // Where components go by themselves: their ways, links, and what is sampled along them.
  const uint64_t own = plan.components.count() > 1 ? uint64_t(plan.components.count()) * (3 * kLink + sizeof(Vec2)) : 0;
  const uint64_t sampling = 2 * sizes.frame + 2 * 4 * kFloat + 2 * kLink + own;
  PlannedBytes needs;
  needs.memory = area * std::max(sampling, delivered + pictures + delivery_bytes(sizes, method, in_window));
  needs.kept = area * (pictures + (regularized ? temporal_frame_bytes(sizes) + in_window * estimate_bytes(sizes) : 0));
  if (with_flow && plan.component_motion) {
    const uint64_t flow = flow_bytes(sizes, plan);
    needs.memory += area * (flow + kFlow);
    needs.kept += area * flow;
  }
  needs.frames = area * (keeps ? all : ahead) * 2 * (sizes.frame + kLink);
  if (!regularized) needs.temporary = area * in_window * (2 * sizes.kinds * (1 + sizes.halves) * channels * kFloat + sizeof(int32_t));
  return needs;
}

Claim claim_of(const PlannedBytes& needs, const std::string& frames) {
  Claim claim{needs.memory, needs.kept, {{frames, needs.frames}}};
  claim.files[temporary_place()] += needs.temporary;
  return claim;
}

uint64_t bytes_in_memory(const FolderBytes& files) {
  uint64_t sum = 0;
  for (const auto& [folder, bytes] : files) sum += is_memory(folder) ? bytes : 0;
  return sum;
}

std::vector<std::string> lacking_room(const FolderBytes& files) {
  std::vector<std::string> lines;
  for (const Disk& disk : disks_of(files)) {
    if (disk.available >= disk.bytes) continue;
    lines.push_back("files of the animation in " + disk.folders + " take up to " + gibibytes(disk.bytes) + ", and there is room for " +
                    gibibytes(disk.available));
  }
  return lines;
}

}  // namespace gradus
