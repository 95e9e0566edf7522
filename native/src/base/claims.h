// What jobs of one host that go on side by side have planned to take of the machine: layers and views of an animation.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace gradus {

// In bytes.
struct Claim {
  uint64_t memory = 0;                    // at a time, while it is at work
  uint64_t kept = 0;                      // of that, while another is
  std::map<std::string, uint64_t> files;  // by folder
};

class Claims {
 public:
  // In place of what the owner claimed before.
  void set(const void* owner, Claim claim);
  void drop(const void* owner);
  // Of all together; one is at work at a time.
  Claim sum() const;

 private:
  mutable std::mutex mutex_;
  std::map<const void*, Claim> claims_;
};

}  // namespace gradus
