// Memory of fields.
//
// A system clears every page that it gives to a process, and a page fault costs more than most passes over the page. In
// an animation all pictures need the same fields, so the memory of freed ones is kept for the next ones. The system may
// take the pages back whenever it needs them: they are marked as free, but stay until then.
#pragma once

#include <cstddef>
#include <type_traits>

namespace gradus::reconstruct {

// Keeps the memory of freed fields for as long as such an object exists, also for fields of others. Results do not
// depend on it.
class KeptFieldMemory {
 public:
  KeptFieldMemory();
  ~KeptFieldMemory();
  KeptFieldMemory(const KeptFieldMemory&) = delete;
  KeptFieldMemory& operator=(const KeptFieldMemory&) = delete;
};

// Returns the number of bytes that are kept now.
size_t kept_field_bytes();

// Returns `count` floats, all of them 0. Throws std::bad_alloc.
float* take_field_memory(size_t count);
// Gives back what take_field_memory(count) returned.
void free_field_memory(float* memory, size_t count) noexcept;

// Allocator of vectors of floats that are made with a number of zeros, which take_field_memory() has written.
template <class T>
struct FieldAllocator {
  using value_type = T;
  static_assert(std::is_same_v<T, float>);

  FieldAllocator() = default;
  T* allocate(size_t count) { return take_field_memory(count); }
  void deallocate(T* memory, size_t count) noexcept { free_field_memory(memory, count); }
  void construct(T*) {}
  void construct(T* at, T value) { *at = value; }
  friend bool operator==(const FieldAllocator&, const FieldAllocator&) { return true; }
};

}  // namespace gradus::reconstruct
