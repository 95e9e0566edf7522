#include "reconstruct/space_time/correspondence_map.h"

#include <cstdlib>
#include <string>

#include "base/error.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::reconstruct {

void CorrespondenceMap::set_row(int y, const int32_t* targets, std::vector<bool>* taken) {
  Shift* shift = shifts_.data() + size_t(y) * size_t(width_);
  for (int x = 0; x < width_; ++x) {
    const int32_t target = targets[x];
    if (target == film::kNoCorrespondence) {
      shift[x] = kNone;
      continue;
    }
    if (target < 0 || target >= int64_t(width_) * height_)
      throw invalid_argument("a correspondence leads out of the frame");
    if ((*taken)[size_t(target)]) throw invalid_argument("two pixels correspond to the same one");
    (*taken)[size_t(target)] = true;
    const int aside = target % width_ - x, up = target / width_ - y;
    const bool fits = std::abs(aside) <= INT16_MAX && std::abs(up) < INT16_MAX;
    shift[x] = fits ? (up * (1 << 16)) | (aside & 0xffff) : kNone;
  }
}

CorrespondenceMap read_correspondence(const WindowSource& source, int t) {
  const WindowSize size = source.size();
  CorrespondenceMap correspondence(size.width, size.height);
  std::vector<int32_t> row(static_cast<size_t>(size.width));
  std::vector<bool> taken(size_t(size.width) * size_t(size.height), false);
  for (int y = 0; y < size.height; ++y) {
    source.read_correspondence(t, y, row.data());
    correspondence.set_row(y, row.data(), &taken);
  }
  return correspondence;
}

}  // namespace gradus::reconstruct
