#include "render/sequence/sequence_folder.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "base/error.h"
#include "frame/store.h"

namespace gradus {
namespace {

namespace fs = std::filesystem;

Error problem(const std::string& what, const std::string& path, const std::string& cause) {
  return Error(GRADUS_ERROR_INVALID_OPERATION, what + " " + path + ": " + cause);
}

std::string make_temporary_folder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  std::string path = (error ? fs::path("/tmp") : parent) / "gradus-XXXXXX";
  if (mkdtemp(path.data()) == nullptr) throw problem("cannot make a temporary folder", path, std::strerror(errno));
  return path;
}

}  // namespace

SequenceFolder::SequenceFolder(const std::string& path) : path_(path), is_temporary_(path.empty()) {
  if (is_temporary_) {
    path_ = make_temporary_folder();
    return;
  }
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) throw problem("cannot make the frame store's folder", path_, error.message());
}

SequenceFolder::~SequenceFolder() {
  std::error_code ignored;
  if (is_temporary_) fs::remove_all(path_, ignored);
}

std::string SequenceFolder::path(int32_t frame, FramePart part) const {
  std::array<char, 40> name{};
  std::snprintf(name.data(), name.size(), "/f%+08d.%s.exr", frame, part == FramePart::kBase ? "base" : "offset");
  return path_ + name.data();
}

bool SequenceFolder::holds(int32_t frame) const {
  std::error_code error;
  return fs::exists(path(frame, FramePart::kBase), error) && fs::exists(path(frame, FramePart::kOffset), error);
}

std::shared_ptr<const Frame> SequenceFolder::load(int32_t frame, FramePart part) const { return load_frame(path(frame, part)); }

void SequenceFolder::save(const Frame& content, int32_t frame, FramePart part) const { save_frame(content, path(frame, part)); }

void SequenceFolder::repeat(int32_t from, int32_t to) const {
  for (const FramePart part : {FramePart::kOffset, FramePart::kBase}) {
    const std::string source = path(from, part), target = path(to, part);
    std::error_code error;
    fs::create_hard_link(source, target, error);
    if (!error || error == std::errc::file_exists) continue;
    save_frame(*load_frame(source), target);  // not every file system has hard links
  }
}

void SequenceFolder::forget(int32_t frame) const {
  std::error_code ignored;
  if (!is_temporary_) return;
  for (const FramePart part : {FramePart::kBase, FramePart::kOffset}) fs::remove(path(frame, part), ignored);
}

}  // namespace gradus
