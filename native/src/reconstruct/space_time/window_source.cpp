#include "reconstruct/space_time/window_source.h"

#include <algorithm>

namespace gradus::reconstruct {

void HalvedWindowSource::read_off_centre(int, int, Vec2* out) const { std::fill_n(out, size().width, Vec2(0.0f)); }

}  // namespace gradus::reconstruct
