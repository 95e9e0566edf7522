#include "base/threads.h"

#include <algorithm>

#include <tbb/global_control.h>

namespace gradus {

int arena_size(uint32_t threads) {
  const size_t maximum = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return int(std::clamp<size_t>(threads, 1, std::max<size_t>(maximum, 1)));
}

}  // namespace gradus
