// What gradus_nodes.h says about each operation, as a table.
#pragma once

#include <array>
#include <cstdint>

#include "gradus/gradus_nodes.h"

namespace gradus::shading {

struct OpInfo {
  const char* name = nullptr;  // nullptr: there is no such operation
  uint8_t inputs = 0;
  uint8_t outputs = 0;
  bool closure = false;
};

namespace detail {
constexpr std::array<OpInfo, GRADUS_OP_LIMIT> make_op_table() {
  std::array<OpInfo, GRADUS_OP_LIMIT> table{};
#define GRADUS_OP_ROW(name, value, inputs, outputs, closure) table[value] = {#name, inputs, outputs, closure != 0};
  GRADUS_OPS(GRADUS_OP_ROW)
#undef GRADUS_OP_ROW
  return table;
}
inline constexpr std::array<OpInfo, GRADUS_OP_LIMIT> kOpTable = make_op_table();
}  // namespace detail

// nullptr for unknown operations.
constexpr const OpInfo* op_info(uint32_t op) {
  return op < GRADUS_OP_LIMIT && detail::kOpTable[op].name ? &detail::kOpTable[op] : nullptr;
}

}  // namespace gradus::shading
