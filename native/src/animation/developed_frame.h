// A frame of a sequence as it is delivered, but for what is made of several frames.
#pragma once

#include <memory>
#include <vector>

#include "animation/frame_record.h"
#include "film/film.h"
#include "output/light_passes.h"

namespace gradus::animation {

// What its picture is made by; never AUTO but for the denoiser of a frame that was sampled elsewhere.
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
  std::shared_ptr<film::Film> film;            // all of its samples
  std::vector<float> combined, error;          // of the region: RGBA, and pass Error where it is asked for
  std::vector<std::vector<float>> components;  // RGB of each, where some pass or flow is made of it
  output::LightPasses light;
  std::vector<float> difference, link;  // to the next frame; three values per pixel of the region

  const Region& delivered() const { return record.plan.delivered; }
};

}  // namespace gradus::animation
