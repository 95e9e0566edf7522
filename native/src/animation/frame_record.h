// What a sequence keeps in memory of its frames, besides their files.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "film/film_header.h"
#include "motion/pixel_matching.h"
#include "output/developed_film.h"
#include "render/plan.h"
#include "render/stats.h"
#include "scene/snapshot.h"

namespace gradus::animation {

// Properties that frames must have in common to share a window, and those that identify the frame that is replayed.
struct FrameTraits {
  Region region;  // with its guard ring
  int channels = 0;
  bool gradients = false, features = false;
  GradusSettings settings{};
  int32_t stream = 0, replayed_stream = 0;     // frames whose random numbers the fresh and the replayed samples use
  uint64_t scene_key = 0, replayed_scene = 0;  // keys of the scenes of this and of the replayed frame; 0: not known
  uint32_t replayed_seed = 0;
  double fresh_samples = 0.0;  // per pixel
};
// Collects the traits of a frame from the headers of its fresh and its replayed samples.
FrameTraits traits_of(const film::FilmHeader& fresh, const film::FilmHeader& replayed);
// Whether the samples of `frame` replay another scene or another seed than those of `before`. Then one of the two
// frames was stored before the scene or the seed was changed.
bool follows_another_frame(const FrameTraits& before, const FrameTraits& frame);
// Whether one window can contain both frames: they have all planes that it reads, and belong to the same animation.
bool share_windows(const FrameTraits& before, const FrameTraits& frame, uint32_t reconstruction);

// The frame that the next sampled frame may replay.
struct PreviousFrame {
  std::shared_ptr<const scene::Snapshot> snapshot;
  GradusSettings settings{};
  // Frame whose random numbers the fresh samples use: this one, or the first one of a series of identical frames.
  int32_t stream_frame = 0;
  uint32_t net_samples = 0;       // of the film of the fresh samples, if samples are replayed
  std::vector<uint32_t> counts;   // samples of each pixel; empty: as many as in the settings, or not known
  std::optional<Region> sampled;  // region of the fresh samples; without a value: the frame was not sampled
  // View of `snapshot`, to which it points, in 36 bytes a pixel; null if the frame followed no other.
  std::shared_ptr<const motion::CentreView> centres;
};
// fresh: header of the fresh samples, or nullptr if the frame was not sampled.
std::unique_ptr<PreviousFrame> make_previous_frame(std::shared_ptr<const scene::Snapshot> snapshot,
                                                   const GradusSettings& settings, const film::FilmHeader* fresh);

// How a frame was sampled; the stats of its delivery start from it.
struct FrameRecord {
  render::Plan plan;
  render::RenderStats stats;
};

// A frame with its pictures.
struct DevelopedFrame {
  FrameRecord record;
  std::optional<output::Options> requested;  // options for which it was developed; without a value the stored ones
  output::DevelopedFilm pictures;            // of the fresh and the replayed samples, merged
};

// Whether pixels may have different numbers of samples. A replay then repeats the number of each pixel.
bool has_counts(const GradusSettings& settings);
// Whether frames with these settings show the same region and passes and are sampled alike, except for their frame
// numbers.
bool are_equivalent(const GradusSettings& a, const GradusSettings& b);
bool show_same_region(const GradusSettings& a, const GradusSettings& b);

}  // namespace gradus::animation
