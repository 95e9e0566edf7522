// Where the raw frames of a sequence lie: f<number>.base.exr and f<number>.offset.exr in one folder (contract 7.2),
// beside them f<number>.json with the settings that the frame was asked for.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "base/temporary_folder.h"
#include "film_io/store.h"

namespace gradus::animation {

// What a frame of a sequence is sampled in: with random numbers of its own, and with those of the frame before.
enum class FrameSamples { kFresh, kReplayed };

class SequenceFolder {
 public:
  // path: made if it is not there; empty: a folder for temporary files, which goes when this does.
  explicit SequenceFolder(const std::string& path);

  bool is_temporary() const { return temporary_ != nullptr; }
  const std::string& path() const { return path_; }
  std::string path(int32_t frame, FrameSamples kind) const;
  // Whether both parts of a frame are there.
  bool holds(int32_t frame) const;
  // Both throw invalid_argument with path and cause. The second by the threads of the caller's arena; so does save().
  // `cancel`: as of film_io/store.h.
  film::FilmHeader header(int32_t frame, FrameSamples kind) const;
  std::shared_ptr<film::Film> load(
      int32_t frame, FrameSamples kind, film_io::StoredContent content = film_io::StoredContent::kAll,
      const CancelCheck& cancel = [] { return false; }) const;
  // Of one component alone (film_io/store.h).
  std::shared_ptr<film::Film> load_component(int32_t frame, FrameSamples kind, const std::string& component,
                                             const CancelCheck& cancel) const;
  void save(const film::Film& content, int32_t frame, FrameSamples kind, const CancelCheck& cancel) const;
  // Of delivery (exposure and the like): frames that are alike share their files, and may differ in these. Throws
  // invalid_argument with the path; nothing: those of its files.
  std::optional<GradusSettings> settings(int32_t frame) const;
  void save_settings(const GradusSettings& settings, int32_t frame) const;
  // Frame `to` gets the files of frame `from`.
  void repeat(int32_t from, int32_t to) const;
  // Of a temporary folder: the frame is not needed any more.
  void forget(int32_t frame) const;
  // How many files were unpacked: each takes as long as it took to write.
  uint64_t loads() const { return loads_; }

 private:
  std::string path(int32_t frame, const char* ending) const;

  film_io::Durable durable() const { return is_temporary() ? film_io::Durable::kNo : film_io::Durable::kYes; }

  std::unique_ptr<const TemporaryFolder> temporary_;
  std::string path_;
  mutable std::atomic<uint64_t> loads_{0};
};

}  // namespace gradus::animation
