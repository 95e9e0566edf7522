// Packing and unpacking blocks of rows of a stored film.
#include "film_io/block_codec.h"

#include <cstring>
#include <random>

#include <gtest/gtest.h>

namespace gradus::block_codec_test {
namespace {

film_io::Bytes noise(size_t size) {
  std::mt19937 random(3);
  film_io::Bytes bytes(size);
  for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random());
  return bytes;
}

// Returns floats near 1 whose low bits are noise, like sums of samples.
film_io::Bytes floats(size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(1.0f, 2.0f);
  film_io::Bytes bytes(4 * count);
  for (size_t i = 0; i < count; ++i) {
    const float value = uniform(random);
    std::memcpy(bytes.data() + 4 * i, &value, sizeof(value));
  }
  return bytes;
}

TEST(BlockCodec, UnpackingReversesPacking) {
  film_io::BlockCodec codec;
  film_io::Bytes mixed = noise(100000);  // mostly noise, with compressible stretches
  std::fill(mixed.begin() + 20000, mixed.begin() + 30000, static_cast<unsigned char>(9));
  for (const film_io::Bytes& block :
       {film_io::Bytes(4, 7), film_io::Bytes(100000, 0), noise(4), noise(4000), noise(1 << 20), floats(50000), mixed}) {
    const film_io::Bytes packed = codec.pack(block);
    EXPECT_LE(packed.size(), block.size());
    film_io::Bytes back(block.size());
    ASSERT_TRUE(codec.unpack(packed.data(), packed.size(), &back));
    EXPECT_EQ(back, block);
  }
}

TEST(BlockCodec, EqualValuesTakeAlmostNoSpace) {
  EXPECT_LT(film_io::BlockCodec().pack(film_io::Bytes(1 << 20, 0)).size(), size_t{4096});
}

TEST(BlockCodec, StretchesBetweenNoiseArePacked) {
  film_io::Bytes block = noise(400000);
  std::fill(block.begin(), block.begin() + 200000, static_cast<unsigned char>(0));
  const size_t size = film_io::BlockCodec().pack(block).size();
  EXPECT_GE(size, size_t{200000});
  EXPECT_LT(size, size_t{203000});
}

// Packing sums of samples took nine tenths of the time of writing a film and saved a sixth of its size.
TEST(BlockCodec, SumsOfNoisySamplesStayUnpacked) {
  EXPECT_EQ(film_io::BlockCodec().pack(floats(50000)).size(), size_t{200000});
}

// Noise would not get smaller. Readers recognise an unpacked block by its size.
TEST(BlockCodec, NoiseStaysUnpacked) { EXPECT_EQ(film_io::BlockCodec().pack(noise(1 << 16)), noise(1 << 16)); }

TEST(BlockCodec, DamagedBlocksAreRefused) {
  film_io::BlockCodec codec;
  const film_io::Bytes block = floats(20000);
  film_io::Bytes packed = codec.pack(film_io::Bytes(80000, 1)), back(block.size());
  EXPECT_FALSE(codec.unpack(packed.data(), packed.size() - 1, &back)) << "cut short";
  film_io::Bytes longer(block.size() + 4), shorter(block.size() - 4);
  EXPECT_FALSE(codec.unpack(packed.data(), packed.size(), &longer));
  EXPECT_FALSE(codec.unpack(packed.data(), packed.size(), &shorter));
  packed.push_back(0);
  EXPECT_FALSE(codec.unpack(packed.data(), packed.size(), &back)) << "continues";
  packed.pop_back();
  packed[packed.size() / 2] ^= 0x55;
  EXPECT_FALSE(codec.unpack(packed.data(), packed.size(), &back)) << "its sum is another";
  EXPECT_FALSE(codec.unpack(packed.data(), 0, &back));
}

}  // namespace
}  // namespace gradus::block_codec_test
