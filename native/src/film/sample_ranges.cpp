#include "film/sample_ranges.h"

#include <algorithm>

#include "base/error.h"

namespace gradus::film {

SampleRanges::SampleRanges(std::vector<SampleRange> ranges) : ranges_(std::move(ranges)) {
  for (size_t i = 0; i < ranges_.size(); ++i) {
    if (ranges_[i].begin >= ranges_[i].end || (i > 0 && ranges_[i].begin <= ranges_[i - 1].end)) {
      throw invalid_argument("its sample ranges are wrong");
    }
  }
}

void SampleRanges::add(const SampleRange& range) {
  if (range.begin >= range.end) return;
  SampleRange merged = range;
  std::vector<SampleRange> kept;
  for (const SampleRange& r : ranges_) {
    if (r.end < merged.begin || r.begin > merged.end) {
      kept.push_back(r);
    } else {
      merged = {std::min(r.begin, merged.begin), std::max(r.end, merged.end)};
    }
  }
  kept.push_back(merged);
  std::sort(kept.begin(), kept.end(), [](const SampleRange& a, const SampleRange& b) { return a.begin < b.begin; });
  ranges_ = std::move(kept);
}

bool SampleRanges::overlap(const SampleRanges& other) const {
  for (const SampleRange& a : ranges_) {
    for (const SampleRange& b : other.ranges_) {
      if (a.begin < b.end && b.begin < a.end) return true;
    }
  }
  return false;
}

std::string SampleRanges::first_gap(uint32_t first) const {
  if (ranges_.empty() || (ranges_.size() == 1 && ranges_[0].begin == first)) return "";
  const bool at_start = ranges_[0].begin != first;
  const uint32_t begin = at_start ? first : ranges_[0].end, end = at_start ? ranges_[0].begin : ranges_[1].begin;
  return "samples " + std::to_string(begin) + " to " + std::to_string(int64_t(end) - 1);
}

uint64_t SampleRanges::total() const {
  uint64_t sum = 0;
  for (const SampleRange& r : ranges_) sum += r.end - r.begin;
  return sum;
}

}  // namespace gradus::film
