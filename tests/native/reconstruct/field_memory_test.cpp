#include "reconstruct/field_memory.h"

#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

#include "reconstruct/field.h"

namespace gradus::test::field_memory_test {
namespace {

using reconstruct::Field;

constexpr int kSize = 600;

bool is_zero(const Field& field) {
  const float* const first = field.row(-1) - 8;
  return std::all_of(first, field.row(kSize) + kSize + 8, [](float value) { return value == 0.0f; });
}

void fill(Field* field) { std::fill(field->row(-1) - 8, field->row(kSize) + kSize + 8, 7.0f); }

TEST(FieldMemory, IsKeptForTheNextFieldsWhileSomebodyWantsIt) {
  const size_t before = reconstruct::kept_field_bytes();
  {
    const reconstruct::KeptFieldMemory wanted, by_another;
    { const Field field(kSize, kSize, 1); }
    EXPECT_GE(reconstruct::kept_field_bytes(), before + sizeof(float) * kSize * kSize);
    const Field next(kSize, kSize, 1);
    EXPECT_EQ(reconstruct::kept_field_bytes(), before);
  }
  EXPECT_EQ(reconstruct::kept_field_bytes(), 0u);
  { const Field field(kSize, kSize, 1); }
  EXPECT_EQ(reconstruct::kept_field_bytes(), 0u);
}

// A field that takes kept memory must not show what another one wrote.
TEST(FieldMemory, OfANewFieldIsZero) {
  const reconstruct::KeptFieldMemory wanted;
  for (int round = 0; round < 3; ++round) {
    Field field(kSize, kSize, 1);
    EXPECT_TRUE(is_zero(field)) << round;
    fill(&field);
    EXPECT_FALSE(is_zero(field));
  }
}

TEST(FieldMemory, CopiesHaveTheValues) {
  const reconstruct::KeptFieldMemory wanted;
  Field field(kSize, kSize, 2);
  field.row(5, 1)[7] = 3.0f;
  const Field copy = field;
  field.row(5, 1)[7] = 4.0f;
  EXPECT_EQ(copy.row(5, 1)[7], 3.0f);
  const Field moved = std::move(field);
  EXPECT_EQ(moved.row(5, 1)[7], 4.0f);
}

}  // namespace
}  // namespace gradus::test::field_memory_test
