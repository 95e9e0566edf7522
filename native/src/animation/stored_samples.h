// Tells whether stored samples fit a job.
#pragma once

#include <string>

#include "animation/sequence_folder.h"
#include "base/error.h"
#include "film/film_header.h"

namespace gradus::animation {

inline constexpr const char* kAdvice = ": remove it, or choose another frame store";

// Returns how stored samples differ from those of a job in settings, passes, region or scene, such as "another scene",
// or "" if they fit. Their number may differ.
std::string difference(const film::FilmHeader& stored, FrameSamples kind, const GradusSettings& settings,
                       uint64_t scene_key);

// Returns read(). Appends kAdvice to the text of any Error that it throws, except CANCELLED.
template <class Read>
auto read_with_advice(const Read& read) {
  try {
    return read();
  } catch (const Error& e) {
    if (e.code() == GRADUS_ERROR_CANCELLED) throw;
    throw Error(e.code(), e.what() + std::string(kAdvice));
  }
}

}  // namespace gradus::animation
