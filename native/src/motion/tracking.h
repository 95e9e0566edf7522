// Tells whether the motion of a pixel was found: 1, or a negative cause why not. These are the values of the pass
// Path <Component> Tracked. Only a motion with the value 1 is reliable.
#pragma once

#include <cstdint>

namespace gradus::motion {

enum class Tracking : int8_t {
  Tracked = 1,
  NoPath = -1,        // the component shows nothing here
  Gone = -2,          // what the component shows is not in the other frame, or is another mesh there
  NotConverged = -3,  // no position on the film was found
  Occluded = -4,      // the position on the film is hidden by something else
  Broken = -5,        // no chain leads there: an edge, total reflection, another object
  Outside = -6,       // by chains: further away than the film is wide or high; by flow: not on the film
  Elsewhere = -7,     // there are several images of the target, and the one found does not continue this one
  ShotChange = -8,    // there is a shot change between the two frames
  // Causes of flow alone (motion/irradiance_motion.h):
  ComesBackElsewhere = -9,  // the flow back leads to another position: the pixel is hidden, or lacks texture
  Silhouette = -10,         // the pixel, or the one it moves to, shows an edge of an object
  NoFlowLibrary = -11,      // libgradus_flow.so is missing
  NoNeighbour = -12,        // the previous or the next frame is not rendered
};
inline constexpr int kTrackingCauses = 8;  // number of causes that tracking of chains reports

inline constexpr auto kTracked = float(Tracking::Tracked);
inline constexpr auto kOutsideFilm = float(Tracking::Outside);
inline constexpr auto kComesBackElsewhere = float(Tracking::ComesBackElsewhere);
inline constexpr auto kSilhouette = float(Tracking::Silhouette);
inline constexpr auto kNoFlowLibrary = float(Tracking::NoFlowLibrary);
inline constexpr auto kNoNeighbour = float(Tracking::NoNeighbour);

}  // namespace gradus::motion
