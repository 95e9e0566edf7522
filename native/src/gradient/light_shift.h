// Shifts of the base's light samples. emission_shift.h explains the weights.
#pragma once

#include "gradient/base_path.h"
#include "gradient/gradient_accumulator.h"
#include "gradient/offset_path.h"
#include "path/light.h"

namespace gradus::gradient {

// Evaluates the base's light sample at the vertices of all coupled offsets, within one scattering class: sets
// OffsetPath::light. Shadow rays are traced together, and only for offsets whose vertex scatters the light.
void light_coupled(const BasePath& base, const path::LightSample& sample, bsdf::ScatterClass scatter_class,
                   OffsetPaths* offsets, film::Counters* counters);

// Return the shift of the contribution c, found by the light sample at the base's vertex `x` or `z` in one class.
//
// For a coupled offset, after light_coupled(): the point on the light is copied.
ShiftedContribution copy_light_sample(const BasePath& base, const path::Vertex& x, const path::LightSample& sample,
                                      bsdf::ScatterClass scatter_class, const path::Contribution& c,
                                      const OffsetPath& offset);
// For a pending offset, which connects to z: the light, its visibility and its density p_n are those of the base, and
// only the outgoing direction differs.
ShiftedContribution connect_to_lit_vertex(const BasePath& base, const path::Vertex& z, const path::LightSample& sample,
                                          bsdf::ScatterClass scatter_class, const path::Contribution& c,
                                          OffsetPath* offset);
// For an offset at stage Deeper.
ShiftedContribution share_light_sample(const BasePath& base, const path::Vertex& z, const path::LightSample& sample,
                                       const path::Contribution& c, const OffsetPath& offset);

}  // namespace gradus::gradient
