// The format of a .gradus file: a header, then records of padded length, the last of kind End. The contents of the
// records are the public structs, whose generated descriptions are in api/archive_records.h, and lists of them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "api/archive.h"
#include "api/archive_records.h"
#include "base/hash.h"

namespace gradus::api {

inline constexpr uint32_t kSceneFormat = 6;

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

// Returns a checksum that detects accidental damage. It does not protect against deliberate changes.
inline uint64_t checksum(const char* data, size_t size) {
  ContentHash hash;
  hash.bytes(data, size);
  return hash.result();
}

// The structs that one call sets, such as lights.
template <class Struct>
struct StructList {
  const Struct* items = nullptr;
  size_t count = 0;
};
using LightList = StructList<GradusLight>;
using ChannelList = StructList<GradusChannel>;

template <class Archive, class Struct>
void visit(Archive& a, StructList<Struct>& list) {
  a.value(list.count);
  a.structs(list.items, list.count);
}

}  // namespace gradus::api
