// Identifiers of Cryptomattes. The expected hashes are those of the reference implementation of MurmurHash3.
#include "base/cryptomatte_id.h"

#include <bit>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace gradus::cryptomatte_id_test {
namespace {

TEST(CryptomatteId, HashesAreThoseOfTheReference) {
  EXPECT_EQ(cryptomatte_hash(""), 0u);
  EXPECT_EQ(cryptomatte_hash("hello"), 0x248bfa47u);
  EXPECT_EQ(cryptomatte_hash("hello, world"), 0x149bbb7fu);
  EXPECT_EQ(cryptomatte_hash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
  EXPECT_EQ(cryptomatte_hash("Cube"), 0xa8fce865u);
  EXPECT_EQ(cryptomatte_hash("ViewLayer.CryptoObject") >> 4, 0x542cafau);
}

TEST(CryptomatteId, IdentifiersAreNormalNumbers) {
  for (int i = 0; i < 100000; ++i) {
    const std::string name = "Object." + std::to_string(i);
    const float id = cryptomatte_id(name);
    ASSERT_TRUE(std::isnormal(id)) << name;
    ASSERT_EQ(std::bit_cast<uint32_t>(id) & 0x807fffffu, cryptomatte_hash(name) & 0x807fffffu) << name;
  }
}

}  // namespace
}  // namespace gradus::cryptomatte_id_test
