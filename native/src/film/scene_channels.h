// The channels of a film that its scene asks for beside passes.
#pragma once

#include <string>
#include <vector>

#include "film/film.h"
#include "scene/scene_channels.h"

namespace gradus::film {

// Returns the name of the film's channel for a GradusChannelKind and the name of an AOV or a light group. Names of
// different channels differ, also as stored names, and no pass has one.
std::string channel_name(uint32_t kind, const std::string& name);
// Returns the descriptions of the film's channels.
std::vector<ChannelInfo> describe(const scene::SceneChannels& channels);
// Returns what the scene of a film has asked for: the kinds and names from which channel_name() made those of the film.
scene::SceneChannels scene_channels_of(const Film& film);
// Returns the descriptions of those channels of a film that belong to no pass.
std::vector<ChannelInfo> other_channels(const Film& film);

// Returns whether a channel is a light group.
inline bool is_light_group(const Channel& channel) {
  return channel.pass == GRADUS_PASS_COUNT && channel.info.type == ValueType::kRadiance;
}

// Returns how many numbers of a pixel a layer of such a channel has.
uint32_t values_of_layer(uint32_t kind);

}  // namespace gradus::film
