#include "reconstruct/field_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <vector>

namespace gradus::reconstruct {
namespace {

// Smaller blocks cost no page faults, because the allocator of the process keeps them.
constexpr size_t kMinKept = size_t(1) << 18;

// Blocks that are kept, by their sizes in bytes.
struct Kept {
  std::mutex mutex;
  int owners = 0;
  std::map<size_t, std::vector<float*>> blocks;
};

// It is never destroyed, because fields of static objects may outlive it.
Kept& kept() {
  static Kept& all = *new Kept;
  return all;
}

// Lets the system take back the pages of a block. Those that it has not taken keep their contents.
void let_go(float* block, size_t bytes) {
  static const auto page = uintptr_t(sysconf(_SC_PAGESIZE));
  const uintptr_t begin = (reinterpret_cast<uintptr_t>(block) + page - 1) / page * page,
                  end = (reinterpret_cast<uintptr_t>(block) + bytes) / page * page;
  if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_FREE);
}

// Returns a kept block of this size, or nullptr.
float* take_kept(size_t bytes) {
  Kept& all = kept();
  const std::lock_guard lock(all.mutex);
  const auto found = all.blocks.find(bytes);
  if (found == all.blocks.end() || found->second.empty()) return nullptr;
  float* const block = found->second.back();
  found->second.pop_back();
  return block;
}

// Keeps a block if a KeptFieldMemory exists. Returns whether it does.
bool keep(float* block, size_t bytes) noexcept {
  Kept& all = kept();
  const std::lock_guard lock(all.mutex);
  if (all.owners == 0) return false;
  let_go(block, bytes);
  try {
    all.blocks[bytes].push_back(block);
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

}  // namespace

KeptFieldMemory::KeptFieldMemory() {
  const std::lock_guard lock(kept().mutex);
  ++kept().owners;
}

KeptFieldMemory::~KeptFieldMemory() {
  Kept& all = kept();
  const std::lock_guard lock(all.mutex);
  if (--all.owners > 0) return;
  for (const auto& [bytes, blocks] : all.blocks) {
    for (float* block : blocks) ::operator delete(block);
  }
  all.blocks.clear();
}

size_t kept_field_bytes() {
  const std::lock_guard lock(kept().mutex);
  size_t sum = 0;
  for (const auto& [bytes, blocks] : kept().blocks) sum += bytes * blocks.size();
  return sum;
}

float* take_field_memory(size_t count) {
  const size_t bytes = count * sizeof(float);
  float* block = bytes >= kMinKept ? take_kept(bytes) : nullptr;
  if (block == nullptr) block = static_cast<float*>(::operator new(bytes));
  std::memset(block, 0, bytes);
  return block;
}

void free_field_memory(float* memory, size_t count) noexcept {
  const size_t bytes = count * sizeof(float);
  if (bytes >= kMinKept && keep(memory, bytes)) return;
  ::operator delete(memory);
}

}  // namespace gradus::reconstruct
