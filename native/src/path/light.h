// Light at a vertex: next-event estimation, and the weights of multiple importance sampling for emitters that a ray
// finds.
//
// With the balance heuristic a contribution f/(p_light + p_bsdf) is the same whichever technique found it. Gradients
// depend on that.
#pragma once

#include <array>

#include "path/scatter.h"

namespace gradus::path {

// Point on a light, chosen by next-event estimation, and its evaluation at the vertex.
struct LightSample {
  light::LightPoint point;
  light::LightEvaluation view;
};

// Light of a light sample that one class scatters.
struct LitClass {
  Rgb value = Rgb(0.0f);  // f·|cos|·radiance
  float pdf_bsdf = 0.0f;  // P(class)·p(direction | class); 0 for emitters that BSDF sampling cannot find
};

// Vertex and event at which a ray starts; both are null for the camera.
struct RaySource {
  const Vertex* vertex = nullptr;
  const ScatterEvent* event = nullptr;
  // Returns whether light sampling could have chosen the direction of the ray.
  bool sampled_light() const { return vertex != nullptr && !event->sample.dirac; }
};

// Samples a point on a light. Returns false if no light reaches the vertex.
bool sample_light(const PathContext& context, const VertexSample& u, const Vertex& vertex, int depth,
                  LightSample* light);
// Evaluates the scattering of a light sample towards wo within one class, without its shadow. Each kind of bounce sees
// what a ray of that kind would find, so that both techniques have the same integrand. `ray` is the state of the ray
// that arrived at the vertex.
LitClass light_class(const PathContext& context, const Vertex& vertex, bsdf::ScatterClass c, const LightSample& light,
                     const shading::RayState& ray);
// Returns light_class() split by the light passes of Blender.
std::array<Rgb, 3> light_by_pass(const PathContext& context, const Vertex& vertex, bsdf::ScatterClass c,
                                 const LightSample& light, const shading::RayState& ray);
// Returns the visibility of a light by its shadow ray. `crossed` is the number of transparent surfaces that the path
// has passed.
LightVisibility light_visibility(const PathContext& context, const geometry::SurfacePoint& from,
                                 const light::LightPoint& point, const light::LightEvaluation& view, uint32_t crossed);
// Returns the share of light that reaches the start of a shadow ray through transparent surfaces. A path passes at most
// as many of them as the settings allow, of which it has passed `crossed` before.
Rgb shadow_transmittance(const PathContext& context, const Ray& ray, uint32_t crossed);

// Returns the density with which light sampling at the ray's source chooses a point; 0 if it cannot.
float light_pdf(const PathContext& context, const RaySource& source, const light::LightPoint& point);
// Returns the weight of BSDF sampling, p_bsdf / (p_light + p_bsdf).
inline float bsdf_weight(float pdf_light, float pdf_bsdf) {
  return pdf_light > 0.0f ? pdf_bsdf / (pdf_light + pdf_bsdf) : 1.0f;
}

// Evaluates an emitter that a ray of the given state crosses, as seen from its source.
light::LightEvaluation evaluate_crossing(const PathContext& context, const light::LightPoint& point,
                                         const light::Receiver& receiver, const shading::RayState& ray);
// Returns whether a surface lights the vertex at which a ray starts, by its own emission.
bool lights_source(const PathContext& context, const geometry::SurfacePoint& surface, const Vertex& source);
// Returns the share of the light of a hidden emitter that a path gets: that which Cycles gets, where only light
// sampling finds it, with the weight of the power heuristic.
inline float hidden_share(float pdf_light, float pdf_bsdf) {
  const float ratio = pdf_bsdf / pdf_light;
  return pdf_light > 0.0f ? 1.0f / (1.0f + ratio * ratio) : 0.0f;
}
// Returns whether a ray that leaves the scene shows a transparent film's background in the place of the world.
inline bool meets_film_background(const PathContext& context, const shading::RayState& ray) {
  return context.settings.film_transparent != 0 && shows_background(ray);
}
// Return the radiance of an analytic light that a ray crosses, and of the world, towards this kind of ray. It is black
// if it is hidden from that kind.
Rgb light_hit_radiance(const light::LightEvaluation& view, const PathRay& ray, int depth);
Rgb world_radiance(const PathContext& context, const PathRay& ray, int depth);
// Returns the radiance of the world also where a transparent film hides it. The Environment pass shows it there, too.
Rgb film_background_radiance(const PathContext& context, const PathRay& ray, int depth);

}  // namespace gradus::path
