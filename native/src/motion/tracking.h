// Whether a pixel's motion was found: 1, or why not. Values of the pass Path <Component> Tracked (contract 6.6). What
// is not 1 is no motion to go by.
#pragma once

#include <cstdint>

namespace gradus::motion {

enum class Tracking : int8_t {
  Tracked = 1,
  NoPath = -1,        // the component shows nothing here
  Gone = -2,          // what it shows is not in the other frame, or is another mesh there
  NotConverged = -3,  // no place on the film was found
  Occluded = -4,      // something stands before it
  Broken = -5,        // no way leads there any more: an edge, total reflection, another object
  Outside = -6,       // followed: further away than the film is wide or high; by flow: not on the film
  Elsewhere = -7,     // it is seen at several places, and what was found is not what this image of it becomes
  ShotChange = -8,    // the two frames are not one shot
  // Of flow alone (motion/irradiance_motion.h):
  ComesBackElsewhere = -9,  // the flow there leads back to another place: hidden, or nothing to hold on to
  Silhouette = -10,         // the pixel, or where it goes, shows an edge of an object
  NoFlowLibrary = -11,      // libgradus_flow.so is missing
  NoNeighbour = -12,        // the frame before, or the one after, is not rendered
};
inline constexpr int kTrackingCauses = 8;  // of chains that are followed

inline constexpr auto kTracked = float(Tracking::Tracked);
inline constexpr auto kOutsideFilm = float(Tracking::Outside);
inline constexpr auto kComesBackElsewhere = float(Tracking::ComesBackElsewhere);
inline constexpr auto kSilhouette = float(Tracking::Silhouette);
inline constexpr auto kNoFlowLibrary = float(Tracking::NoFlowLibrary);
inline constexpr auto kNoNeighbour = float(Tracking::NoNeighbour);

}  // namespace gradus::motion
