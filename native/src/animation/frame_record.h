// What a sequence remembers of its frames, besides their files.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "film/film_header.h"
#include "render/plan.h"
#include "render/stats.h"
#include "scene/snapshot.h"

namespace gradus::animation {

// What frames must have in common to share a window, and whom a frame follows.
struct FrameTraits {
  Region region;  // with its guard ring
  int channels = 0;
  bool gradients = false, features = false;
  GradusSettings settings{};
  int32_t stream = 0, replayed_stream = 0;     // whose random numbers its own half has taken, and whose the other has
  uint64_t scene_key = 0, replayed_scene = 0;  // 0: not known
  uint32_t replayed_seed = 0;
};
// base, offset: its own half, and the one that replays the frame before.
FrameTraits traits_of(const film::FilmHeader& fresh, const film::FilmHeader& replayed);
// Whether `frame` follows another scene than `before` shows, or other samples of it: one of the two was stored before
// the scene or the seed was changed.
bool follows_another_frame(const FrameTraits& before, const FrameTraits& frame);
// Whether one window can hold both: they have all that it reads of its frames, and are of one animation.
bool share_windows(const FrameTraits& before, const FrameTraits& frame, uint32_t reconstruction);

// The frame before the next one that is sampled.
struct PreviousFrame {
  std::shared_ptr<const scene::Snapshot> snapshot;
  GradusSettings settings{};
  int32_t stream_frame =
      0;  // whose random numbers it has taken: its own, or those of the first of several that are alike
  std::vector<uint32_t> counts;   // samples of each pixel; empty: as many as the settings say, or not known
  std::optional<Region> sampled;  // region of its own half; nothing: it was not sampled
};
// base: its own half; nullptr where it was not sampled.
std::unique_ptr<PreviousFrame> make_previous_frame(std::shared_ptr<const scene::Snapshot> snapshot,
                                                   const GradusSettings& settings, const film::FilmHeader* fresh);

// How a frame was sampled, for the stats of its delivery.
struct FrameRecord {
  render::Plan plan;
  render::RenderStats stats;
};

// Whether pixels may differ in their samples, which a replay then repeats.
bool has_counts(const GradusSettings& settings);
// Whether frames with these settings show the same region with the same passes, sampled alike but for their numbers.
bool are_equivalent(const GradusSettings& a, const GradusSettings& b);
bool show_same_region(const GradusSettings& a, const GradusSettings& b);

}  // namespace gradus::animation
