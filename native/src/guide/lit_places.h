// Places from which light arrives at the surfaces of a part of the scene.
//
// The lobes of a mixture point to places instead of directions, so that they turn and widen as the receiver moves
// (Ruppert, Herholz and Lensch, "Robust fitting of parallax-aware mixtures for path guiding", 2020).
#pragma once

#include <span>

#include "guide/direction_mixture.h"

namespace gradus::guide {

// Light that a path has found, as seen from a point that all observations of a fit share.
struct Observation {
  Vec3 direction;         // unit vector
  float distance = 0.0f;  // to the surface that sent the light
  float weight = 0.0f;    // the light over the density with which the direction was sampled
};

class LitPlaces {
 public:
  // Fits a mixture to observations around `centre` by expectation maximisation. Without any light the mixture has no
  // preferred direction.
  LitPlaces(const Vec3& centre, std::span<const Observation> observations);
  // Sets the mixture as seen from a point of a surface with the unit normal `normal`. Lobes below the surface get
  // little weight.
  void see_from(const Vec3& position, const Vec3& normal, DirectionMixture* mixture) const;
  // Returns the weight of each lobe as a share of their sum.
  LobeValues shares() const;
  // Multiplies the weights by factors.
  void reweight(const LobeValues& factors);

 private:
  void place(size_t lobe, const Vec3& position, float concentration, float distance, float weight);

  LobeValues x_{}, y_{}, z_{};
  LobeValues sharpness_{};  // concentration over the squared distance
  LobeValues weight_{};
};

}  // namespace gradus::guide
