#include "film_io/temporary_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

namespace gradus::film_io {
namespace {

namespace fs = std::filesystem;

std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "host";
  return name.data();
}

std::string ending() { return std::string(".") + host_name() + ".part"; }

// Returns the number of the process that wrote this host's part file, or 0 if the name is none. A process numbers
// further part files, such as 123-2.
pid_t process_of(const std::string& name) {
  const std::string end = ending();
  if (name.size() <= end.size() || name.compare(name.size() - end.size(), end.size(), end) != 0) return 0;
  const std::string rest = name.substr(0, name.size() - end.size()), number = rest.substr(rest.rfind('.') + 1);
  pid_t process = 0;
  const auto [after, problem] = std::from_chars(number.data(), number.data() + number.size(), process);
  const bool whole = after == number.data() + number.size() || *after == '-';
  return problem == std::errc() && whole && rest.size() > number.size() ? process : 0;
}

bool is_alive(pid_t process) { return kill(process, 0) == 0 || errno != ESRCH; }

// Deletes a part file unless a writer holds its lock. A dead process number is not enough: a container on this host may
// number its processes by itself.
void remove_unlocked(const fs::path& temporary) {
  const int descriptor = open(temporary.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) unlink(temporary.c_str());
  close(descriptor);
}

void remove_stale_files(const fs::path& folder) {
  std::error_code problem;
  for (fs::directory_iterator file(folder, problem), end; !problem && file != end; file.increment(problem)) {
    const pid_t process = process_of(file->path().filename().string());
    if (process > 0 && !is_alive(process)) remove_unlocked(file->path());
  }
}

// Returns whether a process looks at this folder for the first time. Looking through the folder of a long animation at
// each frame would take longer and longer. A table of hashes remembers only the last folders.
bool is_first_use(const std::string& folder) {
  static std::mutex mutex;
  static std::array<size_t, 64> used{};
  static size_t uses = 0;
  const size_t key = std::hash<std::string>{}(folder);
  const std::lock_guard lock(mutex);
  if (std::find(used.begin(), used.end(), key) != used.end()) return false;
  used[uses++ % used.size()] = key;
  return true;
}

// Returns the first name of a part file for which `make` succeeds.
template <class Make>
std::string first_free(const std::string& path, const Make& make) {
  const std::string process = std::to_string(getpid());
  for (int n = 1;; ++n) {
    std::string name = path + "." + (n == 1 ? process : process + "-" + std::to_string(n)) + ending();
    if (make(name) || errno != EEXIST) return name;
  }
}

}  // namespace

TemporaryFile make_temporary_file(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path(), folder = parent.empty() ? "." : parent;
  if (is_first_use(folder)) remove_stale_files(folder);
  TemporaryFile temporary;
  temporary.name = first_free(path, [&](const std::string& name) {
    temporary.descriptor = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    return temporary.descriptor >= 0;
  });
  if (temporary.descriptor >= 0)
    flock(temporary.descriptor, LOCK_EX | LOCK_NB);  // On a file system without locks the process number is enough.
  return temporary;
}

bool hard_link_file(const std::string& path, const std::string& name) {
  bool linked = false;
  const std::string temporary = first_free(name, [&](const std::string& free) {
    linked = link(path.c_str(), free.c_str()) == 0;
    return linked;
  });
  if (!linked) return false;
  const bool named = rename(temporary.c_str(), name.c_str()) == 0;
  unlink(temporary.c_str());  // rename() keeps it if both were names of one file.
  return named;
}

}  // namespace gradus::film_io
