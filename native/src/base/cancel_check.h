// What long work asks now and then: whether to end without a result.
#pragma once

#include <functional>

namespace gradus {

using CancelCheck = std::function<bool()>;

}  // namespace gradus
