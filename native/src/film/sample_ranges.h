// Which sample numbers a frame holds: ranges in order, with gaps between them. Frames that were rendered apart are
// added by these.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gradus::film {

// Sample numbers [begin, end).
struct SampleRange {
  uint32_t begin = 0, end = 0;
  bool operator==(const SampleRange&) const = default;
};

class SampleRanges {
 public:
  SampleRanges() = default;
  // Throws invalid_argument unless they are in order, not empty, and apart.
  explicit SampleRanges(std::vector<SampleRange> ranges);

  // Ranges that touch become one; what is there already stays once.
  void add(const SampleRange& range);
  bool overlap(const SampleRanges& other) const;
  // "samples 16 to 31" of the first gap from `first` on; "" if the samples from there on lie in one range.
  std::string first_gap(uint32_t first) const;
  uint64_t total() const;
  const std::vector<SampleRange>& list() const { return ranges_; }
  bool operator==(const SampleRanges&) const = default;

 private:
  std::vector<SampleRange> ranges_;
};

}  // namespace gradus::film
