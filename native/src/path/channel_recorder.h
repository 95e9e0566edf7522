// Records the channels that a scene asks for beside passes while a path is traced: AOVs, Cryptomattes and light groups.
#pragma once

#include <vector>

#include "film/film.h"
#include "path/segment.h"

namespace gradus::path {

// Returns whether passes of data show a surface that a ray of the given state meets. As in Cycles, they do not show
// what is held out altogether, nor the surface at which a path ends because it has passed too many transparent ones.
bool shows_data(const PathContext& context, const Vertex& vertex, const shading::RayState& ray);

class ChannelRecorder {
 public:
  // Finds the channels in the film, which must outlive the recorder.
  ChannelRecorder(const PathContext& context, film::Film* film, film::Counters* counters);
  // Returns whether the film has any of these channels.
  bool active() const { return !channels_.empty(); }
  // Returns whether surfaces on camera segments must be shown to visit().
  bool visits_surfaces() const { return visits_surfaces_; }

  void begin_sample(size_t pixel, int half);
  // Returns whether light() must be called.
  bool has_groups() const { return has_groups_; }
  // Records light of a group; see light::light_group_of().
  void light(uint32_t group, const Rgb& value) {
    if (is_of_kind(group - 1, GRADUS_CHANNEL_LIGHT_GROUP)) add(group - 1, Vec4(value, 0.0f));
  }
  // Records a surface that the camera sees, whether the path stops there or passes it. As in Cycles, AOVs are those of
  // the first surface that is opaque enough, and of all before it. `weight` is that of the path up to the surface.
  void visit(const Vertex& vertex, const shading::RayState& ray, const Rgb& weight);
  // Records a camera ray that leaves the scene.
  void escaped(const PathRay& ray);

 private:
  // Returns whether there is a channel with this index, which the caller of the library has chosen, of this kind.
  bool is_of_kind(uint32_t channel, uint32_t kind) const {
    return channel < channels_.size() && context_.scene.channels[channel].kind == kind;
  }
  void add(uint32_t channel, const Vec4& value);
  void add(const std::vector<shading::AovOutput>& outputs);
  void add_identifiers(const Vertex& vertex, float weight);

  const PathContext& context_;
  film::Counters* counters_;
  std::vector<film::Channel*> channels_;  // in the order of Snapshot::channels; empty if the film has none
  bool visits_surfaces_ = false;
  bool has_identifiers_ = false;
  bool has_groups_ = false;
  bool aovs_done_ = false;
  size_t pixel_ = 0;
  int half_ = 0;
};

}  // namespace gradus::path
