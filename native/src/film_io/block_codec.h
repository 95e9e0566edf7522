// Packs and unpacks blocks of OpenEXR's ZIP compression: sixteen rows, in each row one channel after the other,
// compressed in zlib's format.
//
// OpenEXR uses zlib for all blocks. That takes two to three times as long for smooth planes, and many times as long for
// noisy sums, which hardly compress.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

struct libdeflate_compressor;
struct libdeflate_decompressor;

namespace gradus::film_io {

inline constexpr int kBlockRows = 16;

using Bytes = std::vector<unsigned char>;

// A codec for one thread. Blocks have an even number of bytes.
class BlockCodec {
 public:
  BlockCodec();
  // Returns the bytes to store for the block: the block itself if compression gains little.
  Bytes pack(const Bytes& block);
  // Unpacks into *block, which has its final size. Returns false if the bytes are damaged.
  bool unpack(const unsigned char* packed, size_t size, Bytes* block);

 private:
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor_;
  std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor_;
  Bytes bytes_;
};

}  // namespace gradus::film_io
