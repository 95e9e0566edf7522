#include "path/channel_recorder.h"

#include "film/finite_check.h"
#include "film/scene_channels.h"
#include "shading/material.h"

namespace gradus::path {

bool shows_data(const PathContext& context, const Vertex& vertex, const shading::RayState& ray) {
  const geometry::InstanceData& instance = context.scene.instances[vertex.point.hit.instance];
  const bool is_opaque_holdout = (instance.visibility & GRADUS_HOLDOUT) != 0 && !(vertex.shade.passed() > 0.0f);
  return !is_opaque_holdout && vertex.shade.holdout != Rgb(1.0f) && !is_at_transparent_limit(context, ray);
}

ChannelRecorder::ChannelRecorder(const PathContext& context, film::Film* film, film::Counters* counters)
    : context_(context), counters_(counters) {
  for (const scene::SceneChannel& channel : context.scene.channels) {
    film::Channel* const found = film->channels.find(film::channel_name(channel.kind, channel.name));
    if (found == nullptr) break;  // The film is that of a pilot, which has none of these channels.
    channels_.push_back(found);
    visits_surfaces_ |= scene::is_of_surfaces(channel.kind);
    has_identifiers_ |= scene::is_cryptomatte(channel.kind);
    has_groups_ |= channel.kind == GRADUS_CHANNEL_LIGHT_GROUP;
  }
}

void ChannelRecorder::begin_sample(size_t pixel, int half) {
  pixel_ = pixel;
  half_ = half;
  aovs_done_ = false;
}

void ChannelRecorder::add(uint32_t channel, const Vec4& value) {
  film::add_feature(&value.x, 1.0f, pixel_, half_, channels_[channel], counters_);
}

void ChannelRecorder::add(const std::vector<shading::AovOutput>& outputs) {
  for (const shading::AovOutput& output : outputs) {
    if (is_of_kind(output.channel, GRADUS_CHANNEL_AOV_COLOR)) add(output.channel, Vec4(output.color, 1.0f));
    if (is_of_kind(output.channel, GRADUS_CHANNEL_AOV_VALUE)) add(output.channel, Vec4(output.value, 0.0f, 0.0f, 0.0f));
  }
}

void ChannelRecorder::visit(const Vertex& vertex, const shading::RayState& ray, const Rgb& weight) {
  if (!visits_surfaces_) return;
  if (!aovs_done_) {
    add(shading::shade_aovs(context_.scene, vertex.point, vertex.wo, ray));
    aovs_done_ = 1.0f - vertex.shade.passed() >= context_.settings.alpha_threshold;
  }
  if (has_identifiers_ && shows_data(context_, vertex, ray))
    add_identifiers(vertex, mean_component(weight) * (1.0f - vertex.shade.passed()));
}

void ChannelRecorder::add_identifiers(const Vertex& vertex, float weight) {
  const geometry::InstanceData& instance = context_.scene.instances[vertex.point.hit.instance];
  for (size_t i = 0; i < channels_.size(); ++i) {
    const uint32_t kind = context_.scene.channels[i].kind;
    if (!scene::is_cryptomatte(kind)) continue;
    const float id = kind == GRADUS_CHANNEL_CRYPTOMATTE_OBJECT ? instance.cryptomatte_object
                     : kind == GRADUS_CHANNEL_CRYPTOMATTE_MATERIAL
                         ? context_.scene.materials[vertex.point.material]->cryptomatte
                         : instance.cryptomatte_asset;
    const uint32_t values = channels_[i]->info.values_per_pixel;
    film::add_pair(id, weight, values / 2, channels_[i]->values[0].data() + pixel_ * values, counters_);
  }
}

void ChannelRecorder::escaped(const PathRay& ray) {
  if (visits_surfaces_ && !aovs_done_) add(shading::shade_world_aovs(context_.scene, ray.ray.direction, ray.state));
}

}  // namespace gradus::path
