#include "scene/scene_channels.h"

#include <algorithm>

#include "base/error.h"

namespace gradus::scene {
namespace {

constexpr size_t kMaxChannels = 200;  // a film has at most 255, passes included
constexpr size_t kMaxName = 63;       // bytes, as in Blender
constexpr uint32_t kMaxLevels = 16;

void check(const SceneChannel& channel) {
  const std::string name = "channel '" + channel.name + "'";
  if (channel.kind > GRADUS_CHANNEL_CRYPTOMATTE_ASSET) throw invalid_argument(name + " is of an unknown kind");
  if (is_cryptomatte(channel.kind)) {
    if (channel.levels < 1 || channel.levels > kMaxLevels)
      throw invalid_argument("a Cryptomatte has " + std::to_string(channel.levels) + " levels, not 1 to 16");
    if (!channel.name.empty()) throw invalid_argument(name + " is a Cryptomatte, which has no name");
  } else if (channel.name.empty() || channel.name.size() > kMaxName) {
    throw invalid_argument(name + ": its name is empty or longer than 63 bytes");
  }
}

}  // namespace

bool has_cryptomatte(const SceneChannels& channels) {
  return std::ranges::any_of(channels, [](const SceneChannel& channel) { return is_cryptomatte(channel.kind); });
}

SceneChannels copy_channels(const GradusChannel* channels, size_t count) {
  if (count > kMaxChannels) throw invalid_argument("there are more than 200 AOVs and light groups");
  if (count > 0 && channels == nullptr) throw invalid_argument("channels are missing");
  SceneChannels copies;
  for (size_t i = 0; i < count; ++i) {
    SceneChannel copy{channels[i].kind, channels[i].name != nullptr ? channels[i].name : "", channels[i].levels};
    check(copy);
    const auto is_same = [&](const SceneChannel& other) { return other.kind == copy.kind && other.name == copy.name; };
    if (std::ranges::any_of(copies, is_same)) throw invalid_argument("there are two channels '" + copy.name + "'");
    copies.push_back(std::move(copy));
  }
  return copies;
}

void hash_channels(const SceneChannels& channels, ContentHash* hash) {
  for (const SceneChannel& channel : channels) {
    hash->value(channel.kind);
    hash->value(channel.name);
    hash->value(channel.levels);
  }
}

}  // namespace gradus::scene
