// Hooks in the system calls that write files, and disks that become full.
#pragma once

#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <exception>
#include <functional>
#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace gradus::test {

// Number of fsync calls on files and folders.
extern std::atomic<int> synced_files;
// If set, called when the library opens a stream to write to an open file.
extern std::function<void()> on_open_file;

// Runs `prepare` and then `write` in a process of its own. Returns the error message of `write`, or ""; nothing if
// `prepare` returned false.
inline std::optional<std::string> failure_of(const std::function<bool()>& prepare, const std::function<void()>& write) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    if (!prepare()) _exit(1);
    std::string what;
    try {
      write();
    } catch (const std::exception& e) {
      what = e.what();
    }
    const ssize_t written = ::write(ends[1], what.data(), what.size());
    _exit(written == ssize_t(what.size()) ? 0 : 2);
  }
  close(ends[1]);
  std::string what;
  char text[256];
  for (ssize_t n = 0; (n = ::read(ends[0], text, sizeof(text))) > 0;) what.append(text, size_t(n));
  close(ends[0]);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) < 2) << status;
  return status == 0 ? std::optional(what) : std::nullopt;
}

// Mounts a disk of that size ("100k") over a folder, in a name space of its own. Returns false where that is not
// permitted.
inline bool mount_disk(const std::string& folder, const char* size) {
  return (unshare(CLONE_NEWNS) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) &&
         mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", folder.c_str(), "tmpfs", 0, ("size=" + std::string(size)).c_str()) == 0;
}

}  // namespace gradus::test
