#include "frame/block_codec.h"

#include <immintrin.h>
#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <new>

namespace gradus {
namespace {

// The fastest of both libraries, and within 1 % of the size of the others: what is not noise is plain.
constexpr int kLevel = 1;
constexpr int kMiddle = 128;

template <class T>
T* made(T* object) {
  if (object == nullptr) throw std::bad_alloc();
  return object;
}

// Even bytes, then odd ones (high bytes of numbers are alike, low ones are not), each as its difference from the one before.
void differentiate(const Bytes& block, Bytes* differences) {
  const size_t half = block.size() / 2;
  const unsigned char* const from = block.data();
  unsigned char *const even = differences->data(), *const odd = even + half;
  const auto difference = [](unsigned char now, unsigned char before) { return static_cast<unsigned char>(now - before + kMiddle); };
  even[0] = from[0];
  odd[0] = difference(from[1], from[2 * half - 2]);
  for (size_t i = 1; i < half; ++i) {
    even[i] = difference(from[2 * i], from[2 * i - 2]);
    odd[i] = difference(from[2 * i + 1], from[2 * i - 1]);
  }
}

// Sums of differences, sixteen at a time: one by one each would wait for the one before.
void integrate(Bytes* bytes) {
  constexpr size_t kLanes = 16;
  unsigned char* const at = bytes->data();
  const __m128i middle = _mm_set1_epi8(static_cast<char>(kMiddle)), last = _mm_set1_epi8(kLanes - 1);
  at[0] = static_cast<unsigned char>(at[0] + kMiddle);  // as all others
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

// Bytes are looked at in pieces of so many.
constexpr size_t kPiece = 4096;

// What takes time and gains next to nothing: pairs of bytes are alike no more than so many times as often as of pure noise.
bool is_noise(const unsigned char* bytes, size_t size) {
  constexpr uint64_t kTimes = 3;
  constexpr size_t kSums = 4;  // one alone would wait for itself where bytes are the same
  std::array<std::array<uint32_t, 256>, kSums> counts{};
  for (size_t i = 0; i < size; ++i) ++counts[i % kSums][bytes[i]];
  uint64_t alike = 0;
  for (size_t value = 0; value < 256; ++value) {
    uint64_t count = 0;
    for (const auto& part : counts) count += part[value];
    alike += count * count;
  }
  return alike < kTimes * size * size / 256 + size;
}

std::vector<uint8_t> noisy_pieces(const Bytes& bytes) {
  std::vector<uint8_t> noisy;
  noisy.reserve(bytes.size() / kPiece + 1);
  for (size_t i = 0; i < bytes.size(); i += kPiece) noisy.push_back(is_noise(bytes.data() + i, std::min(kPiece, bytes.size() - i)) ? 1 : 0);
  return noisy;
}

// By zlib, which can leave pieces as they are: 0 where it does not fit.
size_t pack_pieces(const Bytes& bytes, const std::vector<uint8_t>& noisy, Bytes* packed) {
  z_stream stream{};
  if (deflateInit(&stream, kLevel) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, deflateEnd);
  stream.next_out = packed->data();
  stream.avail_out = static_cast<uInt>(packed->size());
  for (size_t i = 0; i < bytes.size(); i += kPiece) {
    const size_t piece = i / kPiece;
    if (i == 0 ? noisy[0] != 0 : noisy[piece] != noisy[piece - 1]) {
      if (deflateParams(&stream, noisy[piece] != 0 ? 0 : kLevel, Z_DEFAULT_STRATEGY) != Z_OK) return 0;
    }
    stream.next_in = const_cast<unsigned char*>(bytes.data() + i);  // which it only reads
    stream.avail_in = static_cast<uInt>(std::min(kPiece, bytes.size() - i));
    const bool is_last = i + kPiece >= bytes.size();
    if (deflate(&stream, is_last ? Z_FINISH : Z_NO_FLUSH) != (is_last ? Z_STREAM_END : Z_OK)) return 0;
  }
  return stream.total_out;
}

}  // namespace

BlockCodec::BlockCodec()
    : compressor_(made(libdeflate_alloc_compressor(kLevel)), libdeflate_free_compressor),
      decompressor_(made(libdeflate_alloc_decompressor()), libdeflate_free_decompressor) {}

Bytes BlockCodec::pack(const Bytes& block) {
  bytes_.resize(block.size());
  differentiate(block, &bytes_);
  Bytes packed(block.size());
  const std::vector<uint8_t> noisy = noisy_pieces(bytes_);
  const bool mostly_noise = 2 * size_t(std::count(noisy.begin(), noisy.end(), 1)) > noisy.size();
  const size_t size = mostly_noise
                          ? pack_pieces(bytes_, noisy, &packed)
                          : libdeflate_zlib_compress(compressor_.get(), bytes_.data(), bytes_.size(), packed.data(), packed.size());
  if (size == 0 || size == block.size()) return block;  // readers go by the size
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

}  // namespace gradus
