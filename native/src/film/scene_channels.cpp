#include "film/scene_channels.h"

#include <array>
#include <cstdlib>

#include "base/error.h"

namespace gradus::film {
namespace {

struct Kind {
  const char* name;
  uint32_t layer_values;
};

constexpr std::array<Kind, 6> kKinds = {{{"AOV", 4},
                                         {"Value AOV", 1},
                                         {"Group", 3},
                                         {"Cryptomatte Object", 4},
                                         {"Cryptomatte Material", 4},
                                         {"Cryptomatte Asset", 4}}};
static_assert(GRADUS_CHANNEL_AOV_COLOR == 0 && GRADUS_CHANNEL_CRYPTOMATTE_ASSET + 1 == kKinds.size());

const Kind& kind_of(uint32_t kind) {
  if (kind >= kKinds.size()) throw invalid_argument("there is no kind " + std::to_string(kind) + " of channels");
  return kKinds[kind];
}

// Returns a name without the characters that stored films reserve or change: all but letters, digits and '-' become
// '%' and two hexadecimal digits.
std::string escaped(const std::string& name) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-') {
      text += c;
    } else {
      text += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return text;
}

std::string unescaped(const std::string& text) {
  std::string name;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size()) {
      name += static_cast<char>(std::strtol(text.substr(i + 1, 2).c_str(), nullptr, 16));
      i += 2;
    } else {
      name += text[i];
    }
  }
  return name;
}

// A Cryptomatte's layers have two names each, so that an odd number of levels keeps one more.
ChannelInfo describe(const scene::SceneChannel& channel) {
  ChannelInfo info{channel_name(channel.kind, channel.name), kind_of(channel.kind).layer_values};
  if (channel.kind == GRADUS_CHANNEL_LIGHT_GROUP) {
    info.type = ValueType::kRadiance;
    info.in_halves = true;
  } else if (scene::is_cryptomatte(channel.kind)) {
    info.type = ValueType::kIdAndWeight;
    info.values_per_pixel *= (channel.levels + 1) / 2;
  }
  return info;
}

}  // namespace

std::string channel_name(uint32_t kind, const std::string& name) {
  const std::string prefix = kind_of(kind).name;
  return name.empty() ? prefix : prefix + " " + escaped(name);
}

std::vector<ChannelInfo> describe(const scene::SceneChannels& channels) {
  std::vector<ChannelInfo> infos;
  for (const scene::SceneChannel& channel : channels) infos.push_back(describe(channel));
  return infos;
}

scene::SceneChannels scene_channels_of(const Film& film) {
  scene::SceneChannels channels;
  for (const ChannelInfo& info : other_channels(film)) {
    for (uint32_t kind = 0; kind < kKinds.size(); ++kind) {
      const std::string prefix = kKinds[kind].name;
      if (scene::is_cryptomatte(kind) && info.name == prefix) {
        channels.push_back({kind, "", info.values_per_pixel / 2});
      } else if (info.name.starts_with(prefix + " ")) {
        channels.push_back({kind, unescaped(info.name.substr(prefix.size() + 1)), 0});
      }
    }
  }
  return channels;
}

std::vector<ChannelInfo> other_channels(const Film& film) {
  std::vector<ChannelInfo> infos;
  for (const Channel& channel : film.channels) {
    if (channel.pass == GRADUS_PASS_COUNT) infos.push_back(channel.info);
  }
  return infos;
}

uint32_t values_of_layer(uint32_t kind) { return kind_of(kind).layer_values; }

}  // namespace gradus::film
