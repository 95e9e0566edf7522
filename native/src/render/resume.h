// Going on from the samples of a frame (contract 2.1: 16 and then 48 samples have the bits of 64), and adding frames.
#pragma once

#include <cstdint>

#include "film/film.h"
#include "render/plan.h"

namespace gradus::render {

// Samples that every pixel of the frame has; to go on adaptively, their mean over the pixels that go on. Throws
// invalid_argument if pixels differ otherwise (a frame that was cancelled, or added up from adaptive ones).
uint32_t resumed_samples(const film::Film& film, bool adaptively);
// Those with which a render goes on from the frame: where small ones of the plan were merged into Residual, as in the
// frame.
lpe::ComponentSet resumed_components(const film::Film& film, const Plan& plan);
// Throws invalid_argument with the reason if a render with these settings cannot go on from the frame.
void check_resumable(const film::Film& film, const GradusSettings& settings, const Plan& plan, uint64_t scene_key);
// Throws invalid_argument if the frame has gradients and none are wanted, or the other way round.
void check_gradients(const film::Film& film, bool wanted);

// Adds the sums and counts of `other`, which has the same planes; what belongs to the first sample stays.
void add_sums(film::Film* film, const film::Film& other);
// Adds the samples of `other`, which has other sample numbers. Throws invalid_argument with the reason if they do not
// fit together.
void merge_films(film::Film* film, const film::Film& other);

}  // namespace gradus::render
