// Frames of an animation in a folder of a frame store, as the names of their files tell (contract 7.2).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gradus::tool {

class StoredSequence {
 public:
  // Throws Error where the folder holds none.
  explicit StoredSequence(const std::string& folder);

  const std::string& folder() const { return folder_; }
  std::string path(int32_t frame) const;
  // In order; those of which base and offset are there.
  const std::vector<int32_t>& frames() const { return frames_; }
  // The largest that meets all frames.
  int32_t step() const { return step_; }
  // Those of [first, last] that the steps meet.
  std::vector<int32_t> expected(int32_t first, int32_t last) const;
  // "4, 7 to 9": the expected ones that are not there.
  std::string missing(int32_t first, int32_t last) const;

 private:
  std::string folder_;
  std::vector<int32_t> frames_;
  int32_t step_ = 1;
};

}  // namespace gradus::tool
