// How work ends that is asked to end.
#pragma once

#include "base/cancel_check.h"
#include "base/error.h"

namespace gradus {

// Throws the Error CANCELLED where it is to end.
inline void throw_if_cancelled(const CancelCheck& cancel) {
  if (cancel()) throw cancelled();
}

}  // namespace gradus
