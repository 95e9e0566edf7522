#include "base/spool_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "base/temporary_folder.h"

namespace gradus {

SpoolFile::SpoolFile() : folder_(temporary_place()) {
  std::string name = folder_ + "/gradus-XXXXXX";
  descriptor_ = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) fail("make", errno);
  unlink(name.c_str());
}

SpoolFile::~SpoolFile() { close(descriptor_); }

void SpoolFile::fail(const char* action, int reason) const {
  throw Error(GRADUS_ERROR_INVALID_OPERATION,
              std::string("cannot ") + action + " a temporary file in " + folder_ + ": " + std::strerror(reason));
}

void SpoolFile::write(uint64_t place, const void* data, size_t size) {
  const auto* from = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = pwrite(descriptor_, from, size, off_t(place));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("write", n < 0 ? errno : ENOSPC);
    from += n;
    place += uint64_t(n);
    size -= size_t(n);
  }
}

void SpoolFile::read(uint64_t place, void* data, size_t size) const {
  auto* to = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t n = pread(descriptor_, to, size, off_t(place));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("read", n < 0 ? errno : EIO);
    to += n;
    place += uint64_t(n);
    size -= size_t(n);
  }
}

}  // namespace gradus
