#include "frame/pass_planes.h"

#include <algorithm>

#include "settings/pass_table.h"

namespace gradus {

std::vector<PassPlane> make_pass_planes(uint64_t passes, size_t pixels) {
  std::vector<PassPlane> planes;
  for (const PassInfo& info : stored_passes(passes)) {
    PassPlane& plane = planes.emplace_back();
    plane.pass = info.pass;
    plane.channels = info.channels;
    plane.first_sample_only = info.kind == PassKind::First;
    plane.skips_transparent = info.kind == PassKind::Weighted;
    plane.in_halves = is_in_halves(info.kind);
    for (int half = 0; half < (plane.in_halves ? kHalves : 1); ++half) plane.values[half].assign(pixels * info.channels, 0.0f);
    if (plane.skips_transparent) plane.weight.assign(pixels, 0.0f);
  }
  return planes;
}

void keep_of_components(const KeptOfComponents& kept, Frame* frame) {
  const auto pixels = size_t(frame->region.area());
  for (ComponentPlanes& planes : frame->components) {
    for (auto& half : planes.rough) half.assign(kept.rough ? pixels : 0, RoughVertices{});
    planes.details.assign(kept.details ? pixels : 0, RoughDetails{});
    planes.motion.assign(kept.motion ? pixels : 0, Vec4(0.0f));
    planes.tracked.assign(kept.motion ? pixels : 0, kNothingToTrack);
    planes.shown.assign(kept.shown ? pixels : 0, ShownPoint{});
  }
}

KeptOfComponents kept_of_components(const Frame& frame) {
  const ComponentPlanes& planes = frame.components.front();
  return {!planes.rough[0].empty(), !planes.details.empty(), !planes.motion.empty(), !planes.shown.empty()};
}

uint64_t kept_passes(const Frame& frame) {
  uint64_t passes = 0;
  for (const PassPlane& plane : frame.passes) passes |= uint64_t{1} << plane.pass;
  return passes;
}

const PassPlane* find_plane(const Frame& frame, uint32_t pass) {
  const auto plane = std::find_if(frame.passes.begin(), frame.passes.end(), [&](const PassPlane& p) { return p.pass == pass; });
  return plane != frame.passes.end() ? &*plane : nullptr;
}

uint64_t frame_bytes_per_pixel(int components, bool gradients, uint64_t passes, const KeptOfComponents& kept) {
  const uint64_t offsets = gradients ? uint64_t{kOffsets} : 0, radiances = uint64_t(components) * (1 + offsets);
  const uint64_t features = kept.rough ? uint64_t(components) * sizeof(RoughVertices) : 0;
  const uint64_t half = radiances * sizeof(Radiance) + features + sizeof(uint32_t) + offsets * sizeof(float);
  const uint64_t others =
      (kept.details ? sizeof(RoughDetails) : 0) + (kept.motion ? sizeof(Vec4) + sizeof(float) : 0) + (kept.shown ? sizeof(ShownPoint) : 0);
  return kHalves * half + uint64_t(components) * others + pass_bytes_per_pixel(passes) +
         (wants(passes, GRADUS_PASS_FALLBACK) ? sizeof(float) : 0);
}

}  // namespace gradus
