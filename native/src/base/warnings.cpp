#include "base/warnings.h"

#include <algorithm>

namespace gradus {

void Warnings::add(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (seen_.size() >= kMax || std::find(seen_.begin(), seen_.end(), text) != seen_.end()) return;
  seen_.push_back(text);
  waiting_.push_back(text);
}

bool Warnings::take(std::string* text) {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return false;
  *text = std::move(waiting_.front());
  waiting_.pop_front();
  return true;
}

}  // namespace gradus
