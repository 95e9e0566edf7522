// Queue of warnings for the user.
#pragma once

#include <deque>
#include <mutex>
#include <string>

namespace gradus {

// A thread-safe queue that accepts each text once, even after the text has been taken.
class Warnings {
 public:
  static constexpr size_t kMax = 1000;

  // Adds a text, unless it has been added before or kMax different texts have been added.
  void add(const std::string& text);
  // Moves the oldest text of the queue to *text and returns true, or returns false if the queue is empty.
  bool take(std::string* text);

 private:
  std::mutex mutex_;
  std::deque<std::string> waiting_, seen_;
};

}  // namespace gradus
