#include "film_io/block_codec.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <new>

#include <libdeflate.h>

namespace gradus::film_io {
namespace {

// Compression level: the fastest, and within 1 % of the size of the others.
constexpr int kLevel = 1;
constexpr int kMiddle = 128;

template <class T>
T* made(T* object) {
  if (object == nullptr) throw std::bad_alloc();
  return object;
}

// Splits the pairs of bytes [begin, end) into even and odd bytes and writes each as its difference from the byte
// before. High bytes of neighbouring numbers are alike, low bytes are not.
void differentiate(const Bytes& block, size_t begin, size_t end, unsigned char* even, unsigned char* odd) {
  const size_t half = block.size() / 2;
  const unsigned char* const from = block.data();
  const auto difference = [](unsigned char now, unsigned char before) {
    return static_cast<unsigned char>(now - before + kMiddle);
  };
  if (begin == 0) {
    *even++ = from[0];
    *odd++ = difference(from[1], from[2 * half - 2]);
    ++begin;
  }
  for (size_t i = begin; i < end; ++i) {
    *even++ = difference(from[2 * i], from[2 * i - 2]);
    *odd++ = difference(from[2 * i + 1], from[2 * i - 1]);
  }
}

// Reverses differentiate(): sums the differences, sixteen at a time, because one by one each sum would wait for the
// previous one.
void integrate(Bytes* bytes) {
  constexpr size_t kLanes = 16;
  unsigned char* const at = bytes->data();
  const __m128i middle = _mm_set1_epi8(static_cast<char>(kMiddle)), last = _mm_set1_epi8(kLanes - 1);
  at[0] = static_cast<unsigned char>(at[0] + kMiddle);  // The first difference has the same offset as all others.
  __m128i before = _mm_setzero_si128();
  size_t i = 0;
  for (; i + kLanes <= bytes->size(); i += kLanes) {
    auto* const place = reinterpret_cast<__m128i*>(at + i);
    __m128i sum = _mm_sub_epi8(_mm_loadu_si128(place), middle);
    sum = _mm_add_epi8(sum, _mm_slli_si128(sum, 1));
    sum = _mm_add_epi8(sum, _mm_slli_si128(sum, 2));
    sum = _mm_add_epi8(sum, _mm_slli_si128(sum, 4));
    sum = _mm_add_epi8(sum, _mm_slli_si128(sum, 8));
    sum = _mm_add_epi8(sum, before);
    before = _mm_shuffle_epi8(sum, last);
    _mm_storeu_si128(place, sum);
  }
  for (; i < bytes->size(); ++i) at[i] = static_cast<unsigned char>((i > 0 ? at[i - 1] : 0) + at[i] - kMiddle);
}

void join(const Bytes& halves, Bytes* block) {
  const size_t half = block->size() / 2;
  const unsigned char *const even = halves.data(), *const odd = even + half;
  unsigned char* const to = block->data();
  for (size_t i = 0; i < half; ++i) {
    to[2 * i] = even[i];
    to[2 * i + 1] = odd[i];
  }
}

// Returns the entropy of the bytes in bits.
double bits_of(const unsigned char* bytes, size_t size) {
  constexpr size_t kCounts = 4;  // several tables, because equal bytes in a row would wait for one counter
  std::array<std::array<uint32_t, 256>, kCounts> counts{};
  for (size_t i = 0; i < size; ++i) ++counts[i % kCounts][bytes[i]];
  double bits = double(size) * std::log2(double(size));
  for (size_t value = 0; value < 256; ++value) {
    uint32_t count = 0;
    for (const auto& part : counts) count += part[value];
    if (count > 0) bits -= count * std::log2(double(count));
  }
  return bits;
}

// Returns whether the block compresses well, judged by every fourth piece. Most noisy sums lose at most a quarter of
// their size and take most of the time, so they are stored unpacked.
bool is_worth_packing(const Bytes& block) {
  constexpr size_t kPiece = 4096, kEvery = 4;
  constexpr double kShare = 0.72;
  std::array<unsigned char, kPiece> even, odd;
  double bits = 0.0, all = 0.0;
  for (size_t begin = 0; begin < block.size() / 2; begin += kPiece * kEvery) {
    const size_t end = std::min(block.size() / 2, begin + kPiece);
    differentiate(block, begin, end, even.data(), odd.data());
    bits += bits_of(even.data(), end - begin) + bits_of(odd.data(), end - begin);
    all += 16.0 * double(end - begin);
  }
  return bits < kShare * all;
}

}  // namespace

BlockCodec::BlockCodec()
    : compressor_(made(libdeflate_alloc_compressor(kLevel)), libdeflate_free_compressor),
      decompressor_(made(libdeflate_alloc_decompressor()), libdeflate_free_decompressor) {}

Bytes BlockCodec::pack(const Bytes& block) {
  if (!is_worth_packing(block)) return block;  // Readers recognise an unpacked block by its size.
  bytes_.resize(block.size());
  differentiate(block, 0, block.size() / 2, bytes_.data(), bytes_.data() + block.size() / 2);
  Bytes packed(block.size());
  const size_t size =
      libdeflate_zlib_compress(compressor_.get(), bytes_.data(), bytes_.size(), packed.data(), packed.size());
  if (size == 0 || size == block.size()) return block;
  packed.resize(size);
  return packed;
}

bool BlockCodec::unpack(const unsigned char* packed, size_t size, Bytes* block) {
  if (size == block->size()) {
    std::copy_n(packed, size, block->data());
    return true;
  }
  bytes_.resize(block->size());
  size_t read = 0;
  const libdeflate_result result =
      libdeflate_zlib_decompress_ex(decompressor_.get(), packed, size, bytes_.data(), bytes_.size(), &read, nullptr);
  if (result != LIBDEFLATE_SUCCESS || read != size) return false;
  integrate(&bytes_);
  join(bytes_, block);
  return true;
}

}  // namespace gradus::film_io
