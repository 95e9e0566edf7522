// Checks whether stored samples fit a job. All errors name the file and how to resolve the conflict.
#pragma once

#include <string>

#include "animation/sequence_folder.h"
#include "base/error.h"
#include "film/film_header.h"

namespace gradus::animation {

inline constexpr const char* kAdvice = ": remove it, or choose another frame store";

// Throws invalid_argument, with the difference, if samples were taken with other settings, passes, region or scene than
// these. Their number may differ.
void require_same(const film::FilmHeader& stored, FrameSamples kind, const std::string& path,
                  const GradusSettings& settings, uint64_t scene_key);
// Throws invalid_argument if the frame lacks the features that the reconstruction REGULARIZED reads.
void require_features(const film::FilmHeader& stored, const std::string& path);

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
