#include "stored_sequence.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <regex>
#include <set>

#include "base/error.h"
#include "base/text_list.h"
#include "frame/frame_name.h"

namespace gradus::tool {
namespace {

namespace fs = std::filesystem;

// Of the files of one kind, with the number; "": of frames on their own.
std::regex name_of(const std::string& kind) { return std::regex("f([+-][0-9]{7,8})" + (kind.empty() ? "" : "\\." + kind) + "\\.exr"); }

std::set<int32_t> numbers_in(const std::string& folder, const std::string& kind) {
  const std::regex name = name_of(kind);
  std::set<int32_t> numbers;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    std::smatch match;
    const std::string file = entry.path().filename().string();
    if (std::regex_match(file, match, name)) numbers.insert(std::stoi(match[1]));
  }
  return numbers;
}

// ": try a, b": the folders below that do. A frame store has one for each scene, layer and view.
std::string advice(const std::string& folder) {
  const std::regex name = name_of("base");
  std::set<std::string> places;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (std::regex_match(entry.path().filename().string(), name)) places.insert(entry.path().parent_path().string());
  }
  std::string list;
  for (const std::string& place : places) add_item(&list, place);
  return list.empty() ? "" : ": try " + list;
}

std::string text_of(int32_t first, int32_t last) {
  return first == last ? std::to_string(first) : std::to_string(first) + " to " + std::to_string(last);
}

}  // namespace

StoredSequence::StoredSequence(const std::string& folder) : folder_(folder) {
  const std::set<int32_t> base = numbers_in(folder, "base"), offset = numbers_in(folder, "offset");
  std::set_intersection(base.begin(), base.end(), offset.begin(), offset.end(), std::back_inserter(frames_));
  if (frames_.empty()) {
    const bool has_none = base.empty() && numbers_in(folder, "").empty();
    throw invalid_argument(folder + (has_none ? " holds no stored frames" + advice(folder)
                                              : " holds stored frames, but none of a sequence: reconstruct them one by one"));
  }
  int32_t step = 0;
  for (size_t i = 1; i < frames_.size(); ++i) step = std::gcd(step, frames_[i] - frames_[i - 1]);
  if (step > 0) step_ = step;
}

std::string StoredSequence::path(int32_t frame) const { return (fs::path(folder_) / frame_name(frame, "base.exr")).string(); }

std::vector<int32_t> StoredSequence::expected(int32_t first, int32_t last) const {
  std::vector<int32_t> frames;
  const int64_t beyond = (int64_t(first) - frames_.front()) % step_;
  for (int64_t frame = int64_t(first) + (beyond == 0 ? 0 : beyond > 0 ? step_ - beyond : -beyond); frame <= last; frame += step_) {
    frames.push_back(int32_t(frame));
  }
  return frames;
}

std::string StoredSequence::missing(int32_t first, int32_t last) const {
  std::string text;
  const auto add = [&](int32_t from, int32_t to) { add_item(&text, text_of(from, to)); };
  int32_t from = 0, to = 0;
  bool open = false;
  for (const int32_t frame : expected(first, last)) {
    const bool there = std::binary_search(frames_.begin(), frames_.end(), frame);
    if (there && open) add(from, to);
    if (!there && !open) from = frame;
    if (!there) to = frame;
    open = !there;
  }
  if (open) add(from, to);
  return text;
}

}  // namespace gradus::tool
