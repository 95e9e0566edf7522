#include "base/spool_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "base/temporary_folder.h"

namespace gradus {

SpoolFile::SpoolFile() : folder_(temporary_path()) {
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

template <class Step>
void SpoolFile::repeat(const char* action, int nothing, size_t size, const Step& step) const {
  for (size_t done = 0; done < size;) {
    const ssize_t more = step(done);
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) fail(action, more < 0 ? errno : nothing);
    done += size_t(more);
  }
}

void SpoolFile::write(uint64_t place, const void* data, size_t size) {
  const auto* from = static_cast<const char*>(data);
  repeat("write", ENOSPC, size,
         [&](size_t done) { return pwrite(descriptor_, from + done, size - done, off_t(place + done)); });
}

void SpoolFile::read(uint64_t place, void* data, size_t size) const {
  auto* to = static_cast<char*>(data);
  repeat("read", EIO, size,
         [&](size_t done) { return pread(descriptor_, to + done, size - done, off_t(place + done)); });
}

}  // namespace gradus
