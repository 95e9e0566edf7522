// Where the samples of a sequence's frames come from.
#pragma once

#include <functional>
#include <memory>

#include "base/cancel_check.h"
#include "film/film.h"

namespace gradus::animation {

// A part of a frame, by its place: its own half, or the one that replays the frame before. Throws the Error CANCELLED.
using LoadSamples = std::function<std::shared_ptr<film::Film>(int place, const CancelCheck& cancel)>;

}  // namespace gradus::animation
