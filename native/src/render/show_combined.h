// Reconstructs Combined and shows it, for previews and for the final image.
#pragma once

#include <atomic>

#include <tbb/task_arena.h>

#include "film/film.h"
#include "reconstruct/solver.h"
#include "render/picture.h"
#include "render/plan.h"

namespace gradus::render {

// Reconstructs the film in the task arena, with pass Error if the plan has it, and shows the result. Returns false if
// `stop` became true; then nothing is shown.
bool show_combined(const film::Film& film, uint32_t reconstruction, const Plan& plan, const std::atomic<bool>& stop,
                   tbb::task_arena* arena, Picture* picture, reconstruct::SolveReport* report);

}  // namespace gradus::render
