// Normal equations of a window. Temporal and mixed rows contain only differences d of corresponding pixels, and their
// weights form a screened Laplacian K on the grid of the earlier frame. The matrix A of the normal equations is
// therefore block tridiagonal:
//   xᵀA x = Σ_t x_tᵀ B_t x_t + Σ_t d_tᵀ K_t d_t,   d_t = F_t x_{t+1} − x_t,
// where F_t reads frame t + 1 at the corresponding pixels.
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
  // Reads the correspondences of a window; all weights are 0.
  explicit SpaceTimeSystem(const WindowSource& source);

  int width() const { return frames_.front().width(); }
  int height() const { return frames_.front().height(); }
  int frames() const { return int(frames_.size()); }
  Frames make_fields(int channels) const { return Frames(frames_.size(), Field(width(), height(), channels)); }

  ScreenedLaplacian& frame(int t) { return frames_[size_t(t)]; }
  const ScreenedLaplacian& frame(int t) const { return frames_[size_t(t)]; }
  // Returns K_t, which couples frame t with the next.
  ScreenedLaplacian& coupling(int t) { return couplings_[size_t(t)]; }
  const ScreenedLaplacian& coupling(int t) const { return couplings_[size_t(t)]; }
  const CorrespondenceMap& correspondence(int t) const { return correspondence_[size_t(t)]; }

  // Returns the plane that holds the weights of a kind of rows.
  WeightPlane& weights(RowKind kind, int t);
  // Sets the weights of an image row. Values of rows that the system does not have are set to 0, in `values`, too.
  void set_weights(RowKind kind, int t, int y, float* values);

  // Computes out = A x and returns xᵀA x.
  Sums multiply(const Frames& x, Frames* out) const;
  // Computes the right side of the normal equations from the values of the rows, for as many channels as `out` has,
  // from `first_channel` on.
  void right_side(const WindowSource& source, int first_channel, Frames* out) const;

 private:
  RowSums multiply_frame(int t, const Field& x, Field* out) const;
  RowSums multiply_coupling(int t, const Field& x, const Field& next, Field* out, Field* next_out) const;

  std::vector<ScreenedLaplacian> frames_, couplings_;
  std::vector<CorrespondenceMap> correspondence_;
};

}  // namespace gradus::reconstruct
