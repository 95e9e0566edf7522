#include "image/image_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace gradus::image {
namespace {

// Largest file that read_file() accepts: 16 GiB.
constexpr off_t kLargestFile = off_t{1} << 34;

// A file descriptor that is open for reading until the object is destroyed; negative if the file could not be opened.
class Descriptor {
 public:
  // O_NONBLOCK keeps open() from waiting if a path names a pipe or a device by mistake.
  explicit Descriptor(const char* path) : value_(::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~Descriptor() {
    if (value_ >= 0) {
      ::close(value_);
    }
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }

 private:
  int value_;
};

}  // namespace

bool read_file(const std::string& path, std::vector<uint8_t>* bytes, std::string* problem) {
  const Descriptor file(path.c_str());
  struct stat info {};
  if (path.empty() || file.get() < 0 || ::fstat(file.get(), &info) != 0) {
    *problem = path.empty() ? "the path is empty" : std::strerror(errno);
    return false;
  }
  if (!S_ISREG(info.st_mode)) {
    *problem = S_ISDIR(info.st_mode) ? "it is a folder" : "it is not a regular file";
    return false;
  }
  if (info.st_size > kLargestFile) {
    *problem = "it is too large";
    return false;
  }
  bytes->resize(static_cast<size_t>(info.st_size));
  size_t done = 0;
  while (done < bytes->size()) {
    const ssize_t n = ::read(file.get(), bytes->data() + done, bytes->size() - done);
    if (n < 0 && errno == EINTR) {
      continue;
    }
    if (n <= 0) {
      *problem = n < 0 ? std::strerror(errno) : "it became shorter while it was read";
      return false;
    }
    done += static_cast<size_t>(n);
  }
  return true;
}

}  // namespace gradus::image
