// Finds the edges of emitters that the camera sees: windows, lights, and what stands before the sky.
//
// There a pixel is as bright as the part of it that the emitter covers, which a few camera rays hardly tell, and what
// is wrong by a little is many times the light beside it. Emission at the end of a camera ray needs no path. In pixels
// at such edges a sample therefore takes further camera rays, and what the camera sees directly is the mean over all of
// them (PathTracer::li). The light that surfaces scatter still comes from the path alone, so that this helps where it
// is dim beside the emission: with emission E on one side of an edge and scattered light L on the other, the variance
// is p(1 − p)(L² + (E² − 2EL)/17) in place of p(1 − p)(E − L)², which is less for L < E/2.
#pragma once

#include <atomic>
#include <span>
#include <vector>

#include "path/trace.h"

namespace gradus::path {

// Number of further camera rays of a sample, a power of 2, so that their positions are a net of Sobol points.
inline constexpr uint32_t kEdgeRays = 16;

// Returns 1 for each pixel of a region within a pixel of which camera rays end on different emitters or surfaces, whose
// emission differs, and differs by more than the light that they scatter; row-major, and empty if the camera sees no
// emitter. The result at a pixel depends neither on the region nor on samples. Returns early on `stop`.
std::vector<uint8_t> find_emission_edges(const PathContext& context, const Region& region,
                                         const std::atomic<bool>& stop);

// Sets the further camera rays of a sample of a pixel. They belong to the sample's half-buffer.
void make_edge_rays(const PathContext& context, int32_t x, int32_t y, uint32_t number,
                    std::span<CameraRay, kEdgeRays> rays);

}  // namespace gradus::path
