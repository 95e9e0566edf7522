// Blocks of OpenEXR's ZIP compression: sixteen rows, of each row one channel after the other, packed in zlib's format.
//
// OpenEXR does the same by zlib alone, and packs all. That takes two to three times as long where planes are smooth,
// and many times as long where they are noisy sums, which are hardly worth packing.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

struct libdeflate_compressor;
struct libdeflate_decompressor;

namespace gradus::film_io {

inline constexpr int kBlockRows = 16;

using Bytes = std::vector<unsigned char>;

// For one thread. Blocks have an even number of bytes.
class BlockCodec {
 public:
  BlockCodec();
  // What stands in a file for the block: the block itself where packing gains little.
  Bytes pack(const Bytes& block);
  // *block has its size. False: the bytes stand for no such block.
  bool unpack(const unsigned char* packed, size_t size, Bytes* block);

 private:
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor_;
  std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor_;
  Bytes bytes_;
};

}  // namespace gradus::film_io
