// Motion of components, and simpler answers to the same question, against the truth that brute force finds.
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

// What simpler formulas say of where a chain goes, next to an answer of another kind.
class SimplerMotion {
 public:
  SimplerMotion(const motion::ChainTracer& here, const motion::ChainTracer& next)
      : here_(here), next_(next), surface_(here.snapshot(), next.snapshot()) {}

  void add(const motion::SpecularChain& chain, const Vec2& place);
  nlohmann::ordered_json json() {
    return {{"motion_of_first_surface", first_.json()},
            {"flat_resting_mirror", static_mirror_.json()},
            {"flat_moving_mirror", along_.json()}};
  }

 private:
  const motion::ChainTracer &here_, &next_;
  motion::SnapshotMotion surface_;
  Distances first_, static_mirror_, along_;
};

// The scene in small steps from its frame to the next one, in which what pixels show is followed.
class StepsBetween {
 public:
  // farthest: pixels that anything moves, or nearly.
  StepsBetween(const scene::Snapshot& snapshot, const GradusSettings& settings, double farthest);

  // Of about `pixels` pixels spread evenly over those of the view in which something changes.
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

// The quantile of 99 % of all ways that are known: those found, and those of surfaces.
double farthest_displacement(const motion::ChainTracer& next, const std::vector<motion::ChainView>& views,
                             const std::vector<motion::ChainMotion>& found);

}  // namespace gradus::tool
