// One path segment: from a vertex to the next surface at which the path stops, through surfaces that let it pass.
//
// Whether a partly transparent surface stops a path is a random decision keyed by (segment, surface along it). A
// shifted path that traces its own rays makes the same draws, so that these random numbers are mapped by the identity:
// they leave no trace in Jacobians.
#pragma once

#include "path/context.h"
#include "path/sampler.h"
#include "path/vertex.h"

namespace gradus::path {

// A light that a ray crosses: lights do not stop rays.
struct LightCrossing {
  light::LightPoint point;
  float distance = 0.0f;
  Rgb weight = Rgb(1.0f);    // of the segment up to there, see Segment
  float probability = 1.0f;  // likewise
  int crossed = 0;           // likewise
};

enum class SegmentEnd : uint8_t {
  Surface,
  Escaped,
  Exhausted,  // nothing is seen: more transparent surfaces than allowed, or no ray
};

struct Segment {
  SegmentEnd end = SegmentEnd::Escaped;
  Rgb weight = Rgb(1.0f);    // transmittance over the probability of the decisions taken
  float probability = 1.0f;  // of these decisions
  int crossed = 0;           // surfaces that were passed
  float length = 0.0f;
  std::vector<LightCrossing> light_crossings;  // segments are reused: allocates for the most that any had
  std::vector<light::LightHit> met;            // scratch: lights on a part of the segment
};

// A ray and what it looks like to the scene.
struct PathRay {
  Ray ray;
  uint32_t visibility = GRADUS_VISIBLE_CAMERA;  // GradusVisibility bit of its kind
  shading::RayState state;
};

// Closures where a segment ends: worked out at once, or left to shade_vertex() until the path is known to go on.
enum class Shading : uint8_t { Now, Later };

// number: of scatterings so far; keys the decisions. first: the nearest hit if it is known. Fills `vertex` where the
// segment ends on a surface, and counts transparent surfaces in ray->state.
void trace_segment(const PathContext& context, const Sampler& sampler, int number, const geometry::Hit* first,
                   PathRay* ray, Vertex* vertex, Segment* segment, Shading shading = Shading::Now);
// The last ray of a path where SceneFeatures::only_lights_emit: the same sightings and the same world as
// trace_segment() finds, mostly without asking for surfaces. Ends Escaped or Exhausted. True: a ray was traced.
bool trace_to_lights(const PathContext& context, const PathRay& ray, Segment* segment);
// Closures, where they are still missing. ray: that arrived.
void shade_vertex(const PathContext& context, const shading::RayState& ray, Vertex* vertex);

// The ray from a vertex towards a direction, up to `distance`.
Ray spawn_ray(const geometry::SurfacePoint& from, const Vec3& direction, float distance = kInfinity);
// The ray between two surface points: both ends off their surfaces.
Ray spawn_ray_to(const geometry::SurfacePoint& from, const geometry::SurfacePoint& to);

// Transmittance of a segment to a known end for a ray of this kind, decisions replaced by their expectation; 0 if
// blocked. transparent_depth: surfaces that the path passed before, and after the call those on the segment, too.
Rgb segment_transmittance(const PathContext& context, const Ray& ray, const PathRay& kind, uint16_t* transparent_depth);

}  // namespace gradus::path
