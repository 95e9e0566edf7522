// The names of all counters of a film, for stored films and the stats.
#pragma once

#include <cstdint>
#include <iterator>

#include "film/film.h"

namespace gradus::film {

// A counter and its place in JSON, in stored films and in the stats: a JSON pointer (RFC 6901).
struct CounterField {
  const char* path;
  uint64_t Counters::*value;
};
// All counters. Films of earlier versions hold the first 20 as a list in this order, so new counters are appended.
inline constexpr CounterField kCounterFields[] = {
    {"/rays/primary", &Counters::rays_primary},
    {"/rays/bounce", &Counters::rays_bounce},
    {"/rays/shadow", &Counters::rays_shadow},
    {"/rays/shift", &Counters::rays_shift},
    {"/rays/shift_shadow", &Counters::rays_shift_shadow},
    {"/shifts/attempted", &Counters::shifts_attempted},
    {"/shifts/reconnected", &Counters::shifts_reconnected},
    {"/shifts/half_vector", &Counters::shifts_half_vector},
    {"/shifts/replayed", &Counters::shifts_replayed},
    {"/shifts/failed/missed", &Counters::fail_missed},
    {"/shifts/failed/occluded", &Counters::fail_occluded},
    {"/shifts/failed/class", &Counters::fail_class},
    {"/shifts/failed/total_reflection", &Counters::fail_total_reflection},
    {"/shifts/failed/side", &Counters::fail_side},
    {"/shifts/failed/density", &Counters::fail_density},
    {"/shifts/failed/jacobian", &Counters::fail_jacobian},
    {"/shifts/failed/border", &Counters::fail_border},
    {"/nonfinite_dropped/radiance", &Counters::nonfinite_radiance},
    {"/nonfinite_dropped/gradient", &Counters::nonfinite_gradient},
    {"/nonfinite_dropped/feature", &Counters::nonfinite_feature},
};
static_assert(std::size(kCounterFields) * sizeof(uint64_t) == sizeof(Counters));

}  // namespace gradus::film
