// What a space-time reconstruction reads: rows of a window's frames, each as often as it is needed, so that inputs need
// not be resident.
#pragma once

#include <cstdint>

#include "film/pixel_correspondence.h"

namespace gradus::reconstruct {

// Kinds of rows of the system. The last three belong to a frame and the next one, along the links φ between them: of
// pixel i of frame t, with D to the right or up,
//   dt    x(φ(i), t+1) − x(i, t)
//   dxdt  Dx x(φ(i), t+1) − Dx x(i, t), and dydt likewise with Dy.
enum class RowKind { kPrimal, kDx, kDy, kDt, kDxDt, kDyDt };
inline constexpr RowKind kRowKinds[] = {RowKind::kPrimal, RowKind::kDx,   RowKind::kDy,
                                        RowKind::kDt,     RowKind::kDxDt, RowKind::kDyDt};
inline constexpr bool is_temporal(RowKind kind) { return kind >= RowKind::kDt; }

struct WindowSize {
  int width = 0, height = 0, channels = 0, frames = 0;
};

class WindowSource {
 public:
  virtual ~WindowSource() = default;
  virtual WindowSize size() const = 0;
  // Row y of frame t, channels interleaved. A value that is not finite is missing: its row is left out of the system.
  // So are differences beyond the border, temporal rows without a link, and mixed ones between pixels that do not stay
  // neighbours; whatever is read for these. Temporal rows are read of all frames but the last. Called from several
  // threads.
  virtual void read_row(RowKind kind, int t, int y, float* out) const = 0;
  // The pixels of frame t + 1 that those of row y of frame t are linked to, as y·width + x, or kNoCorrespondence.
  // One-to-one.
  virtual void read_correspondence(int t, int y, int32_t* out) const = 0;
};

// With the noise of every channel.
class HalvedWindowSource : public WindowSource {
 public:
  // (A − B)/2 of the two halves of what read_row() gives.
  virtual void read_half_differences(RowKind kind, int t, int y, float* out) const = 0;
  // Where ways to linked pixels end, from the middle of these (PixelCorrespondence::off_centre). By default there.
  virtual void read_off_centre(int t, int y, Vec2* out) const;
};

}  // namespace gradus::reconstruct
