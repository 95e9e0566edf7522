// Combined from a frame, and its error.
#pragma once

#include <vector>

#include "film/film.h"
#include "reconstruct/solver.h"

namespace gradus::output {

// RGBA of `region`, with the film's exposure. reconstruction: never AUTO. L2 may be negative (contract 5.5), the others
// not; alpha lies in [0, 1]. error: if given, the region's estimated squared error, mean over RGB, in the units of the
// result squared. components: likewise, RGB of each.
std::vector<float> combine(const film::Film& film, uint32_t reconstruction, float alpha, const Region& region,
                           const CancelCheck& cancel, reconstruct::SolveReport* report,
                           std::vector<float>* error = nullptr, std::vector<std::vector<float>>* components = nullptr);

// RGBA of `region` from what a reconstruction has made of the frame's region, channels interleaved.
std::vector<float> crop_picture(const film::Film& film, uint32_t reconstruction, const std::vector<float>& image,
                                const Region& region);
// RGB of components, of which the images are: as their picture is clamped.
std::vector<std::vector<float>> crop_components(const film::Film& film, uint32_t reconstruction,
                                                std::vector<std::vector<float>> images, const Region& region);
// A denoiser has changed the picture: what it has added and taken away is spread over the components by their light
// there.
void follow_picture(const std::vector<float>& before, const std::vector<float>& after,
                    std::vector<std::vector<float>>* components);
// Error of `region`, as of what the film's exposure makes of the image. error: of the frame's region.
std::vector<float> crop_error(const film::Film& film, const std::vector<float>& error, const Region& region);

}  // namespace gradus::output
