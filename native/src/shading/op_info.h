// A table of the operations of gradus_nodes.h.
#pragma once

#include <array>
#include <cstdint>

#include "gradus/gradus_nodes.h"

namespace gradus::shading {

// Name and shape of an operation.
struct OpInfo {
  const char* name = nullptr;  // null if the number stands for no operation
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

// Returns the entry of an operation, or null if the operation is unknown.
constexpr const OpInfo* op_info(uint32_t op) {
  return op < GRADUS_OP_LIMIT && detail::kOpTable[op].name ? &detail::kOpTable[op] : nullptr;
}

}  // namespace gradus::shading
