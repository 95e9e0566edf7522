#include "render/sequence/sequence_folder.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/error.h"
#include "frame/file_writer.h"
#include "frame/frame_name.h"
#include "frame/part_file.h"
#include "settings/options.h"

namespace gradus {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSettings = "json";

}  // namespace

SequenceFolder::SequenceFolder(const std::string& path)
    : temporary_(path.empty() ? std::make_unique<TemporaryFolder>() : nullptr), path_(temporary_ ? temporary_->path() : path) {
  if (temporary_) return;
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) throw Error(GRADUS_ERROR_INVALID_OPERATION, "cannot make the frame store's folder " + path_ + ": " + error.message());
}

std::string SequenceFolder::path(int32_t frame, const char* ending) const { return path_ + "/" + frame_name(frame, ending); }

std::string SequenceFolder::path(int32_t frame, FramePart part) const {
  return path(frame, part == FramePart::kBase ? "base.exr" : "offset.exr");
}

bool SequenceFolder::holds(int32_t frame) const {
  std::error_code error;
  return fs::exists(path(frame, FramePart::kBase), error) && fs::exists(path(frame, FramePart::kOffset), error);
}

FrameHeader SequenceFolder::header(int32_t frame, FramePart part) const { return load_header(path(frame, part)); }

std::shared_ptr<Frame> SequenceFolder::load(int32_t frame, FramePart part, StoredContent content, const CancelTest& cancel) const {
  ++loads_;
  return load_frame(path(frame, part), content, cancel);
}

std::shared_ptr<Frame> SequenceFolder::load_component(int32_t frame, FramePart part, const std::string& component,
                                                      const CancelTest& cancel) const {
  ++loads_;
  return gradus::load_component(path(frame, part), component, StoredContent::kAll, cancel);
}

void SequenceFolder::save(const Frame& content, int32_t frame, FramePart part, const CancelTest& cancel) const {
  save_frame(content, path(frame, part), {durable(), cancel});
}

std::optional<GradusSettings> SequenceFolder::settings(int32_t frame) const {
  const std::string name = path(frame, kSettings);
  std::ifstream file(name);
  if (!file) return std::nullopt;
  try {
    return settings_from_json(nlohmann::json::parse(file));
  } catch (const std::exception& e) {
    throw invalid_argument("cannot read " + name + ": " + e.what());
  }
}

void SequenceFolder::save_settings(const GradusSettings& settings, int32_t frame) const {
  const std::string text = settings_to_json(settings).dump(1);
  FileWriter file(path(frame, kSettings), durable());
  file.write(text.data(), text.size());
  file.commit();
}

void SequenceFolder::repeat(int32_t from, int32_t to) const {
  for (const FramePart part : {FramePart::kOffset, FramePart::kBase}) {
    const std::string source = path(from, part), target = path(to, part);
    if (!link_file(source, target)) copy_file(source, target, durable());
  }
}

void SequenceFolder::forget(int32_t frame) const {
  std::error_code ignored;
  if (!temporary_) return;
  for (const FramePart part : {FramePart::kBase, FramePart::kOffset}) fs::remove(path(frame, part), ignored);
  fs::remove(path(frame, kSettings), ignored);
}

}  // namespace gradus
