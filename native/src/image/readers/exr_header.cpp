// An OpenEXR file begins with a magic number and with version and flags. The attributes of each part follow, each as
// name\0 type\0 size value. An empty name ends a part, and in multipart files another empty name ends the last part.
// Source: openexr.com, "OpenEXR File Layout".
#include "image/readers/exr_header.h"

#include <cstring>
#include <string_view>

namespace gradus::image {
namespace {

// Flag of multipart files in the version field.
constexpr uint32_t kMultipart = 0x1000;

// Reads numbers and texts from a file in memory. Its functions return false at the end of the file.
class Scanner {
 public:
  explicit Scanner(Bytes file) : file_(file) {}
  bool number(uint32_t* value) {
    if (file_.size() - position_ < 4) {
      return false;
    }
    std::memcpy(value, file_.data() + position_, 4);
    position_ += 4;
    return true;
  }
  // Reads a zero-terminated text of at most 255 characters.
  bool text(std::string_view* value) {
    const size_t start = position_;
    while (position_ < file_.size() && position_ - start < 256 && file_[position_] != 0) {
      position_++;
    }
    if (position_ >= file_.size() || file_[position_] != 0) {
      return false;
    }
    *value = std::string_view(reinterpret_cast<const char*>(file_.data()) + start, position_ - start);
    position_++;
    return true;
  }
  bool skip(uint32_t count) {
    if (count > file_.size() - position_) {
      return false;
    }
    position_ += count;
    return true;
  }
  const uint8_t* here() const { return file_.data() + position_; }

 private:
  Bytes file_;
  size_t position_ = 0;
};

// Checks a data window (x minimum, y minimum, x maximum, y maximum, all inclusive) against the limits of images.
bool check_window(const uint8_t* value, std::string* problem) {
  int32_t box[4];
  std::memcpy(box, value, sizeof(box));
  const int64_t width = static_cast<int64_t>(box[2]) - box[0] + 1;
  const int64_t height = static_cast<int64_t>(box[3]) - box[1] + 1;
  if (width < 1 || height < 1) {
    *problem = "it has no pixels";
    return false;
  }
  if (static_cast<uint64_t>(width) > kMaxSide || static_cast<uint64_t>(height) > kMaxSide ||
      static_cast<uint64_t>(width * height) > kMaxPixels) {
    *problem = "its size of " + std::to_string(width) + " x " + std::to_string(height) + " is too large";
    return false;
  }
  return true;
}

// Checks the width and height of a part's tiles.
bool check_tiles(const uint8_t* value, std::string* problem) {
  uint32_t size[2];
  std::memcpy(size, value, sizeof(size));
  if (size[0] == 0 || size[1] == 0 || size[0] > 16384 || size[1] > 16384) {
    *problem = "its tiles have an impossible size";
    return false;
  }
  return true;
}

// Reads and checks the attributes of one part. Sets *last if it has none, which ends a multipart header.
bool check_part(Scanner* scanner, bool* last, std::string* problem) {
  std::string_view name;
  std::string_view type;
  uint32_t size = 0;
  *last = true;
  while (scanner->text(&name)) {
    if (name.empty()) {
      return true;
    }
    *last = false;
    if (!scanner->text(&type) || !scanner->number(&size)) {
      break;
    }
    const uint8_t* value = scanner->here();
    if (!scanner->skip(size)) {
      break;
    }
    if (name == "dataWindow" && (size != 16 || !check_window(value, problem))) {
      return false;
    }
    if (name == "tiles" && (size != 9 || !check_tiles(value, problem))) {
      return false;
    }
  }
  *problem = "its header is incomplete";
  return false;
}

}  // namespace

bool check_exr_header(Bytes file, std::string* problem) {
  Scanner scanner(file);
  uint32_t magic = 0;
  uint32_t version = 0;
  if (!scanner.number(&magic) || !scanner.number(&version)) {
    *problem = "it is truncated";
    return false;
  }
  const int parts = version & kMultipart ? 1024 : 1;
  for (int part = 0; part < parts; part++) {
    bool last = false;
    if (!check_part(&scanner, &last, problem)) {
      if (problem->empty()) {
        *problem = "its header is damaged";
      }
      return false;
    }
    if (last) {
      return true;
    }
  }
  return true;
}

}  // namespace gradus::image
