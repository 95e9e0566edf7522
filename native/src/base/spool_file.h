// A temporary file without a name: it goes when whoever uses it goes, however that ends. What is in it is in memory as
// far as the system has room, and counts as free there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace gradus {

class SpoolFile {
 public:
  // In the folder for temporary files (TMPDIR). All throw Error(INVALID_OPERATION) with the folder and the system's
  // reason.
  SpoolFile();
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;

  // Thread-safe where places differ.
  void write(uint64_t place, const void* data, size_t size);
  void read(uint64_t place, void* data, size_t size) const;

 private:
  [[noreturn]] void fail(const char* action, int reason) const;
  // Until all is done: step(done) does more and returns how much, 0 for the reason `nothing`, below 0 for errno's.
  template <class Step>
  void repeat(const char* action, int nothing, size_t size, const Step& step) const;

  std::string folder_;
  int descriptor_ = -1;
};

}  // namespace gradus
