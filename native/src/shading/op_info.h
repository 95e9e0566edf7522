// The kind, shape and modes of the operations of gradus_nodes.h.
#pragma once

#include <array>
#include <cstdint>

#include "gradus/gradus_nodes.h"

namespace gradus::shading {

// What evaluates an operation: add_closure(), evaluate_pure(), evaluate_context(), or the interpreter itself.
enum class OpKind : uint8_t { Closure, Pure, Context, Program };

struct OpInfo {
  const char* name = nullptr;  // null if the number stands for no operation
  OpKind kind = OpKind::Pure;
  uint8_t inputs = 0;
  uint8_t outputs = 0;
  uint32_t min_floats = 0;
  uint32_t last_mode = 0;
};

// The operations by their numbers, generated from schema/nodes.toml.
extern const std::array<OpInfo, GRADUS_OP_LIMIT> kOpTable;

// Returns the entry of an operation, or null if the operation is unknown.
inline const OpInfo* op_info(uint32_t op) {
  return op < GRADUS_OP_LIMIT && kOpTable[op].name ? &kOpTable[op] : nullptr;
}

// Closures have the numbers below this.
inline constexpr uint32_t kFirstValueOp = 32;
inline bool is_closure_op(uint32_t op) { return op < kFirstValueOp; }

// Returns whether the result of an operation depends on its inputs alone.
inline bool is_pure(uint32_t op) {
  const OpInfo* info = op_info(op);
  return info && info->kind == OpKind::Pure;
}

}  // namespace gradus::shading
