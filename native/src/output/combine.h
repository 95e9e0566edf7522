// Computes the Combined pass of a film, its estimated error and its components.
#pragma once

#include <vector>

#include "film/film.h"
#include "reconstruct/solver.h"

namespace gradus::output {

// Reconstructs the film and returns RGBA of `region`, 4 floats per pixel, multiplied by the film's exposure.
// `reconstruction` must not be AUTO. The colours of L2 may be negative, those of the other reconstructions are at least
// 0; alpha lies in [0, 1]. If `error` is given, it receives the estimated squared error of each pixel of the region, as
// the mean over RGB, in the units of the result squared. If `components` is given, it receives the RGB picture of each
// component, 3 floats per pixel of the region.
std::vector<float> combine(const film::Film& film, uint32_t reconstruction, float alpha, const Region& region,
                           const CancelCheck& cancel, reconstruct::SolveReport* report,
                           std::vector<float>* error = nullptr, std::vector<std::vector<float>>* components = nullptr);

// Returns RGBA of `region`, 4 floats per pixel, with the film's exposure. `image` is the reconstructed picture of the
// whole film region with interleaved channels.
std::vector<float> crop_picture(const film::Film& film, uint32_t reconstruction, const std::vector<float>& image,
                                const Region& region);
// Returns RGB of `region` for each component, clamped as the whole picture is. `images` are the reconstructed
// components of the whole film region with interleaved channels.
std::vector<std::vector<float>> crop_components(const film::Film& film, uint32_t reconstruction,
                                                std::vector<std::vector<float>> images, const Region& region);
// Adapts the components to a denoised picture, so that they still add up to it. `before` and `after` are the RGBA
// pictures. The change of each value is distributed over the components in proportion to their absolute values there.
void follow_picture(const std::vector<float>& before, const std::vector<float>& after,
                    std::vector<std::vector<float>>* components);
// Returns the squared error of `region`, multiplied by the squared film exposure. `error` covers the film's region.
std::vector<float> crop_error(const film::Film& film, const std::vector<float>& error, const Region& region);

}  // namespace gradus::output
