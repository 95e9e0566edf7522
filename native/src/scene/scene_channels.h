// Channels that a scene asks for beside passes: AOVs, light groups and Cryptomattes.
#pragma once

#include <string>
#include <vector>

#include "base/hash.h"
#include "gradus/gradus.h"

namespace gradus::scene {

struct SceneChannel {
  uint32_t kind = GRADUS_CHANNEL_AOV_COLOR;  // GradusChannelKind
  std::string name;
  uint32_t levels = 0;
};
using SceneChannels = std::vector<SceneChannel>;

inline bool is_cryptomatte(uint32_t kind) { return kind >= GRADUS_CHANNEL_CRYPTOMATTE_OBJECT; }
// Returns whether surfaces that the camera sees fill the channel.
inline bool is_of_surfaces(uint32_t kind) { return kind != GRADUS_CHANNEL_LIGHT_GROUP; }
bool has_cryptomatte(const SceneChannels& channels);

// Checks and copies the caller's channels. Throws Error INVALID_ARGUMENT.
SceneChannels copy_channels(const GradusChannel* channels, size_t count);
void hash_channels(const SceneChannels& channels, ContentHash* hash);

}  // namespace gradus::scene
