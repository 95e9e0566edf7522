#include "reconstruct/space_time/links.h"

#include <string>

#include "base/error.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus {

void Links::set_row(int y, const int32_t* targets, std::vector<bool>* taken) {
  Shift* shift = shifts_.data() + size_t(y) * size_t(width_);
  for (int x = 0; x < width_; ++x) {
    const int32_t target = targets[x];
    if (target == kNoLink) {
      shift[x] = kNone;
      continue;
    }
    if (target < 0 || target >= width_ * height_) throw invalid_argument("a link leads out of the frame");
    if ((*taken)[size_t(target)]) throw invalid_argument("two pixels are linked to the same one");
    (*taken)[size_t(target)] = true;
    shift[x] = ((target / width_ - y) * (1 << 16)) | ((target % width_ - x) & 0xffff);
  }
}

}  // namespace gradus
