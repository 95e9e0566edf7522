// Whether a pixel's motion was found: 1, or why not. What is not 1 is no motion to go by.
#pragma once

namespace gradus {

inline constexpr float kTracked = 1.0f;
inline constexpr float kOutsideFilm = -6.0f;         // where it goes is not on the film
inline constexpr float kComesBackElsewhere = -9.0f;  // the flow there leads back to another place: hidden, or nothing to hold on to
inline constexpr float kSilhouette = -10.0f;         // the pixel, or where it goes, shows an edge of an object
inline constexpr float kNoFlowLibrary = -11.0f;      // libgradus_flow.so is missing

}  // namespace gradus
