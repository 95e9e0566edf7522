// Light at a vertex: next-event estimation, and the weights of emitters that a ray finds (multiple importance sampling,
// balance heuristic).
//
// With the balance heuristic a contribution f/(p_light + p_bsdf) is the same whichever technique found it; gradients
// rely on that.
#pragma once

#include <array>

#include "path/scatter.h"

namespace gradus::path {

// What next-event estimation at a vertex has chosen.
struct LightSample {
  light::LightPoint point;
  light::LightEvaluation view;
};

// Light scattered within one class.
struct LitClass {
  Rgb value = Rgb(0.0f);  // f·|cos|·radiance
  float pdf_bsdf = 0.0f;  // P(class)·p(direction | class); 0 for emitters that BSDF sampling cannot find
};

// Emitter by the sample's random numbers. False: there is nothing to see.
bool sample_light(const PathContext& context, const VertexSample& u, const Vertex& vertex, int depth,
                  LightSample* light);
// Scattering of an emitter's light at a vertex towards its wo, the shadow left out. Each kind of bounce sees what a ray
// of that kind would find: both techniques have the same integrand. ray: that arrived at the vertex.
LitClass light_class(const PathContext& context, const Vertex& vertex, bsdf::ScatterClass c, const LightSample& light,
                     const shading::RayState& ray);
// The same, split by Blender's light passes.
std::array<Rgb, 3> light_by_pass(const PathContext& context, const Vertex& vertex, bsdf::ScatterClass c,
                                 const LightSample& light, const shading::RayState& ray);
// Transmittance for shadow rays.
Rgb light_transmittance(const PathContext& context, const geometry::SurfacePoint& from, const light::LightPoint& point,
                        const light::LightEvaluation& view, uint32_t crossed);
// The event from which a ray came; nullptr for the camera.
struct RaySource {
  const Vertex* vertex = nullptr;
  const ScatterEvent* event = nullptr;
  // Light sampling could have made the event's path.
  bool sampled_light() const { return vertex != nullptr && !event->sample.dirac; }
};

// Density of light sampling for what a ray found; 0 where it cannot.
float light_pdf(const PathContext& context, const RaySource& source, const light::LightPoint& point);
// p_bsdf / (p_light + p_bsdf).
inline float bsdf_weight(float pdf_light, float pdf_bsdf) {
  return pdf_light > 0.0f ? pdf_bsdf / (pdf_light + pdf_bsdf) : 1.0f;
}

// Radiance of a light that a ray crosses, and of the world behind everything, towards a ray of this kind; 0 where
// hidden from it.
Rgb light_hit_radiance(const PathContext& context, const light::LightEvaluation& view, const PathRay& ray, int depth);
Rgb world_radiance(const PathContext& context, const PathRay& ray, int depth);

}  // namespace gradus::path
