// A frame of a sequence with its delivered picture and passes, except for the passes by optical flow, which need
// several frames.
#pragma once

#include <memory>
#include <vector>

#include "animation/frame_record.h"
#include "film/film.h"
#include "output/light_passes.h"

namespace gradus::animation {

// Options that turn the samples of a frame into its picture. None is AUTO, except for the denoiser of a frame that
// another process sampled.
struct Delivery {
  uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2;
  float reconstruction_alpha = 0.0f;
  uint32_t denoiser = GRADUS_DENOISER_NONE;
  float film_exposure = 1.0f;
  bool operator==(const Delivery&) const = default;
};

struct DevelopedFrame {
  int32_t number = 0;
  Delivery by;
  FrameRecord record;
  std::shared_ptr<film::Film> film;            // fresh and replayed samples, merged
  std::vector<float> combined, error;          // RGBA of the delivered region; pass Error, empty if not requested
  std::vector<std::vector<float>> components;  // RGB of each component; empty if no pass or flow reads them
  output::LightPasses light;
  // Passes Gradient T and Gradient T Link, towards the next frame: three values for each pixel of the region.
  std::vector<float> difference, link;

  const Region& delivered() const { return record.plan.delivered; }
};

}  // namespace gradus::animation
