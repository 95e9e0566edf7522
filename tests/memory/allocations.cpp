#include "memory/allocations.h"

#include <malloc.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>

namespace {

std::atomic<uint64_t> requests{0}, refused_request{0};
std::atomic<bool> refused{false};
std::atomic<int64_t> pieces{0}, bytes{0}, max_bytes{0};
std::atomic<int> unrefused{0};

// Adds the size of an allocation to the bytes in use and updates their maximum.
void count(void* memory) noexcept {
  const int64_t now = bytes += int64_t(malloc_usable_size(memory));
  int64_t maximum = max_bytes;
  while (now > maximum && !max_bytes.compare_exchange_weak(maximum, now)) {
  }
}

// Returns memory, or nullptr if this is the allocation that refuse() selected.
void* allocate(size_t size, size_t alignment) noexcept {
  const uint64_t k = unrefused == 0 ? ++requests : 0;
  if (k != 0 && k == refused_request.load(std::memory_order_relaxed)) {
    refused = true;
    return nullptr;
  }
  ++pieces;
  void* memory = alignment <= alignof(std::max_align_t)
                     ? std::malloc(size)
                     : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  count(memory);
  return memory;
}

void* allocate_or_throw(size_t size, size_t alignment) {
  if (void* memory = allocate(size, alignment)) return memory;
  throw std::bad_alloc();
}

void release(void* memory) noexcept {
  if (memory == nullptr) return;
  --pieces;
  bytes -= int64_t(malloc_usable_size(memory));
  std::free(memory);
}

// Returns the number of entries of a folder.
int entries(const char* folder) {
  int count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
  return count;
}

}  // namespace

namespace gradus::memory {

uint64_t refuse(uint64_t k) {
  const uint64_t made = requests.exchange(0);
  refused = false;
  refused_request = k;
  return made;
}

Unrefused::Unrefused() { ++unrefused; }
Unrefused::~Unrefused() { --unrefused; }

bool was_refused() { return refused; }
int64_t live() { return pieces; }
int64_t live_bytes() { return bytes; }
int64_t peak_bytes() { return max_bytes; }
void forget_peak() { max_bytes = bytes.load(); }

uint64_t resident_bytes() {
  malloc_trim(0);  // memory that the allocator keeps for later use is not a leak
  unsigned long total = 0, resident = 0;
  FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr || std::fscanf(file, "%lu %lu", &total, &resident) != 2) resident = 0;
  if (file != nullptr) std::fclose(file);
  return uint64_t(resident) * uint64_t(sysconf(_SC_PAGESIZE));
}

int descriptors() { return entries("/proc/self/fd"); }
int threads() { return entries("/proc/self/task"); }

}  // namespace gradus::memory

void* operator new(size_t size) { return allocate_or_throw(size, 1); }
void* operator new[](size_t size) { return allocate_or_throw(size, 1); }
void* operator new(size_t size, std::align_val_t alignment) { return allocate_or_throw(size, size_t(alignment)); }
void* operator new[](size_t size, std::align_val_t alignment) { return allocate_or_throw(size, size_t(alignment)); }
void* operator new(size_t size, const std::nothrow_t&) noexcept { return allocate(size, 1); }
void* operator new[](size_t size, const std::nothrow_t&) noexcept { return allocate(size, 1); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, size_t) noexcept { release(memory); }
void operator delete[](void* memory, size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, size_t, std::align_val_t) noexcept { release(memory); }
