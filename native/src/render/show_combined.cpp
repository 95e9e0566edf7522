#include "render/show_combined.h"

#include "output/combine.h"
#include "schema/pass_table.h"

namespace gradus {

bool show_combined(const Film& film, uint32_t reconstruction, const Plan& plan, const std::atomic<bool>& stop, tbb::task_arena* arena,
                   Picture* picture, SolveReport* report) {
  const CancelCheck cancel = [&stop] { return stop.load(std::memory_order_relaxed); };
  std::vector<float> rgba, error;
  std::vector<float>* const wanted = has_bit(plan.passes, GRADUS_PASS_ERROR) ? &error : nullptr;
  std::vector<std::vector<float>> components;
  auto* const apart = needs_pictures(film.settings) ? &components : nullptr;
  arena->execute(
      [&] { rgba = combine(film, reconstruction, film.settings.reconstruction_alpha, plan.delivered, cancel, report, wanted, apart); });
  if (cancel()) return false;
  picture->show(std::move(rgba), std::move(error), std::move(components));
  return true;
}

}  // namespace gradus
