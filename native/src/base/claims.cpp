#include "base/claims.h"

#include <algorithm>

namespace gradus {

void Claims::set(const void* owner, Claim claim) {
  const std::lock_guard lock(mutex_);
  claims_[owner] = std::move(claim);
}

void Claims::drop(const void* owner) {
  const std::lock_guard lock(mutex_);
  claims_.erase(owner);
}

Claim Claims::sum() const {
  const std::lock_guard lock(mutex_);
  Claim all;
  uint64_t most_at_work = 0;
  for (const auto& [owner, claim] : claims_) {
    all.kept += claim.kept;
    most_at_work = std::max(most_at_work, claim.memory - claim.kept);
    for (const auto& [folder, bytes] : claim.files) all.files[folder] += bytes;
  }
  all.memory = all.kept + most_at_work;
  return all;
}

}  // namespace gradus
