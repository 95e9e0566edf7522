// Records data passes, light passes and features while a path is traced. A pass that is not requested has no plane and
// costs a test of a pointer.
#pragma once

#include <array>

#include "path/catcher_recorder.h"
#include "path/channel_recorder.h"
#include "path/light.h"

namespace gradus::path {

// Share of each light pass (diffuse, glossy, transmission) in a contribution. The shares of a channel add up to 1.
using PassShare = std::array<Rgb, 3>;

class PassRecorder final : public SurfaceVisitor {
 public:
  // Finds the planes of the film, which must outlive the recorder.
  PassRecorder(const PathContext& context, film::Film* film, film::Counters* counters);
  // Returns whether the film has anything to record.
  bool active() const { return active_; }

  // Prepares for a sample. If `adds_components` is true, everything except light was recorded before.
  void begin_sample(size_t pixel, int half, uint32_t number, bool adds_components = false);
  // Prepares for a further camera ray of the sample, which has no path. It records light, and remembers its features.
  void begin_further_ray();
  // Returns whether the features of a camera ray are complete.
  bool has_features() const { return features_done_; }
  // Prepares for the path of the sample after all further rays. Features are the mean over these and the path's ray,
  // each with the given share, or those of the path's ray for a share of 1.
  void begin_path(float feature_share);
  // Returns whether surface() and visit() need the closures of the next vertex of a path.
  bool needs_closures(const PathState& state) const {
    return records_data(state) || !features_done_ || seeks_non_specular_;
  }
  // Records a vertex at which the path stops, before it scatters. The state's throughput has the weight of the segment.
  void surface(const PathState& state, const Vertex& vertex, const Segment& segment);
  // Records a surface that cuts a hole into the film. The state's throughput has the weight of the segment.
  void hole(const Sampler& sampler, const PathState& state, const Vertex& vertex, const Segment& segment);
  // Records a ray that leaves the scene.
  void escaped(const PathState& state);
  // Prepares for the next segment of a path. Returns what must see the surfaces on it, or null if nothing must.
  SurfaceVisitor* follow(const PathState& state);
  // Records a surface that the camera sees directly or through clear glass, whether the path stops there or passes it.
  // As in Cycles, data passes show the first surface that is opaque enough. Those of one sample are replaced by each
  // surface up to that one, so that they show a clearer surface where the path stops there. Mist and ambient occlusion
  // are sums over all surfaces.
  void visit(const Sampler& sampler, const Vertex& vertex, const shading::RayState& ray, const Rgb& weight) override;
  // Records an analytic light or the world on the last segment, at `distance` from its start. `light` is the radiance
  // before any weight.
  void record_light(const Rgb& throughput, int component, const Rgb& light, float distance) {
    if (!features_done_) add_albedo(throughput * light);
    record_emission(component, light, distance);
    if (seeks_non_specular_ && records_details_ && !is_black(light))
      record(uint32_t{1} << component, {.emission = light});
  }
  // Records radiance that a ray has found, before any weight, as a feature of its component. It stands for the albedo
  // of what a mirror or glass shows. `further` is its distance from the end of the path so far.
  void record_emission(int component, const Rgb& light, float further = 0.0f);
  // Returns whether film_background() records anything.
  bool records_film_background() const { return plane(GRADUS_PASS_ENVIRONMENT) != nullptr; }
  // Records the world where a transparent film hides it: its radiance, and what it would contribute.
  void film_background(const Rgb& throughput, const Rgb& light, const Rgb& value);
  // Record the contribution of an analytic light, a surface or the world after a number of scattering events, 0 if the
  // camera sees it, also through clear glass (PathContext::glass_limit).
  void emission(int scatterings, const light::LightPoint& point, const Rgb& value);
  void emission(int scatterings, const Vertex& vertex, const Rgb& value);
  void environment(int scatterings, const Rgb& value);
  // Records the contribution of next-event estimation in one class. `state` is that on arrival at the vertex.
  void light(const PathState& state, const Vertex& vertex, bsdf::ScatterClass c, const LightSample& light,
             const Rgb& value);
  // Records that the path scatters at a vertex with `depth` scattering events before it.
  void scattered(int depth, const Vertex& vertex, const ScatterEvent& event);

