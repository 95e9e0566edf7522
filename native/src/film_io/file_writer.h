// A file that appears as a whole or not at all: written under PATH.<pid>.<host>.part, synced, then renamed
// (contract 7.2). Whoever is killed leaves at most a .part file behind.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace gradus::film_io {

// Whether a file outlasts a crash of the machine. One that is removed before long need not: to sync it would keep the
// disk busy for nothing.
enum class Durable { kYes, kNo };

class FileWriter {
 public:
  // All throw Error(INVALID_OPERATION) with path and the system's reason.
  explicit FileWriter(const std::string& path, Durable durable = Durable::kYes);
  ~FileWriter();  // removes the temporary file unless commit() was called
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  // Of a durable file, most of what was written is on the disk when this returns.
  void write(const void* data, size_t size);
  uint64_t position() const;
  void seek(uint64_t position);
  // It has its name when this returns, and a durable one is on the disk.
  void commit();

 private:
  [[noreturn]] void fail(const char* action) const;
  void sync();
  std::string path_, temporary_;
  Durable durable_;
  std::FILE* file_ = nullptr;
  size_t unsynced_ = 0;
};

// As it is, under another name, in the place of what has that. Throws as FileWriter.
void copy_file(const std::string& path, const std::string& name, Durable durable = Durable::kYes);

}  // namespace gradus::film_io
