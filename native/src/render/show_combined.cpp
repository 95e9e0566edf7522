#include "render/show_combined.h"

#include "output/combine.h"
#include "schema/pass_table.h"

namespace gradus::render {

bool show_combined(const film::Film& film, uint32_t reconstruction, const Plan& plan, const std::atomic<bool>& stop,
                   tbb::task_arena* arena, Picture* picture, reconstruct::SolveReport* report) {
  const CancelCheck cancel = [&stop] { return stop.load(std::memory_order_relaxed); };
  std::vector<float> rgba, error;
  std::vector<float>* const wanted = schema::has_bit(plan.passes, GRADUS_PASS_ERROR) ? &error : nullptr;
  std::vector<std::vector<float>> components;
  auto* const apart = schema::needs_pictures(film.settings) ? &components : nullptr;
  arena->execute([&] {
    rgba = output::combine(film, reconstruction, film.settings.reconstruction_alpha, plan.delivered, cancel, report,
                           wanted, apart);
  });
  if (cancel()) return false;
  picture->show(std::move(rgba), std::move(error), std::move(components));
  return true;
}

}  // namespace gradus::render
