// Handles of the C API. Numbers that are not handles of living objects are refused, and never used as an address.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace gradus::api {

enum class HandleType : uint8_t { Device = 1, Scene = 2, Render = 3, Film = 4, Sequence = 5 };

// A handle is type (8 bit) | generation of the slot (24 bit) | slot + 1 (32 bit). A slot's generation rises with each
// removal, so that a freed handle stays invalid when the slot is used again.
class Registry {
 public:
  uint64_t add(HandleType type, std::shared_ptr<void> object);
  // find() and remove() return the object of a handle. They throw invalid_argument, with the reason, for other numbers.
  std::shared_ptr<void> find(HandleType type, uint64_t handle) const;
  std::shared_ptr<void> remove(HandleType type, uint64_t handle);
  size_t size() const;

 private:
  struct Slot {
    std::shared_ptr<void> object;
    uint32_t generation = 1;
    HandleType type = HandleType::Device;
  };
  // Returns the index of a handle's slot. The caller holds the lock.
  size_t locate(HandleType type, uint64_t handle) const;

  mutable std::mutex mutex_;
  std::vector<Slot> slots_;
  std::vector<uint32_t> free_;
};

// Returns the registry of the process. It is global because a handle is all that a C function receives.
Registry& registry();

// HandleOf<T>::type is the type of the handles to objects of class T.
template <class T>
struct HandleOf;

template <class T>
uint64_t add_handle(std::shared_ptr<T> object) {
  return registry().add(HandleOf<T>::type, std::move(object));
}

template <class T>
std::shared_ptr<T> find_handle(uint64_t handle) {
  return std::static_pointer_cast<T>(registry().find(HandleOf<T>::type, handle));
}

template <class T>
std::shared_ptr<T> remove_handle(uint64_t handle) {
  return std::static_pointer_cast<T>(registry().remove(HandleOf<T>::type, handle));
}

}  // namespace gradus::api
