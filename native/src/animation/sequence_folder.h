// The files of a sequence, all in one folder: f<number>.fresh.exr and f<number>.replayed.exr with the fresh and the
// replayed samples of a frame, and f<number>.json with the settings that were requested for the frame. Where frames are
// joined, the second file holds no samples, only the pixel correspondence to the frame before.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "base/temporary_folder.h"
#include "film_io/store.h"

namespace gradus::animation {

// The two kinds of samples of a frame: those with random numbers of its own, and those that replay the random numbers
// of the previous frame.
enum class FrameSamples { kFresh, kReplayed };
inline constexpr FrameSamples kFrameSamples[] = {FrameSamples::kFresh, FrameSamples::kReplayed};

// Returns the part of a file's name between the frame number and ".exr".
const char* name_of(FrameSamples kind);
// Returns the name that earlier versions gave the same files. Such files are read where no newer ones are.
const char* older_name_of(FrameSamples kind);
// Returns the path of the file in a folder that holds these samples of a frame, or that would hold them.
std::string stored_path(const std::string& folder, int32_t frame, FrameSamples kind);

class SequenceFolder {
 public:
  // path: folder, which is created if it does not exist; empty: a temporary folder, which the destructor removes.
  // Throws invalid_operation if the folder cannot be created.
  explicit SequenceFolder(const std::string& path);

  bool is_temporary() const { return temporary_ != nullptr; }
  const std::string& path() const { return path_; }
  // Returns the path of the file that holds these samples, or that would hold them.
  std::string path(int32_t frame, FrameSamples kind) const;
  // Whether both the fresh and the replayed samples of a frame exist.
  bool holds(int32_t frame) const;
  // header() and load() throw invalid_argument with path and cause. load() and save() use the threads of the caller's
  // arena; `cancel` is polled as in film_io/store.h.
  film::FilmHeader header(int32_t frame, FrameSamples kind) const;
  std::shared_ptr<film::Film> load(
      int32_t frame, FrameSamples kind, film_io::StoredContent content = film_io::StoredContent::kAll,
      const CancelCheck& cancel = [] { return false; }) const;
  // Loads all samples to find damage in the file. What was read is kept for the next load() of the same samples, until
  // others of that kind are checked.
  void check(int32_t frame, FrameSamples kind, const CancelCheck& cancel) const;
  // Loads the planes of one component alone (film_io/store.h).
  std::shared_ptr<film::Film> load_component(int32_t frame, FrameSamples kind, const std::string& component,
                                             const CancelCheck& cancel) const;
  // Replaces a file of an earlier version, too.
  void save(const film::Film& content, int32_t frame, FrameSamples kind, const CancelCheck& cancel) const;
  // Returns the settings for delivery, such as the exposure: identical frames share their files, but may differ in
  // these. Without a value there is no file, and the settings in the headers hold. Throws invalid_argument with the
  // path.
  std::optional<GradusSettings> settings(int32_t frame) const;
  void save_settings(const GradusSettings& settings, int32_t frame) const;
  // Gives frame `to` the samples of frame `from`, by hard links or copies of its files.
  void repeat(int32_t from, int32_t to) const;
  // Removes the files of a frame that is no longer needed, if the folder is temporary.
  void forget(int32_t frame) const;
  // Returns the number of files that were read and decompressed so far, which is the main cost of loading.
  uint64_t loads() const { return loads_; }

 private:
  std::string path(int32_t frame, const char* ending) const;
  // Returns the path of the file that is written for these samples.
  std::string new_path(int32_t frame, FrameSamples kind) const;

  // Returns the samples that check() has read, once, or nullptr.
  std::shared_ptr<film::Film> take_checked(int32_t frame, FrameSamples kind) const;

  film_io::Durable durable() const { return is_temporary() ? film_io::Durable::kNo : film_io::Durable::kYes; }

  std::unique_ptr<const TemporaryFolder> temporary_;
  std::string path_;
  mutable std::atomic<uint64_t> loads_{0};
  struct Checked {
    int32_t frame = 0;
    std::shared_ptr<film::Film> film;
  };
  mutable std::mutex checking_;
  mutable std::map<FrameSamples, Checked> checked_;
};

}  // namespace gradus::animation
