// Continues a render from the samples of a film, and merges films. A render of 16 samples that is continued by 48 is
// bit-identical to a render of 64.
#pragma once

#include <cstdint>

#include "film/film.h"
#include "render/plan.h"

namespace gradus::render {

// Returns the number of samples that every pixel of the film has, apart from further ones at edges; to continue
// adaptively, the mean over the pixels that have not stopped. Throws `invalid_argument` if pixels differ for another
// reason (a cancelled film, or a sum of adaptive ones). A film that was cancelled, or met its time limit, while edges
// took further samples is continued without the rest of these.
uint32_t resumed_samples(const film::Film& film, bool adaptively);
// Returns the components of a render that continues from the film. Components of the plan that the film merged into the
// remainder are merged again.
lpe::ComponentSet resumed_components(const film::Film& film, const Plan& plan);
// Throws `invalid_argument` with the reason if a render with these settings cannot continue from the film.
void check_resumable(const film::Film& film, const GradusSettings& settings, const Plan& plan, uint64_t scene_key);
// Throws `invalid_argument` if the film has gradients and none are wanted, or has none and they are wanted.
void check_gradients(const film::Film& film, bool wanted);

// Adds the samples of `other`, which has other sample numbers. Throws `invalid_argument` with the reason if the films
// differ in scene, settings, planes or components, or share samples.
void merge_films(film::Film* film, const film::Film& other);

}  // namespace gradus::render