 private:
  film::Channel* plane(uint32_t pass) const { return planes_[pass]; }
  // Returns whether passes of data show what the path meets next: what shows the film's background, as in Cycles.
  bool records_data(const PathState& state) const {
    return state.shows_background() && !state.emission_only && !adds_components_ && !is_further_ray_;
  }
  void add(uint32_t pass, const Vec4& value);
  void add(uint32_t pass, const Vec3& value) { add(pass, Vec4(value, 0.0f)); }
  void add(uint32_t pass, float value) { add(pass, Vec4(value, 0.0f, 0.0f, 0.0f)); }
  void add_light(int scatterings, const Rgb& value, const PassShare& share, uint32_t direct_pass);
  void begin_camera_ray(bool is_further);
  void surface_data(const Vertex& vertex);
  void colors(const Rgb& weight, const Vertex& vertex);
  void ambient_occlusion(const Sampler& sampler, const Rgb& weight, const Vertex& vertex, uint32_t crossed);
  // Subtracts from mist, which is 1 without surfaces, what a surface hides of it.
  void mist(const Rgb& weight, const Vec3& position, float time);
  // Adds the motion vector of a point. project(moment, film) returns its film position, or false if it has none.
  template <class Project>
  void add_motion(const Project& project);
  void motion(const Vertex& vertex);
  void background_motion(const Vec3& direction);
  void features(const PathState& state, const Vertex& vertex);
  void add_albedo(const Rgb& value);
  void add_feature(uint32_t pass, const Vec3& value);
  uint32_t components_of_non_specular(const PathState& state, const Vertex& vertex) const;
  void non_specular_vertex(const PathState& state, const Vertex& vertex);
  void details(const PathState& state, const Vertex& vertex);
  void record(uint32_t components, const film::NonSpecularDetails& here);
  void record(uint32_t components, const film::NonSpecularVertices& here);

  const PathContext& context_;
  film::Counters* counters_;
  ChannelRecorder channels_;
  CatcherRecorder catchers_;
  std::array<film::Channel*, GRADUS_PASS_COUNT> planes_{};
  bool active_ = false;
  bool has_light_passes_ = false;
  bool has_features_ = false;
  bool has_surface_data_ = false;  // the film has planes of surface_data()
  bool visits_surfaces_ = false;
  // Components that record the first non-specular vertex, or details of it; null if there are none.
  std::vector<film::ComponentPlanes>* components_ = nullptr;
  bool records_non_specular_ = false;
  bool records_details_ = false;
  bool seeks_non_specular_ = false;  // the path has scattered in specular classes only
  // Components, as bits, that have details of the current segment, and those that have its vertex, with its
  // reflectance.
  uint32_t detail_components_ = 0;
  uint32_t vertex_components_ = 0;
  std::array<Rgb, lpe::kMaxComponents> recorded_reflectance_{};
  uint32_t number_ = 0;  // sample number
  bool first_sample_ = false;
  bool adds_components_ = false;
  bool is_further_ray_ = false;
  bool surface_data_done_ = false;
  bool features_done_ = false;
  float feature_share_ = 1.0f;
  std::array<Vec3, GRADUS_PASS_COUNT> further_features_{};  // sums over further rays, of feature passes alone
  float path_length_ = 0.0f;
  Rgb albedo_ = Rgb(0.0f);  // denoising albedo of this sample so far
  size_t pixel_ = 0;
  int half_ = 0;
  Rgb throughput_ = Rgb(1.0f);      // of the path up to the segment that visit() sees
  bool is_camera_segment_ = false;  // visit() sees the first segment
  PassShare share_{};               // shares of the light passes in all light behind the first vertex
};

}  // namespace gradus::path
