// Combined as it is shown: while samples are taken, and in the end.
#pragma once

#include <atomic>

#include <tbb/task_arena.h>

#include "film/film.h"
#include "reconstruct/solver.h"
#include "render/picture.h"
#include "render/plan.h"

namespace gradus::render {

// Reconstructs the frame in the arena, with its error where the plan has that pass, and shows it. False: stopped, and
// nothing is shown, for half of it is none.
bool show_combined(const film::Film& film, uint32_t reconstruction, const Plan& plan, const std::atomic<bool>& stop,
                   tbb::task_arena* arena, Picture* picture, reconstruct::SolveReport* report);

}  // namespace gradus::render
