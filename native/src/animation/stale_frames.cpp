#include "animation/stale_frames.h"

#include <iterator>

#include "base/text_list.h"

namespace gradus::animation {
namespace {

// Returns the numbers as a list of runs, such as "4, 7 to 9".
std::string runs_of(const std::set<int32_t>& frames, int32_t step) {
  std::string text;
  for (auto first = frames.begin(); first != frames.end();) {
    auto last = first;
    for (auto next = std::next(last); next != frames.end() && int64_t{*next} == int64_t{*last} + step; ++next)
      last = next;
    add_item(&text, first == last ? std::to_string(*first) : std::to_string(*first) + " to " + std::to_string(*last));
    first = std::next(last);
  }
  return text;
}

}  // namespace

std::string StaleFrames::text(const std::string& what, int32_t step) const {
  std::set<int32_t> all;
  std::string list;
  for (const auto& [why, frames] : frames_) {
    all.insert(frames.begin(), frames.end());
    add_item(&list, runs_of(frames, step) + " (" + why + ")");
  }
  return std::to_string(all.size()) + (all.size() == 1 ? " stored frame " : " stored frames ") + what + ": " + list;
}

}  // namespace gradus::animation
