// Hooks in the system calls that write files: test programs count and observe them.
#pragma once

#include <atomic>
#include <functional>

namespace gradus::test {

// Number of fsync calls on files and folders.
extern std::atomic<int> synced_files;
// If set, called before data is written to an open file.
extern std::function<void()> on_open_file;

}  // namespace gradus::test
