// Compares the motion of components, and simpler estimates of it, with the result of a brute-force search.
#pragma once

#include <memory>
#include <vector>

#include <nlohmann/json.hpp>

#include "motion/snapshot_motion.h"
#include "motion/specular_motion.h"

namespace gradus::tool {

// Distances in pixels between two answers.
class Distances {
 public:
  void add(double pixels) { pixels_.push_back(pixels); }
  nlohmann::ordered_json json();

 private:
  std::vector<double> pixels_;
};

// Measures how far simpler formulas for the motion of a specular chain differ from a given place on the film.
class SimplerMotion {
 public:
  SimplerMotion(const motion::ChainTracer& here, const motion::ChainTracer& next)
      : here_(here), next_(next), surface_(here.snapshot(), next.snapshot()) {}

  void add(const motion::SpecularChain& chain, const Vec2& place);
  nlohmann::ordered_json json() {
    return {{"motion_of_first_surface", first_.json()},
            {"flat_static_mirror", static_mirror_.json()},
            {"flat_moving_mirror", along_.json()}};
  }

 private:
  const motion::ChainTracer &here_, &next_;
  motion::SnapshotMotion surface_;
  Distances first_, static_mirror_, along_;
};

// The scene in small time steps from its frame to the next one, through which the content of pixels is tracked.
class StepsBetween {
 public:
  // `farthest` is a high quantile of all motions in pixels. It sets the number of steps.
  StepsBetween(const scene::Snapshot& snapshot, const GradusSettings& settings, double farthest);

  // Compares the motion of about `pixels` pixels, which are spread evenly over those of the view that are not static.
  nlohmann::ordered_json check(const motion::ChainView& view, const motion::ChainMotion& found, size_t pixels) const;

 private:
  struct Film {
    Film(std::shared_ptr<const scene::Snapshot> snapshot, const GradusSettings& settings);
    Film(const Film&) = delete;

    std::shared_ptr<const scene::Snapshot> snapshot;
    camera::Camera camera;
    motion::ChainTracer tracer;
  };
  double farthest_;
  std::vector<std::unique_ptr<Film>> frames_;
};

// Returns the 99 % quantile of all known displacements on the film in pixels: tracked ones and those of surfaces.
double farthest_displacement(const motion::ChainTracer& next, const std::vector<motion::ChainView>& views,
                             const std::vector<motion::ChainMotion>& found);

}  // namespace gradus::tool
