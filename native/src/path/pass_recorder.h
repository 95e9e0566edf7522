// Data and light passes while sampling: what nobody asked for has no plane and costs a test of a pointer.
#pragma once

#include <array>

#include "path/light.h"

namespace gradus::path {

// Share of each light pass (diffuse, glossy, transmission) in a contribution; sums to one per channel.
using PassShare = std::array<Rgb, 3>;

class PassRecorder {
 public:
  // Finds the planes of the frame. The frame must outlive the recorder.
  PassRecorder(const PathContext& context, film::Film* film, film::Counters* counters);
  bool active() const { return active_; }

  // again: all but the light was recorded before.
  void begin_sample(size_t pixel, int half, uint32_t number, bool adds_components = false);
  // surface() will look at the closures of the vertex with `depth` scatterings before it.
  bool needs_closures(int depth) const {
    return (depth == 0 && !adds_components_) || !features_done_ || seeks_non_specular_;
  }
  // A vertex at which the path stops, before it scatters. throughput: the segment's weight included.
  void surface(const Sampler& sampler, const PathState& state, const Vertex& vertex, const Segment& segment);
  // The ray left the scene.
  void escaped(const PathState& state);
  // The film sees nothing there: all is mist, as in Cycles.
  void no_ray() {
    if (!adds_components_) add(GRADUS_PASS_MIST, 1.0f);
  }
  // A light or the world on the path's last segment, at a distance from where that begins, with the whole of the light
  // that comes from there.
  void record_light(const Rgb& throughput, int component, const Rgb& light, float distance) {
    if (!features_done_) add_albedo(throughput * light);
    record_emission(component, light, distance);
    if (seeks_non_specular_ && records_details_ && !is_black(light))
      record(uint32_t{1} << component, {.emission = light});
  }
  // Light that a ray found, before any weight. Seen in a mirror or behind glass it is a feature of its component, as
  // the albedo is. further: than the path is long.
  void record_emission(int component, const Rgb& light, float further = 0.0f);
  // Light that was scattered `scatterings` times; 0: seen by the camera.
  void emission(int scatterings, const Rgb& value) { add_light(scatterings, value, share_, GRADUS_PASS_EMISSION); }
  void environment(int scatterings, const Rgb& value) {
    add_light(scatterings, value, share_, GRADUS_PASS_ENVIRONMENT);
  }
  // Light that next-event estimation at a vertex, where the path arrived with `state`, found in one class.
  void light(const PathState& state, const Vertex& vertex, bsdf::ScatterClass c, const LightSample& light,
             const Rgb& value);
  // The path scatters at a vertex with `depth` scatterings before it.
  void scattered(int depth, const Vertex& vertex, const ScatterEvent& event);

 private:
  film::Channel* plane(uint32_t pass) const { return planes_[pass]; }
  void add(uint32_t pass, const Vec4& value);
  void add(uint32_t pass, const Vec3& value) { add(pass, Vec4(value, 0.0f)); }
  void add(uint32_t pass, float value) { add(pass, Vec4(value, 0.0f, 0.0f, 0.0f)); }
  void add_light(int scatterings, const Rgb& value, const PassShare& share, uint32_t direct_pass);
  void camera_surface(const Sampler& sampler, const Rgb& weight, const Vertex& vertex);
  void colors(const Rgb& weight, const Vertex& vertex);
  void ambient_occlusion(const Sampler& sampler, const Rgb& weight, const Vertex& vertex);
  void mist(const Rgb& weight, const Vec3& position, float time);
  // project(moment, film): false where it is not on the film.
  template <class Project>
  void add_motion(const Project& project);
  void motion(const Vertex& vertex);
  void background_motion(const Vec3& direction);
  void features(const PathState& state, const Vertex& vertex);
  void add_albedo(const Rgb& value);
  uint32_t components_of_non_specular(const PathState& state, const Vertex& vertex) const;
  void non_specular_vertex(const PathState& state, const Vertex& vertex);
  void details(const PathState& state, const Vertex& vertex);
  void record(uint32_t components, const film::NonSpecularDetails& here);
  void record(uint32_t components, const film::NonSpecularVertices& here);

  const PathContext& context_;
  film::Counters* counters_;
  std::array<film::Channel*, GRADUS_PASS_COUNT> planes_{};
  bool active_ = false;
  bool lights_ = false;
  bool features_ = false;
  bool others_ = false;                                       // planes that are no features
  std::vector<film::ComponentPlanes>* components_ = nullptr;  // that keep rough vertices, or details of them
  bool records_non_specular_ = false;
  bool records_details_ = false;
  bool seeks_non_specular_ = false;  // the path has met none so far
  uint32_t detail_components_ = 0;   // bits of components that know details of this segment
  uint32_t vertex_components_ = 0;   // … its vertex, and of what reflectance
  std::array<Rgb, lpe::kMaxComponents> recorded_reflectance_{};
  uint32_t number_ = 0;  // of the sample
  bool first_sample_ = false;
  bool adds_components_ = false;
  bool features_done_ = false;
  float path_length_ = 0.0f;
  Rgb albedo_ = Rgb(0.0f);  // feature of this sample, so far
  size_t pixel_ = 0;
  int half_ = 0;
  PassShare share_{};
};

}  // namespace gradus::path
