// REGULARIZED: the features of the frame, its samples and, where there are any, its sampled differences.
#pragma once

#include <optional>

#include "frame/features.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/solver.h"

namespace gradus {

// What a frame's components are regressed on, as filter_features() leaves it.
class ComponentGuides {
 public:
  // The frame lives as long.
  explicit ComponentGuides(const Frame& frame) : frame_(frame) {}
  // Its own features, or those of the frame, which are filtered once. Until the next call. Throws invalid_operation for a frame without.
  const Features& of(int component);

 private:
  const Frame& frame_;
  std::optional<Features> own_, shared_;
};

// With its error, always. Throws invalid_operation for a frame without features.
Reconstructed regularize(const Frame& frame, int component, const CancelTest& cancel, SolveReport* report);
// The same by its guides.
Reconstructed regularize(const Frame& frame, int component, const Features& features, const CancelTest& cancel, SolveReport* report);

}  // namespace gradus
