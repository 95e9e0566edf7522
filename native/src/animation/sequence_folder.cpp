#include "animation/sequence_folder.h"

#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "film_io/file_writer.h"
#include "film_io/temporary_file.h"
#include "schema/options.h"

namespace gradus::animation {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSettings = "json";

std::string path_of(const std::string& folder, int32_t frame, const char* name) {
  return (fs::path(folder) / film_io::frame_name(frame, (std::string(name) + ".exr").c_str())).string();
}

void remove_older(const std::string& folder, int32_t frame, FrameSamples kind) {
  std::error_code ignored;
  fs::remove(path_of(folder, frame, older_name_of(kind)), ignored);
}

}  // namespace

const char* name_of(FrameSamples kind) { return kind == FrameSamples::kFresh ? "fresh" : "replayed"; }

const char* older_name_of(FrameSamples kind) { return kind == FrameSamples::kFresh ? "base" : "offset"; }

std::string stored_path(const std::string& folder, int32_t frame, FrameSamples kind) {
  const std::string path = path_of(folder, frame, name_of(kind)), older = path_of(folder, frame, older_name_of(kind));
  std::error_code error;
  return !fs::exists(path, error) && fs::exists(older, error) ? older : path;
}

SequenceFolder::SequenceFolder(const std::string& path)
    : temporary_(path.empty() ? std::make_unique<TemporaryFolder>() : nullptr),
      path_(temporary_ ? temporary_->path() : path) {
  if (temporary_) return;
  std::error_code error;
  fs::create_directories(path_, error);
  if (error)
    throw Error(GRADUS_ERROR_INVALID_OPERATION,
                "cannot create the folder of the frame store " + path_ + ": " + error.message());
}

std::string SequenceFolder::path(int32_t frame, const char* ending) const {
  return path_ + "/" + film_io::frame_name(frame, ending);
}

std::string SequenceFolder::path(int32_t frame, FrameSamples kind) const { return stored_path(path_, frame, kind); }

std::string SequenceFolder::new_path(int32_t frame, FrameSamples kind) const {
  return path_of(path_, frame, name_of(kind));
}

bool SequenceFolder::holds(int32_t frame) const {
  std::error_code error;
  return fs::exists(path(frame, FrameSamples::kFresh), error) &&
         fs::exists(path(frame, FrameSamples::kReplayed), error);
}

film::FilmHeader SequenceFolder::header(int32_t frame, FrameSamples kind) const {
  return film_io::load_header(path(frame, kind));
}

std::shared_ptr<film::Film> SequenceFolder::load(int32_t frame, FrameSamples kind, film_io::StoredContent content,
                                                 const CancelCheck& cancel) const {
  if (std::shared_ptr<film::Film> checked = take_checked(frame, kind)) return checked;
  ++loads_;
  return film_io::load_film(path(frame, kind), content, cancel);
}

void SequenceFolder::check(int32_t frame, FrameSamples kind, const CancelCheck& cancel) const {
  std::shared_ptr<film::Film> film = load(frame, kind, film_io::StoredContent::kAll, cancel);
  const std::lock_guard lock(checking_);
  checked_[kind] = {frame, std::move(film)};
}

std::shared_ptr<film::Film> SequenceFolder::take_checked(int32_t frame, FrameSamples kind) const {
  const std::lock_guard lock(checking_);
  const auto found = checked_.find(kind);
  return found != checked_.end() && found->second.frame == frame ? std::exchange(found->second.film, nullptr) : nullptr;
}

std::shared_ptr<film::Film> SequenceFolder::load_component(int32_t frame, FrameSamples kind,
                                                           const std::string& component,
                                                           const CancelCheck& cancel) const {
  ++loads_;
  return gradus::film_io::load_component(path(frame, kind), component, film_io::StoredContent::kAll, cancel);
}

void SequenceFolder::save(const film::Film& content, int32_t frame, FrameSamples kind,
                          const CancelCheck& cancel) const {
  take_checked(frame, kind);
  film_io::save_film(content, new_path(frame, kind), {durable(), cancel});
  remove_older(path_, frame, kind);
}

std::optional<GradusSettings> SequenceFolder::settings(int32_t frame) const {
  const std::string name = path(frame, kSettings);
  std::ifstream file(name);
  if (!file) return std::nullopt;
  try {
    return schema::settings_from_json(nlohmann::json::parse(file));
  } catch (const std::exception& e) {
    throw invalid_argument("cannot read " + name + ": " + e.what());
  }
}

void SequenceFolder::save_settings(const GradusSettings& settings, int32_t frame) const {
  const std::string text = schema::settings_to_json(settings).dump(1);
  film_io::FileWriter file(path(frame, kSettings), durable());
  file.write(text.data(), text.size());
  file.commit();
}

void SequenceFolder::repeat(int32_t from, int32_t to) const {
  for (const FrameSamples kind : {FrameSamples::kReplayed, FrameSamples::kFresh}) {
    const std::string source = path(from, kind), target = new_path(to, kind);
    take_checked(to, kind);
    if (!film_io::hard_link_file(source, target)) film_io::copy_file(source, target, durable());
    remove_older(path_, to, kind);
  }
}

void SequenceFolder::forget(int32_t frame) const {
  std::error_code ignored;
  if (!temporary_) return;
  for (const FrameSamples kind : kFrameSamples) fs::remove(path(frame, kind), ignored);
  fs::remove(path(frame, kSettings), ignored);
}

}  // namespace gradus::animation
