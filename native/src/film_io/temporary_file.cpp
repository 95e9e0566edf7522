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

// Of this host's part file; 0: it is none. The threads of a process count theirs up, as 123-2.
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

// By the lock, too: a container on this host may have numbers of its own for its processes.
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

// Once in a process: to look through a long animation's folder at each frame takes longer and longer. Of the last
// folders, by a hash: temporary ones come and go.
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

// The first part file's name that `make` can give to something.
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
    flock(temporary.descriptor, LOCK_EX | LOCK_NB);  // where it cannot be, the process's number is enough
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
  unlink(temporary.c_str());  // it stays where both were names of one file already
  return named;
}

}  // namespace gradus::film_io
