// Where a component is in the picture at all. Its black elsewhere has no noise: windows at its edge would explain that best, and take light
// from what is beside it.
#pragma once

#include "frame/features.h"
#include "reconstruct/field.h"

namespace gradus {

class Presence {
 public:
  Presence() = default;
  // By Features::present.
  explicit Presence(const Features& features);

  // 0 where it is absent.
  void mask(Field* values) const;
  // Mean over (2·radius + 1)² pixels, those alone in which it is present. values: 0 in the others.
  Field mean_around(const Field& values, int radius) const;

 private:
  Field present_;  // 1 or 0; none: everywhere
};

}  // namespace gradus
