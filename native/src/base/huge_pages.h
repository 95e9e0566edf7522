// Memory for large arrays that are read in random order. With pages of 4 KiB nearly every access would miss the TLB.
#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace gradus {

// Allocator that requests huge pages (2 MiB) for arrays of at least that size. The request is a hint: a system without
// huge pages returns ordinary memory.
template <class T>
struct HugePageAllocator {
  using value_type = T;
  static constexpr size_t kPage = size_t(1) << 21;

  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>&) {}

  T* allocate(size_t count) {
    const size_t bytes = count * sizeof(T);
    const size_t alignment = bytes < kPage ? std::max(alignof(std::max_align_t), alignof(T)) : kPage;
    void* memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    if (alignment == kPage) madvise(memory, bytes, MADV_HUGEPAGE);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, size_t) { std::free(memory); }
  // Leaves the elements that resize() adds as they are, so that the threads that compute them touch their pages first.
  template <class U>
  void construct(U*) {
    static_assert(std::is_trivially_copyable_v<U> && std::is_trivially_destructible_v<U>);
  }
  template <class U, class First, class... Rest>
  void construct(U* element, First&& first, Rest&&... rest) {
    std::construct_at(element, std::forward<First>(first), std::forward<Rest>(rest)...);
  }
  friend bool operator==(const HugePageAllocator&, const HugePageAllocator&) { return true; }
};

// resize() leaves new elements uninitialised.
template <class T>
using HugePageVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace gradus
