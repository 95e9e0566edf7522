// Files that are being written, PATH.<pid>.<host>.part: no two writers have one in common, and each is locked while its
// writer lives, so that what a killed one has left is known.
#pragma once

#include <string>

namespace gradus::film_io {

struct TemporaryFile {
  std::string name;
  int descriptor = -1;  // -1: it could not be made, for errno's reason
};

// New and locked. Those that dead processes of this host have left in its folder are removed.
TemporaryFile make_temporary_file(const std::string& path);
// A second name for a file in the same folder, in the place of what has it. False: not every file system can do it.
bool hard_link_file(const std::string& path, const std::string& name);

}  // namespace gradus::film_io
