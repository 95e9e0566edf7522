// Writes a file atomically: under PATH.<pid>.<host>.part, synced, then renamed. A killed process leaves at most a .part
// file.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace gradus::film_io {

// Whether a file survives a crash of the machine. A temporary file need not, and to sync it would only load the disk.
enum class Durable { kYes, kNo };

class FileWriter {
 public:
  // All functions throw Error(INVALID_OPERATION) with path and the system's reason.
  explicit FileWriter(const std::string& path, Durable durable = Durable::kYes);
  ~FileWriter();  // removes the temporary file unless commit() was called
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  // Appends bytes. Durable files are synced regularly.
  void write(const void* data, size_t size);
  uint64_t position() const;
  void seek(uint64_t position);
  // Renames the file to its final name. A durable file is on the disk on return.
  void commit();

 private:
  [[noreturn]] void fail(const char* action) const;
  void sync();
  std::string path_, temporary_;
  Durable durable_;
  std::FILE* file_ = nullptr;
  size_t unsynced_ = 0;
};

// Copies a file and replaces an existing one. Throws as FileWriter does.
void copy_file(const std::string& path, const std::string& name, Durable durable = Durable::kYes);

}  // namespace gradus::film_io
