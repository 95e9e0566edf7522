// Shifts of emission that the base path has found by BSDF sampling: analytic lights, surfaces and the world.
//
// Two techniques find an emitter: light sampling with density p_n and BSDF sampling with density p_b. With the balance
// heuristic both give the contribution C = f/(p_n + p_b). Where both techniques use the same shift (class D: the point
// on the light is copied) and see the same integrand, a gradient sample is weighted against all four strategies,
// {light, BSDF} × {base, offset} (Kettunen et al. 2015; Manzi 2016, section 5.4.2):
//   (r·C' − C) / (m_p + m_q·r)  with  r = |T'|·(p_n(y) + p_b(y)) / (p_n(x) + p_b(x)).
// Otherwise each technique is paired with itself: r = |T'|·p_t(y)/p_t(x), with the same C and C'. This applies to
// specular classes, where BSDF samples copy the half-vector and light samples the point on the light. It also applies
// where shadow rays and scattered rays see different surfaces, as at the shadow terminator of faceted meshes at either
// end. Both pairings are unbiased.
#pragma once

#include "gradient/base_path.h"
#include "gradient/gradient_accumulator.h"
#include "gradient/offset_path.h"

namespace gradus::gradient {

// Returns the Jacobian of copying a point on a light between two receivers, from its evaluations at both. It is 1 where
// the choice of the point is discrete (Dirac lights), and where a direction is copied (infinity).
float copy_jacobian(const light::LightPoint& point, const light::LightEvaluation& base,
                    const light::LightEvaluation& offset);

// Returns whether all four strategies can be weighted jointly for this light. They cannot where the offset copies the
// random number of the class, because light samples have no such number.
bool weights_jointly(const BasePath& base, const light::LightEvaluation& view, const OffsetPath& offset);
// Returns whether the directions to an emitter leave the facets of both vertices, so that shadow rays need no
// correction at the terminator.
bool both_leave_facets(const path::Vertex& base, const Vec3& base_direction, const OffsetPath& offset,
                       const Vec3& direction);

// Returns the emission that the offset's own segment shows. Alpha is minus the share of the film that the segment
// leaves transparent. Multiplies the throughput of the offset by the weight of the segment. Where base and offset both
// have a segment of their own, from the camera or after a copied event, the emission is one function of the ray, so the
// pair needs no condition. It is formed even if one of the two segments shows nothing, so that the edges of visible
// lights, and of their mirror images, are sampled from both sides.
Radiance own_emission(const BasePath& base, OffsetPath* offset);

// Shifts the contribution c of an emitter that the base has found behind `source`, an event of class D, to a pending
// offset: the point on the light is copied. `base_view` and `view` evaluate the light from the two vertices.
// `probability` is that of the base's decisions at transparent surfaces on the segment to the light.
ShiftedContribution copy_light_point(const BasePath& base, const path::RaySource& source, const path::Contribution& c,
                                     const light::LightPoint& point, const light::LightEvaluation& base_view,
                                     const light::LightEvaluation& view, float probability, const OffsetPath& offset,
                                     film::Counters* counters);
// Shifts the contribution c of the base's latest vertex `z`, found behind `source`, to a pending offset, which connects
// to the vertex.
ShiftedContribution connect_to_emission(const BasePath& base, const path::RaySource& source,
                                        const path::Contribution& c, const light::LightPoint& point,
                                        const path::Vertex& z, const OffsetPath& offset);
// Shifts the contribution c of an emitter behind `source` that the shared path has found; `weight` is that of the
// segment up to it, and `is_joint` says whether the light can be weighted jointly.
ShiftedContribution share_emission(const BasePath& base, const path::RaySource& source, const path::Contribution& c,
                                   const Rgb& weight, bool is_joint, const OffsetPath& offset);

}  // namespace gradus::gradient
