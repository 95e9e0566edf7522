// The normal equations of a window. Rows along the links are differences d of linked pixels, and what their weights
// make of d is a screened Laplacian K on the first frame's grid. So A = AᵀWA is block tridiagonal:
//   xᵀA x = Σ_t x_tᵀ B_t x_t + Σ_t d_tᵀ K_t d_t,   d_t = F_t x_{t+1} − x_t,
// with F_t reading frame t + 1 along the links.
#pragma once

#include <vector>

#include "base/rows.h"
#include "reconstruct/field.h"
#include "reconstruct/space_time/correspondence_map.h"
#include "reconstruct/space_time/screened_laplacian.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::reconstruct {

using Frames = std::vector<Field>;

class SpaceTimeSystem {
 public:
  // All weights 0, but the links are there.
  explicit SpaceTimeSystem(const WindowSource& source);

  int width() const { return frames_.front().width(); }
  int height() const { return frames_.front().height(); }
  int frames() const { return int(frames_.size()); }
  Frames make_fields(int channels) const { return Frames(frames_.size(), Field(width(), height(), channels)); }

  ScreenedLaplacian& frame(int t) { return frames_[size_t(t)]; }
  const ScreenedLaplacian& frame(int t) const { return frames_[size_t(t)]; }
  // From frame t to the next.
  ScreenedLaplacian& coupling(int t) { return couplings_[size_t(t)]; }
  const ScreenedLaplacian& coupling(int t) const { return couplings_[size_t(t)]; }
  const CorrespondenceMap& correspondence(int t) const { return correspondence_[size_t(t)]; }

  // The plane that holds the weights of a kind of rows.
  WeightPlane& weights(RowKind kind, int t);
  // Writes weights of a row; those of rows that the system has not become 0.
  void set_weights(RowKind kind, int t, int y, float* values);

  // out = A x; returns xᵀA x.
  Sums multiply(const Frames& x, Frames* out) const;
  // out = Aᵀ W b, b the values of the rows: channels [first, first + channels of out).
  void right_side(const WindowSource& source, int first_channel, Frames* out) const;

 private:
  RowSums multiply_frame(int t, const Field& x, Field* out) const;
  RowSums multiply_coupling(int t, const Field& x, const Field& next, Field* out, Field* next_out) const;

  std::vector<ScreenedLaplacian> frames_, couplings_;
  std::vector<CorrespondenceMap> correspondence_;
};

}  // namespace gradus::reconstruct
