#include "support/file_calls.h"

#include <dlfcn.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdio>

namespace gradus::test {

std::atomic<int> synced_files{0};
std::function<void()> on_open_file;

}  // namespace gradus::test

// Replaces the function of the C library.
extern "C" int fsync(int descriptor) {
  ++gradus::test::synced_files;
  return int(syscall(SYS_fsync, descriptor));
}

extern "C" std::FILE* fdopen(int descriptor, const char* mode) {
  using Open = std::FILE* (*)(int, const char*);
  static const auto open = reinterpret_cast<Open>(dlsym(RTLD_NEXT, "fdopen"));
  if (gradus::test::on_open_file) gradus::test::on_open_file();
  return open(descriptor, mode);
}
