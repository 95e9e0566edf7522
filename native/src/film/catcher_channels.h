// Channels of a film whose scene has shadow catchers. They hold sums over the samples of a pixel.
#pragma once

#include <vector>

#include "film/channel.h"

namespace gradus::film {

// RGB of shadow catchers that the camera sees, in the light and the shadow of all objects, and the share of the film
// that they cover.
inline constexpr char kCatcherShaded[] = "Catcher Shaded";
// RGB of the same points where nothing but catchers casts shadows or reflects light, and the number of points.
inline constexpr char kCatcherAlone[] = "Catcher Alone";
// RGB of the background, also behind shadow catchers.
inline constexpr char kCatcherBackground[] = "Catcher Background";

inline void add_catcher_channels(std::vector<ChannelInfo>* channels) {
  channels->push_back({kCatcherShaded, 4});
  channels->push_back({kCatcherAlone, 4});
  channels->push_back({kCatcherBackground, 3});
}

}  // namespace gradus::film
