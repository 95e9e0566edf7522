// What of a frame store a job may take for its own. All errors name the file and the way out.
#pragma once

#include <string>

#include "animation/sequence_folder.h"
#include "base/error.h"
#include "film/film_header.h"

namespace gradus::animation {

inline constexpr const char* kAdvice = ": remove it, or choose another frame store";

// Throws invalid_argument that says what differs, where a half was sampled otherwise than these settings ask for, but
// for its samples.
void require_same(const film::FilmHeader& stored, FrameSamples kind, const std::string& path,
                  const GradusSettings& settings, uint64_t scene_key);
// Throws invalid_argument where it lacks what REGULARIZED reads.
void require_features(const film::FilmHeader& stored, const std::string& path);

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
