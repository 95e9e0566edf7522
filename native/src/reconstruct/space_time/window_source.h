// Input of a space-time reconstruction: rows of a window's frames. They are read anew whenever they are needed, so that
// the frames need not be in memory.
#pragma once

#include <cstdint>

#include "film/replay_map.h"

namespace gradus::reconstruct {

// Kinds of rows of the system. The last three belong to a frame and the next one, along the pixel correspondence φ
// between them. For pixel i of frame t, with D a difference to the right (Dx) or upwards (Dy):
//   dt    x(φ(i), t+1) − x(i, t)
//   dxdt  Dx x(φ(i), t+1) − Dx x(i, t)
//   dydt  Dy x(φ(i), t+1) − Dy x(i, t)
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
  // Reads row y of frame t, with interleaved channels. A value that is not finite is missing, and its row is left out
  // of the system. Differences beyond the border, temporal rows without a correspondence, and mixed rows between pixels
  // that do not remain neighbours are left out, too, whatever is read for them. Temporal rows are read for all frames
  // except the last. Called from several threads.
  virtual void read_row(RowKind kind, int t, int y, float* out) const = 0;
  // Reads the pixels of frame t + 1 that correspond to those of row y of frame t, as y·width + x, or kNoCorrespondence.
  // No two pixels of frame t correspond to the same pixel.
  virtual void read_correspondence(int t, int y, int32_t* out) const = 0;
};

// A window source with half-buffers, from which the noise of every channel is known.
class HalvedWindowSource : public WindowSource {
 public:
  // Reads (A − B)/2 of the two half-buffers of read_row()'s values.
  virtual void read_half_differences(RowKind kind, int t, int y, float* out) const = 0;
};

}  // namespace gradus::reconstruct
