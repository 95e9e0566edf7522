#include "channel_layers.h"

#include <array>
#include <string>

#include "api/objects.h"
#include "film/scene_channels.h"

namespace gradus::tool {
namespace {

std::string layer_name(const scene::SceneChannel& channel, uint32_t layer) {
  constexpr std::array<const char*, 3> kCryptomattes = {"CryptoObject", "CryptoMaterial", "CryptoAsset"};
  if (channel.kind == GRADUS_CHANNEL_LIGHT_GROUP) return "Combined_" + channel.name;
  if (!scene::is_cryptomatte(channel.kind)) return channel.name;
  return std::string(kCryptomattes[channel.kind - GRADUS_CHANNEL_CRYPTOMATTE_OBJECT]) + "0" + std::to_string(layer);
}

const char* letters_of(uint32_t kind) {
  if (kind == GRADUS_CHANNEL_AOV_VALUE) return "X";
  if (kind == GRADUS_CHANNEL_LIGHT_GROUP) return "RGB";
  return scene::is_cryptomatte(kind) ? "rgba" : "RGBA";
}

}  // namespace

void add_channel_layers(const client::Film& film, std::vector<film_io::ImageLayer>* layers) {
  const auto content = api::find_handle<api::FilmObject>(film.id())->get();
  for (const scene::SceneChannel& channel : film::scene_channels_of(*content)) {
    const uint32_t count = scene::is_cryptomatte(channel.kind) ? channel.levels / 2 : 1,
                   values = film::values_of_layer(channel.kind);
    for (uint32_t layer = 0; layer < count; ++layer) {
      layers->push_back({layer_name(channel, layer), letters_of(channel.kind),
                         film.read_channel(channel.kind, channel.name, layer, values)});
    }
  }
}

}  // namespace gradus::tool
