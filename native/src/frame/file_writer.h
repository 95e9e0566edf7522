// A file that appears as a whole or not at all: written under PATH.<pid>.<host>.part, synced, then renamed (contract 7.2). Whoever is
// killed leaves at most a .part file behind.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace gradus {

class FileWriter {
 public:
  // All throw Error(INVALID_OPERATION) with path and the system's reason.
  explicit FileWriter(const std::string& path);
  ~FileWriter();  // removes the temporary file unless commit() was called
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  void write(const void* data, size_t size);
  uint64_t position() const;
  void seek(uint64_t position);
  // Everything is on the disk and has its name when this returns.
  void commit();

 private:
  [[noreturn]] void fail(const char* action) const;
  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
};

// As it is, under another name, in the place of what has that. Throws as FileWriter.
void copy_file(const std::string& path, const std::string& name);

}  // namespace gradus
