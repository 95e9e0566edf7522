// A temporary file without a name. The system removes it when the process ends, even if the process is killed. The
// system's page cache holds its contents while there is free memory, and does not count them as memory in use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace gradus {

class SpoolFile {
 public:
  // Creates the file in the folder for temporary files (TMPDIR). This and all other members throw
  // Error(INVALID_OPERATION) on failure; the message has the folder and the system's reason.
  SpoolFile();
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;

  // Write and read `size` bytes at the byte offset `place`. Threads may call them at the same time for separate ranges.
  void write(uint64_t place, const void* data, size_t size);
  void read(uint64_t place, void* data, size_t size) const;

 private:
  [[noreturn]] void fail(const char* action, int reason) const;
  // Calls step(done) until `size` bytes are done, where `done` is the number so far. The step returns the number of
  // further bytes. 0 is a failure with the reason `nothing`, a negative number is a failure with the reason in errno.
  template <class Step>
  void repeat(const char* action, int nothing, size_t size, const Step& step) const;

  std::string folder_;
  int descriptor_ = -1;
};

}  // namespace gradus
