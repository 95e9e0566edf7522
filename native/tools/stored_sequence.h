// Finds the frames of an animation in a folder of a frame store by the names of their files.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "animation/frame_record.h"

namespace gradus::tool {

class StoredSequence {
 public:
  // Reads the folder. Frames in `left_out` count as missing. Throws Error if the folder holds no other frames.
  explicit StoredSequence(const std::string& folder, const std::set<int32_t>& left_out = {});

  const std::string& folder() const { return folder_; }
  std::string path(int32_t frame) const;
  // Returns the frames whose fresh and replayed samples are both stored, in ascending order.
  const std::vector<int32_t>& frames() const { return frames_; }
  // Returns the number of frames from a frame to the one that replays it.
  int32_t step() const { return step_; }
  // Returns the expected frames of [first, last]. Each list is a chain of frames that are step() apart. If several jobs
  // have rendered interleaved frames into the folder, each job gives a list.
  std::vector<std::vector<int32_t>> chains(int32_t first, int32_t last) const;
  // Returns the expected frames that are not stored, for example "4, 7 to 9".
  std::string missing(int32_t first, int32_t last) const;
  // Returns the frames whose replayed samples do not belong to the frame that is stored before them, as a text.
  std::string unrelated(int32_t first, int32_t last) const;

 private:
  bool is_unrelated(int32_t frame) const;

  std::string folder_;
  std::vector<int32_t> frames_;
  std::map<int32_t, animation::FrameTraits> traits_;
  int32_t step_ = 1;
};

// Errors in the files of a sequence. find_faults() reads all files completely.
struct FolderFaults {
  std::map<std::string, std::string> files;  // the reason for each file that is missing or cannot be read
  std::set<int32_t> frames;                  // frames whose samples are therefore incomplete
  size_t whole_frames = 0;
};
FolderFaults find_faults(const std::string& folder);

}  // namespace gradus::tool
