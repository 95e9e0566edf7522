// Texts for people, each once, until somebody takes them.
#pragma once

#include <deque>
#include <mutex>
#include <string>

namespace gradus {

class Warnings {
 public:
  static constexpr size_t kMax = 1000;

  // Each text is kept once; at most kMax in all.
  void add(const std::string& text);
  // The oldest that nobody has taken; false: there is none.
  bool take(std::string* text);

 private:
  std::mutex mutex_;
  std::deque<std::string> waiting_, seen_;
};

}  // namespace gradus
