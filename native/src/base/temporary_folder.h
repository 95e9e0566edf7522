// A folder for temporary files that goes with its owner. Where the owner is killed it goes when the next one is made:
// it is locked while its owner lives.
#pragma once

#include <string>

namespace gradus {

class TemporaryFolder {
 public:
  // Throws Error(INVALID_OPERATION) with the folder it would lie in and the system's reason.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int lock_ = -1;
};

// Where temporary files lie: TMPDIR or what the system has in its place.
std::string temporary_path();

}  // namespace gradus
