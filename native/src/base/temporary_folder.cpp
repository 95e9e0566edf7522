#include "base/temporary_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/error.h"

namespace gradus {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "gradus-frames-";

int open_folder(const fs::path& folder) {
  return open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

// Removes a folder unless a living process holds its lock.
void remove_unlocked(const fs::path& folder) {
  const int lock = open_folder(folder);
  if (lock < 0) return;
  std::error_code ignored;
  if (flock(lock, LOCK_EX | LOCK_NB) == 0) fs::remove_all(folder, ignored);
  close(lock);
}

// Removes all temporary folders of this class whose owners were killed.
void remove_stale_folders(const fs::path& place) {
  std::error_code problem;
  for (fs::directory_iterator entry(place, problem), end; !problem && entry != end; entry.increment(problem)) {
    if (entry->path().filename().string().rfind(kPrefix, 0) == 0) remove_unlocked(entry->path());
  }
}

}  // namespace

std::string temporary_path() {
  std::error_code error;
  const fs::path place = fs::temp_directory_path(error);
  return error ? "/tmp" : place.string();
}

TemporaryFolder::TemporaryFolder() {
  const fs::path place = temporary_path();
  remove_stale_folders(place);
  const auto fail = [&](int reason) {
    throw Error(GRADUS_ERROR_INVALID_OPERATION,
                "cannot make a temporary folder in " + place.string() + ": " + std::strerror(reason));
  };
  while (lock_ < 0) {
    path_ = (place / (std::string(kPrefix) + "XXXXXX")).string();
    if (mkdtemp(path_.data()) == nullptr) fail(errno);
    lock_ = open_folder(path_);
    if (lock_ < 0 && errno == ENOENT) continue;  // another process removed it as stale before it was locked
    if (lock_ < 0) {
      const int reason = errno;
      rmdir(path_.c_str());
      fail(reason);
    }
    flock(lock_, LOCK_EX);
    if (fs::exists(path_)) return;
    close(lock_);
    lock_ = -1;
  }
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  close(lock_);
}

}  // namespace gradus
