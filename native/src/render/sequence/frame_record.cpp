#include "render/sequence/frame_record.h"

#include <algorithm>

#include "frame/features.h"
#include "settings/options.h"

namespace gradus {
namespace {

uint64_t key_without_frame(GradusSettings settings) {
  settings.frame = 0;
  return sampling_key(settings);
}

}  // namespace

FrameForm form_of(const FrameHeader& frame) { return {frame.region, frame.channels, frame.gradients, has_features(frame), frame.settings}; }

bool share_windows(const FrameForm& a, const FrameForm& b, uint32_t reconstruction) {
  const bool features = a.features == b.features || reconstruction != GRADUS_RECONSTRUCTION_REGULARIZED;
  return a.region == b.region && a.channels == b.channels && a.gradients == b.gradients && features;
}

std::unique_ptr<FrameBefore> make_before(std::shared_ptr<const Snapshot> snapshot, const GradusSettings& settings,
                                         const FrameHeader* base) {
  auto before = std::make_unique<FrameBefore>();
  before->snapshot = std::move(snapshot);
  before->settings = settings;
  before->stream_frame = base != nullptr ? base->frame_number : settings.frame;
  if (base != nullptr) before->form = form_of(*base);
  return before;
}

bool has_counts(const GradusSettings& settings) { return settings.noise_threshold > 0.0f || settings.time_limit > 0.0f; }

bool are_alike(const GradusSettings& a, const GradusSettings& b) {
  return key_without_frame(a) == key_without_frame(b) && a.passes == b.passes && show_same_region(a, b);
}

bool show_same_region(const GradusSettings& a, const GradusSettings& b) { return std::equal(a.region, a.region + 4, b.region); }

}  // namespace gradus
