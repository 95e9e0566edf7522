#include "gradient/gradient_accumulator.h"

namespace gradus::gradient {

GradientAccumulator::GradientAccumulator(const path::PathContext& context, OffsetPaths* offsets,
                                         film::Counters* counters)
    : context_(context),
      offsets_(*offsets),
      counters_(*counters),
      clamps_(is_finite(context.clamp_direct) || is_finite(context.clamp_indirect)) {}

void GradientAccumulator::start(const PairCounts& pairs) {
  pairs_ = pairs;
  suffix_ = Suffix{};
  for (int c = 0; c < context_.components.count(); ++c) gradient_[size_t(c)].fill(Radiance(0.0f));
}

void GradientAccumulator::add(int k, const path::Contribution& c, const ShiftedContribution& offset) {
  if (!offset.is_paired) {
    count_failure(offset.failure, &counters_);
    add_unpaired(k, c);
    return;
  }
  if (!(offset.ratio > 0.0f) || !is_finite(offset.ratio)) {
    ++counters_.fail_jacobian;
    add_unpaired(k, c);
    return;
  }
  const Radiance value(path::clamp_contribution(context_, offset.value, c.indirect), 0.0f);
  add_pair(k, c.component, Radiance(c.clamped, 0.0f), value, offset.ratio);
}

// Compiled once, because multiplications and additions are contracted differently where it is inlined elsewhere.
void GradientAccumulator::add_pair(int k, int component, const Radiance& base, const Radiance& offset, float ratio) {
  gradient_[size_t(component)][size_t(k)] += pairs_[size_t(k)].paired(base, offset, ratio);
}

void GradientAccumulator::add_to_suffix(const path::Contribution& c, const Rgb& segment_weight) {
  if (c.component != suffix_.component) {
    flush();
    suffix_.component = c.component;
  }
  const Rgb tail = suffix_.weight * segment_weight * c.tail;
  if (clamps_) {
    for (int k = 0; k < film::kOffsets; ++k) {
      const OffsetPath& o = offsets_[k];
      if (is_final(o.stage)) {
        const Rgb value = path::clamp_contribution(context_, o.state.throughput * tail, c.indirect);
        add_pair(k, c.component, Radiance(c.clamped, 0.0f), Radiance(value, 0.0f), o.ratio);
      }
    }
    return;
  }
  suffix_.is_empty = false;
  suffix_.base += c.clamped;
  suffix_.tail += tail;
}

void GradientAccumulator::flush() {
  if (suffix_.is_empty) {
    return;
  }
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (is_final(o.stage)) {
      const Rgb value = o.state.throughput * suffix_.tail;
      add_pair(k, suffix_.component, Radiance(suffix_.base, 0.0f), Radiance(value, 0.0f), o.ratio);
      o.state.throughput *= suffix_.weight;
    }
  }
  suffix_ = Suffix{};
}

}  // namespace gradus::gradient
