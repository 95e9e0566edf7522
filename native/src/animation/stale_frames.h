// Stored frames that a job cannot use, because they were sampled of another scene or with other settings, or because
// their files are damaged.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace gradus::animation {

class StaleFrames {
 public:
  // why: how the stored frame differs from the wanted one, such as "another scene".
  void add(int32_t frame, const std::string& why) { frames_[why].insert(frame); }
  bool empty() const { return frames_.empty(); }
  // Returns "4 stored frames " + `what` and the frames by cause, such as "8 to 10 (another scene), 3 (other settings)".
  // `step` is the distance of consecutive frames.
  std::string text(const std::string& what, int32_t step) const;

 private:
  std::map<std::string, std::set<int32_t>> frames_;
};

}  // namespace gradus::animation
