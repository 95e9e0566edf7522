// Cancellation of long computations.
#pragma once

#include <functional>

#include "base/error.h"

namespace gradus {

// Returns true when the computation has to stop without a result. Long computations call it at regular intervals.
using CancelCheck = std::function<bool()>;

// Throws Error CANCELLED if `cancel` returns true.
inline void throw_if_cancelled(const CancelCheck& cancel) {
  if (cancel()) throw cancelled();
}

}  // namespace gradus
