#include "animation/frame_record.h"

#include <algorithm>

#include "animation/fresh_replayed_shares.h"
#include "base/fault.h"
#include "film/features.h"
#include "schema/options.h"

namespace gradus::animation {
namespace {

uint64_t key_without_frame(GradusSettings settings) {
  settings.frame = 0;
  return schema::sampling_key(settings);
}

// Whether the correspondence of a frame leads to the frame before. That of the first frame of a shot does not.
bool leads_to(const FrameTraits& before, const FrameTraits& frame) {
  return frame.stream == before.stream || frame.replayed_stream == before.stream;
}

}  // namespace

FrameTraits traits_of(const film::FilmHeader& fresh, const film::FilmHeader& replayed) {
  return {fresh.region,
          fresh.color_channels,
          fresh.gradients,
          film::has_features(fresh),
          fresh.settings,
          fresh.frame_number,
          replayed.replayed_frame,
          fresh.scene_key,
          replayed.replayed_key,
          replayed.replayed_seed,
          double(samples_taken(fresh))};
}

bool follows_another_frame(const FrameTraits& before, const FrameTraits& frame) {
  const uint32_t seed = before.settings.seed;
  if (frame.stream == before.stream) return frame.scene_key != before.scene_key || frame.settings.seed != seed;
  const bool shows_another = frame.replayed_scene != 0 && frame.replayed_scene != before.scene_key;
  return frame.replayed_stream == before.stream && (shows_another || frame.replayed_seed != seed);
}

bool share_windows(const FrameTraits& before, const FrameTraits& frame, uint32_t reconstruction) {
  const bool joins = reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED;
  if (joins && (before.features != frame.features || !leads_to(before, frame))) return false;
  return before.region == frame.region &&
         (GRADUS_FAULT(frames_with_and_without_alpha_share_windows) || before.channels == frame.channels) &&
         before.gradients == frame.gradients && !follows_another_frame(before, frame);
}

std::unique_ptr<PreviousFrame> make_previous_frame(std::shared_ptr<const scene::Snapshot> snapshot,
                                                   const GradusSettings& settings, const film::FilmHeader* fresh) {
  auto before = std::make_unique<PreviousFrame>();
  before->snapshot = std::move(snapshot);
  before->settings = settings;
  before->stream_frame = fresh != nullptr ? fresh->frame_number : settings.frame;
  if (fresh != nullptr) {
    before->sampled = fresh->region;
    if (takes_replays(settings)) before->net_samples = fresh->settings.net_samples;
  }
  return before;
}

bool has_counts(const GradusSettings& settings) {
  return settings.noise_threshold > 0.0f || settings.time_limit > 0.0f;
}

bool are_equivalent(const GradusSettings& a, const GradusSettings& b) {
  return key_without_frame(a) == key_without_frame(b) && a.passes == b.passes && show_same_region(a, b);
}

bool show_same_region(const GradusSettings& a, const GradusSettings& b) {
  return std::equal(a.region, a.region + 4, b.region);
}

}  // namespace gradus::animation
