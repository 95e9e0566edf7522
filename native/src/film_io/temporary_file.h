// Temporary files PATH.<pid>.<host>.part. No two writers share one, and each is locked while its writer lives, so that
// files of killed writers can be recognised.
#pragma once

#include <string>

namespace gradus::film_io {

struct TemporaryFile {
  std::string name;
  int descriptor = -1;  // -1: it could not be made, for errno's reason
};

// Creates and locks a new file. Removes those that dead processes of this host left in its folder.
TemporaryFile make_temporary_file(const std::string& path);
// Creates a second name for a file in the same folder and replaces an existing one. Returns false if the file system
// does not support it.
bool hard_link_file(const std::string& path, const std::string& name);

}  // namespace gradus::film_io
