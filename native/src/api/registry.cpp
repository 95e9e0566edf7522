#include "api/registry.h"

#include <string>

#include "base/error.h"

namespace gradus::api {
namespace {

constexpr uint32_t kGenerationMask = 0xffffff;

uint64_t pack(HandleType type, uint32_t generation, uint32_t slot) {
  return uint64_t(type) << 56 | uint64_t(generation & kGenerationMask) << 32 | (slot + 1);
}

const char* name_of(HandleType type) {
  switch (type) {
    case HandleType::Device:
      return "device";
    case HandleType::Scene:
      return "scene";
    case HandleType::Render:
      return "render";
    case HandleType::Film:
      return "film";
    case HandleType::Sequence:
      return "sequence";
  }
  return "unknown";
}

}  // namespace

uint64_t Registry::add(HandleType type, std::shared_ptr<void> object) {
  const std::lock_guard lock(mutex_);
  if (free_.empty()) {
    // The list of free slots gets the capacity for all slots, so that remove() never allocates memory.
    if (free_.capacity() == slots_.size()) free_.reserve(2 * slots_.size() + 1);
    slots_.emplace_back();
    free_.push_back(static_cast<uint32_t>(slots_.size() - 1));
  }
  const uint32_t slot = free_.back();
  free_.pop_back();
  slots_[slot].object = std::move(object);
  slots_[slot].type = type;
  return pack(type, slots_[slot].generation, slot);
}

size_t Registry::locate(HandleType type, uint64_t handle) const {
  const std::string name = name_of(type);
  if (handle == 0) throw invalid_argument("the " + name + " handle is 0 (none)");
  const size_t slot = size_t(handle & 0xffffffff) - 1;
  if (slot >= slots_.size()) throw invalid_argument("not a handle of this library where a " + name + " is expected");
  const Slot& s = slots_[slot];
  if (handle >> 56 != uint64_t(type)) {
    const auto given = static_cast<HandleType>(handle >> 56);
    throw invalid_argument("a handle of kind " + std::string(name_of(given)) + " where a " + name + " is expected");
  }
  if (!s.object || pack(s.type, s.generation, static_cast<uint32_t>(slot)) != handle) {
    throw invalid_argument("the " + name + " was released before");
  }
  return slot;
}

std::shared_ptr<void> Registry::find(HandleType type, uint64_t handle) const {
  const std::lock_guard lock(mutex_);
  return slots_[locate(type, handle)].object;
}

std::shared_ptr<void> Registry::remove(HandleType type, uint64_t handle) {
  const std::lock_guard lock(mutex_);
  const size_t slot = locate(type, handle);
  std::shared_ptr<void> object = std::move(slots_[slot].object);
  slots_[slot].object = nullptr;
  slots_[slot].generation = (slots_[slot].generation + 1) & kGenerationMask;
  free_.push_back(static_cast<uint32_t>(slot));
  return object;  // The caller destroys it without the lock, because the destructor of a render waits for its thread.
}

size_t Registry::size() const {
  const std::lock_guard lock(mutex_);
  return slots_.size() - free_.size();
}

Registry& registry() {
  // It is never destroyed, because threads of the host may still call functions while the process ends.
  static Registry* const instance = new Registry;
  return *instance;
}

}  // namespace gradus::api
