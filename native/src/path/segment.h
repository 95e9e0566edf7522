// One path segment: from a vertex to the next surface at which the path stops, through surfaces that let it pass.
//
// Whether a partly transparent surface stops a path is a random decision with a dimension for each surface of each
// segment. An offset path that traces its own rays makes the same draws. The shift is then the identity on these random
// numbers, and they do not appear in its Jacobian.
#pragma once

#include "path/context.h"
#include "path/sampler.h"
#include "path/vertex.h"

namespace gradus::path {

// An emitter that a ray crosses and that does not stop it: an analytic light, or an emissive triangle with blockers of
// its own.
struct LightCrossing {
  light::LightPoint point;
  float distance = 0.0f;
  // Values of the segment up to the light (see Segment).
  Rgb weight = Rgb(1.0f);
  float probability = 1.0f;
  int crossed = 0;
  bool is_hidden = false;  // see LightVisibility
  Vec3 eye = Vec3(0.0f);   // where the ray that crosses the light starts: at the segment's start, or behind a portal
  bool is_behind_portal = false;
};

// How much of an emitter is visible.
struct LightVisibility {
  Rgb transmittance = Rgb(0.0f);
  // An opaque surface without a shadow set of its own is in front of an emitter with blockers. It does not block light
  // sampling, but Cycles does not find the emitter behind it by bounces; see hidden_share().
  bool is_hidden = false;
};

enum class SegmentEnd : uint8_t {
  Surface,
  Escaped,
  Exhausted,  // nothing is seen, because there are too many transparent surfaces, or no ray
};

struct Segment {
  SegmentEnd end = SegmentEnd::Escaped;
  Rgb weight = Rgb(1.0f);    // transmittance divided by `probability`
  float probability = 1.0f;  // probability of the decisions at transparent surfaces
  int crossed = 0;           // number of transparent surfaces that the path has passed
  float length = 0.0f;
  // The path has passed a portal. Its end is not seen from its start, so that no light sample finds it, and shifts
  // cannot connect it.
  bool passes_portal = false;
  std::vector<LightCrossing> light_crossings;  // keeps its memory, since segments are reused
  std::vector<light::LightHit> hits;           // memory for lights on a part of the segment
};

// A ray, and what materials and visibility flags see of it.
struct PathRay {
  Ray ray;
  uint32_t visibility = GRADUS_VISIBLE_CAMERA;  // GradusVisibility bit of its kind
  shading::RayState state;
};

// Returns the first ray of a path.
inline PathRay camera_path_ray(const PathContext& context, const Ray& ray) {
  PathRay first;
  first.ray = ray;
  first.state.pixel_angle = context.pixel_angle;
  return first;
}

// Sees the surfaces on a segment.
class SurfaceVisitor {
 public:
  // `sampler` is that of the path, and `weight` that of the segment up to the surface; the closures of the vertex may
  // be missing.
  virtual void visit(const Sampler& sampler, const Vertex& vertex, const shading::RayState& ray, const Rgb& weight) = 0;

 protected:
  ~SurfaceVisitor() = default;
};

// When closures are evaluated: with the segment, or by shade_vertex() once the path is known to go on.
enum class Shading : uint8_t { Now, Later };

// Traces the ray of a path that has scattered `depth` times. `first` is its nearest hit, or null if it is not known.
// Sets `vertex` if the segment ends on a surface, and counts transparent surfaces in ray->state. `visitor` sees all
// surfaces on the segment, and may be null. Behind a portal, ray->ray is the ray that leaves it.
void trace_segment(const PathContext& context, const Sampler& sampler, int depth, const geometry::Hit* first,
                   PathRay* ray, Vertex* vertex, Segment* segment, Shading shading = Shading::Now,
                   SurfaceVisitor* visitor = nullptr);
// Returns the visibility, along a segment, of an emitter that the shadow sets `blockers` block. It does not depend on
// the number of transparent surfaces that the path has passed, so that all paths that share the segment agree.
LightVisibility linked_visibility(const PathContext& context, const Ray& ray, uint64_t blockers);
// Returns whether segments of bounces find the emission of a surface as a light crossing, because only some shadow sets
// block it.
bool is_crossed_emitter(const PathContext& context, const geometry::SurfacePoint& surface);
// Traces the last ray of a path in a scene with SceneFeatures::only_lights_emit. It finds the same lights and the same
// world as trace_segment(), usually without a search for surfaces. The end is Escaped or Exhausted. Returns whether a
// ray was traced.
bool trace_to_lights(const PathContext& context, const PathRay& ray, Segment* segment);
// Evaluates the closures of a vertex if they are missing. `ray` is the state of the ray that arrived.
void shade_vertex(const PathContext& context, const shading::RayState& ray, Vertex* vertex);

// Returns the ray that leaves a surface point in a direction, up to `distance`.
Ray spawn_ray(const geometry::SurfacePoint& from, const Vec3& direction, float distance = kInfinity);
// Returns the ray between two surface points, with both ends offset from their surfaces.
Ray spawn_ray_to(const geometry::SurfacePoint& from, const geometry::SurfacePoint& to);

// Returns the transmittance of a segment to a known end for a ray of the given kind, with decisions replaced by their
// expectation; black if it is blocked. `transparent_depth` is the number of transparent surfaces that the path has
// passed, and is increased by those on the segment.
Rgb segment_transmittance(const PathContext& context, const Ray& ray, const PathRay& kind, uint16_t* transparent_depth);

}  // namespace gradus::path
