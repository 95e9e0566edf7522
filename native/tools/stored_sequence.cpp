#include "stored_sequence.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <regex>
#include <set>

#include "animation/sequence_folder.h"
#include "base/error.h"
#include "base/text_list.h"
#include "common.h"
#include "film_io/store.h"

namespace gradus::tool {
namespace {

namespace fs = std::filesystem;

using animation::FrameSamples;

// Returns the pattern of file names with this text between the frame number, which is group 1, and ".exr".
std::regex pattern_with(const std::string& text) { return std::regex("f([+-][0-9]{7,8})" + text + "\\.exr"); }

// Returns the pattern of the names of files with these samples.
std::regex pattern_of(FrameSamples kind) {
  std::string names = animation::name_of(kind);
  names.append("|").append(animation::older_name_of(kind));
  return pattern_with("\\.(?:" + names + ")");
}

std::set<int32_t> numbers_in(const std::string& folder, const std::regex& name) {
  std::set<int32_t> numbers;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    std::smatch match;
    const std::string file = entry.path().filename().string();
    if (std::regex_match(file, match, name)) numbers.insert(std::stoi(match[1]));
  }
  return numbers;
}

// Returns ": try a, b" with the folders below that hold sequences, or "". A frame store has a folder for each scene,
// view layer and view.
std::string advice(const std::string& folder) {
  const std::regex name = pattern_of(FrameSamples::kFresh);
  std::set<std::string> places;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (std::regex_match(entry.path().filename().string(), name)) places.insert(entry.path().parent_path().string());
  }
  std::string list;
  for (const std::string& place : places) add_item(&list, place);
  return list.empty() ? "" : ": try " + list;
}

// Returns the step of the animation: the greatest common divisor of the distances between frames and those that they
// replay or repeat. It is 0 if no frame replays or repeats another.
int32_t step_of_replays(const std::map<int32_t, animation::FrameTraits>& forms) {
  int32_t step = 0;
  std::map<int32_t, int32_t>
      last_with;  // the last frame of each stream of random numbers; repeated frames share a stream
  for (const auto& [frame, form] : forms) {
    const bool repeats = form.stream != frame, replays = !repeats && form.replayed_stream != frame;
    const auto before = last_with.find(repeats ? form.stream : form.replayed_stream);
    if ((repeats || replays) && before != last_with.end()) {
      step = std::gcd(step, frame - before->second);
    } else if (replays) {
      step = std::gcd(step, frame - form.replayed_stream);  // the replayed frame is not stored
    }
    last_with[form.stream] = frame;
  }
  return step;
}

// Returns the greatest common divisor of the distances between the frames, or 0 for a single frame.
int32_t step_of_gaps(const std::vector<int32_t>& frames) {
  int32_t step = 0;
  for (size_t i = 1; i < frames.size(); ++i) step = std::gcd(step, frames[i] - frames[i - 1]);
  return step;
}

std::string text_of(int32_t first, int32_t last) {
  return first == last ? std::to_string(first) : std::to_string(first) + " to " + std::to_string(last);
}

// Returns the frames of a list for which is_wanted(frame) is true as a text, for example "4, 7 to 9".
template <class IsWanted>
std::string name_runs(const std::vector<int32_t>& frames, const IsWanted& is_wanted) {
  std::string text;
  const auto add = [&](int32_t from, int32_t to) { add_item(&text, text_of(from, to)); };
  int32_t from = 0, to = 0;
  bool open = false;
  for (const int32_t frame : frames) {
    const bool wanted = is_wanted(frame);
    if (!wanted && open) add(from, to);
    if (wanted && !open) from = frame;
    if (wanted) to = frame;
    open = wanted;
  }
  if (open) add(from, to);
  return text;
}

// Returns an error text without the leading file name, which is printed separately.
std::string cause_of(const std::string& error, const std::string& path) {
  const std::string name = path + ": ";
  const size_t begin = error.find(name);
  return begin == std::string::npos ? error : error.substr(begin + name.size());
}

std::vector<int32_t> joined(const std::vector<std::vector<int32_t>>& chains) {
  std::vector<int32_t> frames;
  for (const std::vector<int32_t>& chain : chains) frames.insert(frames.end(), chain.begin(), chain.end());
  std::sort(frames.begin(), frames.end());
  return frames;
}

}  // namespace

