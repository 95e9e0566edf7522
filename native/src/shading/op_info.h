// The kind, shape and modes of the operations of gradus_nodes.h.
#pragma once

#include <array>
#include <cstdint>

#include "gradus/gradus_nodes.h"

namespace gradus::shading {

// What evaluates an operation: add_closure(), evaluate_pure(), evaluate_context(), or the interpreter itself.
enum class OpKind : uint8_t { Closure, Pure, Context, Program };

// A set of modes of an operation, one bit each. Of the modes from 64 on it has either all or none.
using ModeSet = uint64_t;
inline constexpr ModeSet kAllModes = ~ModeSet{0};

inline bool has_mode(ModeSet set, uint32_t mode) { return mode < 64 ? (set >> mode & 1) != 0 : set == kAllModes; }

struct OpInfo {
  const char* name = nullptr;  // null if the number stands for no operation
  OpKind kind = OpKind::Pure;
  uint8_t inputs = 0;
  uint8_t outputs = 0;
  uint32_t min_floats = 0;
  uint32_t last_mode = 0;
  ModeSet ray_modes = 0;      // `reads_ray` of schema/nodes.toml
  ModeSet history_modes = 0;  // `reads_history`
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

// Returns whether the operation draws random numbers, so that its value differs from path to path.
inline bool draws_random(uint32_t op) { return op == GRADUS_OP_AMBIENT_OCCLUSION || op == GRADUS_OP_BEVEL; }

// Returns whether a result of the operation depends on the shading normal, beside its inputs.
inline bool reads_normal(uint32_t op, uint32_t mode) {
  switch (op) {
    case GRADUS_OP_EMISSION:
    case GRADUS_OP_TRANSPARENT:
    case GRADUS_OP_HOLDOUT:
    case GRADUS_OP_AOV:
      return false;
    case GRADUS_OP_GEOMETRY:
      return mode == GRADUS_GEOMETRY_NORMAL || mode == GRADUS_GEOMETRY_TANGENT;
    case GRADUS_OP_TEX_COORD:
      return mode == GRADUS_TEX_COORD_NORMAL || mode == GRADUS_TEX_COORD_REFLECTION;
    case GRADUS_OP_IMAGE:
      return (mode & 3) == GRADUS_PROJECTION_BOX;
    case GRADUS_OP_VECTOR_DISPLACEMENT:
      return mode == GRADUS_NORMAL_TANGENT;
    case GRADUS_OP_TANGENT:
    case GRADUS_OP_LAYER_WEIGHT:
    case GRADUS_OP_FRESNEL:
    case GRADUS_OP_NORMAL_MAP:
    case GRADUS_OP_BUMP:
    case GRADUS_OP_AMBIENT_OCCLUSION:
    case GRADUS_OP_BEVEL:
    case GRADUS_OP_DISPLACEMENT:
      return true;
    default:
      return is_closure_op(op);
  }
}

// Returns whether a value of the operation depends on the ray that arrives, and not on the point alone. That normals
// face the ray does not count.
inline bool reads_ray(uint32_t op, uint32_t mode) {
  const OpInfo* info = op_info(op);
  return info && has_mode(info->ray_modes, mode);
}

// Returns whether a value of the operation can differ between light sampling and BSDF sampling, because it depends on
// the ray's depths, or on its kind other than camera and shadow.
inline bool reads_history(uint32_t op, uint32_t mode) {
  const OpInfo* info = op_info(op);
  return info && has_mode(info->history_modes, mode);
}

}  // namespace gradus::shading
