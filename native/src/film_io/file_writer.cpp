#include "film_io/file_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

#include "base/error.h"
#include "base/fault.h"
#include "film_io/temporary_file.h"

namespace gradus::film_io {
namespace {

// Syncs the folder so that the new name survives a power failure. Failures are ignored, because not every file system
// supports it and the data is on the disk already.
void sync_folder_of(const std::string& path) {
  const size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
  const int fd = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  fsync(fd);
  close(fd);
}

// Maximum number of bytes between two syncs. A sync cannot be cancelled, and one of half a 4K film takes seconds.
constexpr size_t kMaxUnsynced = size_t{1} << 25;

}  // namespace

FileWriter::FileWriter(const std::string& path, Durable durable) : path_(path), durable_(durable) {
  const TemporaryFile part = make_temporary_file(path);
  if (part.descriptor < 0) fail("create");
  temporary_ = part.name;
  if (GRADUS_FAULT(stored_frame_named_before_complete) && rename(part.name.c_str(), path.c_str()) == 0)
    temporary_ = path;
  file_ = fdopen(part.descriptor, "wb");
  if (file_ == nullptr) {
    close(part.descriptor);
    unlink(temporary_.c_str());
    fail("create");
  }
}

FileWriter::~FileWriter() {
  if (!file_) return;
  std::fclose(file_);
  unlink(temporary_.c_str());
}

void FileWriter::fail(const char* action) const {
  throw Error(GRADUS_ERROR_INVALID_OPERATION,
              std::string("cannot ") + action + " " + path_ + ": " + std::strerror(errno));
}

void FileWriter::write(const void* data, size_t size) {
  if (size > 0 && std::fwrite(data, 1, size, file_) != size) fail("write");
  unsynced_ += size;
  if (durable_ == Durable::kYes && unsynced_ >= kMaxUnsynced) sync();
}

void FileWriter::sync() {
  if (std::fflush(file_) != 0 || fsync(fileno(file_)) != 0) fail("write");
  unsynced_ = 0;
}

uint64_t FileWriter::position() const {
  const off_t position = ftello(file_);
  if (position < 0) fail("write");
  return uint64_t(position);
}

void FileWriter::seek(uint64_t position) {
  if (fseeko(file_, off_t(position), SEEK_SET) != 0) fail("write");
}

void FileWriter::commit() {
  const bool is_durable = durable_ == Durable::kYes;
  if (is_durable) sync();
  const int closed = std::fclose(file_);
  file_ = nullptr;
  if (closed != 0 || rename(temporary_.c_str(), path_.c_str()) != 0) {
    const int reason = errno;
    unlink(temporary_.c_str());
    errno = reason;
    fail("write");
  }
  if (GRADUS_FAULT(temporary_file_remains) && link(path_.c_str(), temporary_.c_str()) != 0) fail("link");
  if (is_durable) sync_folder_of(path_);
}

void copy_file(const std::string& path, const std::string& name, Durable durable) {
  constexpr size_t kPiece = 1 << 20;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> from(std::fopen(path.c_str(), "rb"), std::fclose);
  const auto refuse = [&] {
    throw Error(GRADUS_ERROR_INVALID_OPERATION, "cannot read " + path + ": " + std::strerror(errno));
  };
  if (!from) refuse();
  FileWriter to(name, durable);
  std::vector<char> piece(kPiece);
  for (size_t size = kPiece; size == kPiece;) {
    size = std::fread(piece.data(), 1, kPiece, from.get());
    to.write(piece.data(), size);
  }
  if (std::ferror(from.get()) != 0) refuse();
  to.commit();
}

}  // namespace gradus::film_io