StoredSequence::StoredSequence(const std::string& folder, const std::set<int32_t>& left_out) : folder_(folder) {
  const std::set<int32_t> fresh = numbers_in(folder, pattern_of(FrameSamples::kFresh)),
                          replayed = numbers_in(folder, pattern_of(FrameSamples::kReplayed));
  std::set_intersection(fresh.begin(), fresh.end(), replayed.begin(), replayed.end(), std::back_inserter(frames_));
  std::erase_if(frames_, [&](int32_t frame) { return left_out.count(frame) > 0; });
  if (frames_.empty()) {
    const bool has_none = fresh.empty() && numbers_in(folder, pattern_with("")).empty();
    throw invalid_argument(folder + (has_none
                                         ? " holds no stored films" + advice(folder)
                                         : " holds stored films, but none of a sequence: reconstruct them one by one"));
  }
  for (const int32_t frame : frames_) {
    const film::FilmHeader header =
        film_io::load_header(animation::stored_path(folder_, frame, FrameSamples::kReplayed));
    traits_[frame] = animation::traits_of(header, header);
  }
  const int32_t of_replays = step_of_replays(traits_), step = of_replays > 0 ? of_replays : step_of_gaps(frames_);
  if (step > 0) step_ = step;
}

std::string StoredSequence::path(int32_t frame) const {
  return animation::stored_path(folder_, frame, FrameSamples::kFresh);
}

std::vector<std::vector<int32_t>> StoredSequence::chains(int32_t first, int32_t last) const {
  const auto beyond = [&](int64_t frame) { return ((frame - first) % step_ + step_) % step_; };
  std::set<int64_t> begins;
  for (const int32_t frame : frames_) begins.insert(first + beyond(frame));
  std::vector<std::vector<int32_t>> chains;
  for (const int64_t begin : begins) {
    std::vector<int32_t> chain;
    for (int64_t frame = begin; frame <= last; frame += step_) chain.push_back(int32_t(frame));
    if (!chain.empty()) chains.push_back(std::move(chain));
  }
  return chains;
}

std::string StoredSequence::missing(int32_t first, int32_t last) const {
  return name_runs(joined(chains(first, last)), [&](int32_t frame) { return traits_.count(frame) == 0; });
}

bool StoredSequence::is_unrelated(int32_t frame) const {
  const auto here = traits_.find(frame), before = traits_.find(frame - step_);
  if (here == traits_.end() || before == traits_.end()) return false;
  const animation::FrameTraits& form = here->second;
  if (form.stream == frame && form.replayed_stream == frame) return false;  // A shot change, or a job's first frame.
  const bool follows = form.stream == before->second.stream || form.replayed_stream == before->second.stream;
  return !follows || animation::follows_another_frame(before->second, form);
}

std::string StoredSequence::unrelated(int32_t first, int32_t last) const {
  return name_runs(joined(chains(first, last)), [&](int32_t frame) { return frame > first && is_unrelated(frame); });
}

FolderFaults find_faults(const std::string& folder) {
  const std::set<int32_t> fresh = numbers_in(folder, pattern_of(FrameSamples::kFresh)),
                          replayed = numbers_in(folder, pattern_of(FrameSamples::kReplayed));
  std::set<int32_t> frames = fresh;
  frames.insert(replayed.begin(), replayed.end());
  const animation::SequenceFolder files(folder);
  FolderFaults faults;
  for (const int32_t frame : frames) {
    for (const FrameSamples kind : animation::kFrameSamples) {
      const std::string path = animation::stored_path(folder, frame, kind), name = fs::path(path).filename().string();
      const std::string error = fs::exists(path) ? refusal([&] { film_io::load_film(path); }) : "it is missing";
      if (error.empty()) continue;
      faults.files[name] = cause_of(error, path);
      faults.frames.insert(frame);
    }
    const std::string error = refusal([&] { files.settings(frame); }), name = film_io::frame_name(frame, "json");
    if (!error.empty()) faults.files[name] = cause_of(error, files.path() + "/" + name);
  }
  faults.whole_frames = frames.size() - faults.frames.size();
  return faults;
}

}  // namespace gradus::tool
