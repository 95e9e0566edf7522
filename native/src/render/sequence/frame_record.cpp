#include "render/sequence/frame_record.h"

#include <algorithm>

#include "settings/options.h"

namespace gradus {
namespace {

uint64_t key_without_frame(GradusSettings settings) {
  settings.frame = 0;
  return sampling_key(settings);
}

}  // namespace

std::unique_ptr<const FrameBefore> make_before(std::shared_ptr<const Snapshot> snapshot, const GradusSettings& settings,
                                               const Frame* base) {
  auto before = std::make_unique<FrameBefore>();
  before->snapshot = std::move(snapshot);
  before->settings = settings;
  before->stream_frame = base != nullptr ? base->frame_number : settings.frame;
  before->is_sampled = base != nullptr;
  if (base != nullptr && has_counts(settings)) before->counts = samples_of_pixels(*base);
  return before;
}

bool has_counts(const GradusSettings& settings) { return settings.noise_threshold > 0.0f || settings.time_limit > 0.0f; }

bool are_alike(const GradusSettings& a, const GradusSettings& b) {
  return key_without_frame(a) == key_without_frame(b) && a.passes == b.passes && show_same_region(a, b);
}

bool show_same_region(const GradusSettings& a, const GradusSettings& b) { return std::equal(a.region, a.region + 4, b.region); }

}  // namespace gradus
