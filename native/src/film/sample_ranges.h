// Sample numbers that a film holds, as sorted ranges with gaps between them. They are needed to merge films that were
// rendered separately.
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
  // Throws invalid_argument unless the ranges are sorted, non-empty and separated by gaps.
  explicit SampleRanges(std::vector<SampleRange> ranges);

  // Adds a range. Ranges that touch or overlap are merged.
  void add(const SampleRange& range);
  // Returns whether a sample number is in both sets.
  bool overlap(const SampleRanges& other) const;
  // Returns the first gap from sample number `first` on, such as "samples 16 to 31", or "" if there is none.
  std::string first_gap(uint32_t first) const;
  // Returns the number of samples in all ranges.
  uint64_t total() const;
  const std::vector<SampleRange>& list() const { return ranges_; }
  bool operator==(const SampleRanges&) const = default;

 private:
  std::vector<SampleRange> ranges_;
};

}  // namespace gradus::film
