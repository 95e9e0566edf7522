// An image between the centres of its pixels, by its derivatives of first and second order there. Within half a pixel,
// this neither smooths the image nor rings.
#pragma once

#include <vector>

#include "base/types.h"
#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Mean displacement, in pixels, and mean products of its coordinates, over samples that lie in one pixel.
struct Displacement {
  float x, y, xx, xy, yy;
};
inline Displacement displaced_by(const Vec2& by) { return {by.x, by.y, by.x * by.x, by.x * by.y, by.y * by.y}; }
inline constexpr int kDisplacementChannels = 5;  // of a field of displacements, in this order

// A row of one channel of an image and the rows above and below. The border pixels repeat.
class RowsAround {
 public:
  explicit RowsAround(int width);
  void read(const Field& image, int y, int channel);
  // Returns how the image changes, in the mean, from the centre of pixel x of the row to the displaced places.
  float change(int x, const Displacement& by) const {
    const float *below = row(-1) + x, *at = row(0) + x, *above = row(1) + x;
    const float along_x = at[1] - at[-1], along_y = above[0] - below[0];
    const float bend_x = at[1] + at[-1] - 2.0f * at[0], bend_y = above[0] + below[0] - 2.0f * at[0];
    const float twist = above[1] - above[-1] - below[1] + below[-1];
    return 0.5f * (by.x * along_x + by.xx * bend_x + by.y * along_y + by.yy * bend_y) + 0.25f * by.xy * twist;
  }

  // Returns the image, in the mean, at the places displaced from the centre of pixel x of the row, within the range of
  // the 3×3 pixels there.
  float limited(int x, const Displacement& by) const;

 private:
  const float* row(int j) const { return values_.data() + size_t(j + 1) * (size_t(width_) + 2) + 1; }

  int width_;
  std::vector<float> values_;
};

// Returns the mean of the image at the places to which the samples of each pixel are displaced.
Field displaced(const Field& image, const Field& displacements);
// Moves means of samples to the centres of their pixels: subtracts how `picture`, which shows the same, changes from
// there to the places to which the samples are displaced. No value becomes negative or loses its sign.
void move_to_centres(const Field& picture, const Field& displacements, Field* means);

}  // namespace gradus::reconstruct
