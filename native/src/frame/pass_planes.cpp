#include "frame/pass_planes.h"

#include "settings/pass_table.h"

namespace gradus {

std::vector<PassPlane> make_pass_planes(uint64_t passes, size_t pixels) {
  std::vector<PassPlane> planes;
  for (const PassInfo& info : stored_passes(passes)) {
    PassPlane& plane = planes.emplace_back();
    plane.pass = info.pass;
    plane.channels = info.channels;
    plane.first_sample_only = info.kind == PassKind::First;
    plane.skips_transparent = info.kind == PassKind::Weighted;
    plane.values.assign(pixels * info.channels, 0.0f);
    if (plane.skips_transparent) plane.weight.assign(pixels, 0.0f);
  }
  return planes;
}

}  // namespace gradus
