// A folder for temporary files, removed by the destructor. The process holds a lock on the folder. If the process is
// killed the lock ends, and the next object of this class removes the folder.
#pragma once

#include <string>

namespace gradus {

class TemporaryFolder {
 public:
  // Creates the folder. Throws Error(INVALID_OPERATION) on failure; the message has the parent folder and the system's
  // reason.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int lock_ = -1;
};

// Returns the folder for temporary files: TMPDIR, or the system's default if that is not set.
std::string temporary_path();

}  // namespace gradus
