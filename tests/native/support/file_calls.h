// Calls of the system by which files are written: in test programs they are counted, and heard.
#pragma once

#include <atomic>
#include <functional>

namespace gradus::test {

// How often a file or a folder was forced to its disk.
extern std::atomic<int> synced_files;
// Called, where there is one, when a file that is open is about to be written.
extern std::function<void()> on_open_file;

}  // namespace gradus::test
