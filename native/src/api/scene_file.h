// The frame of a .gradus file: a header, then records of padded length, the last of kind End.
#pragma once

#include <cstddef>
#include <cstdint>

#include "api/archive.h"

namespace gradus::api {

inline constexpr uint32_t kSceneFormat = 4;

struct FileHeader {
  char magic[8] = {'G', 'R', 'A', 'D', 'U', 'S', 'S', '\n'};
  uint32_t format = kSceneFormat;
  uint32_t byte_order = 0x01020304;
};
static_assert(sizeof(FileHeader) == kArchiveAlignment);

struct RecordHeader {
  uint32_t kind;
  uint32_t reserved;
  uint64_t key;
  uint64_t size;      // of the payload, without padding
  uint64_t checksum;  // of the payload
};
static_assert(sizeof(RecordHeader) % kArchiveAlignment == 0);

inline uint64_t padded(uint64_t size) { return (size + kArchiveAlignment - 1) / kArchiveAlignment * kArchiveAlignment; }

// FNV-1a over 8 bytes at a time: finds damage, not intent.
inline uint64_t checksum(const char* data, size_t size) {
  uint64_t hash = 0xcbf29ce484222325u;
  size_t i = 0;
  for (; i + 8 <= size; i += 8) {
    uint64_t word;
    std::memcpy(&word, data + i, 8);
    hash = (hash ^ word) * 0x100000001b3u;
    hash ^= hash >> 32;
  }
  for (; i < size; ++i) hash = (hash ^ static_cast<unsigned char>(data[i])) * 0x100000001b3u;
  return hash;
}

}  // namespace gradus::api
