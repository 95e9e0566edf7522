#include "render/show_combined.h"

#include "render/combine.h"
#include "settings/pass_table.h"

namespace gradus {

bool show_combined(const Frame& frame, uint32_t reconstruction, const Plan& plan, const std::atomic<bool>& stop, tbb::task_arena* arena,
                   Picture* picture, SolveReport* report) {
  const CancelTest cancel = [&stop] { return stop.load(std::memory_order_relaxed); };
  std::vector<float> rgba, error;
  std::vector<float>* const wanted = wants(plan.passes, GRADUS_PASS_ERROR) ? &error : nullptr;
  std::vector<std::vector<float>> components;
  auto* const apart = wants_pictures(frame.settings) ? &components : nullptr;
  arena->execute(
      [&] { rgba = combine(frame, reconstruction, frame.settings.reconstruction_alpha, plan.delivered, cancel, report, wanted, apart); });
  if (cancel()) return false;
  picture->show(std::move(rgba), std::move(error), std::move(components));
  return true;
}

}  // namespace gradus
