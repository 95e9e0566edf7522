// The ways to divide a triangle at the middles of some of its edges.
#pragma once

#include <array>
#include <cstdint>

namespace gradus::geometry {

// The parts of a divided triangle. Points 0, 1 and 2 are its corners, 3, 4 and 5 the middles of the edges that begin
// there. All parts are as oriented as the triangle.
struct DivisionPattern {
  uint32_t count = 0;
  std::array<std::array<uint8_t, 3>, 4> parts{};
};

// Patterns by number. The first leaves the triangle as it is.
inline constexpr std::array<DivisionPattern, 11> kDivisionPatterns{{
    {1, {{{0, 1, 2}}}},
    {2, {{{0, 3, 2}, {3, 1, 2}}}},
    {2, {{{0, 1, 4}, {0, 4, 2}}}},
    {2, {{{0, 1, 5}, {5, 1, 2}}}},
    {3, {{{3, 1, 4}, {0, 3, 4}, {0, 4, 2}}}},
    {3, {{{3, 1, 4}, {0, 3, 2}, {3, 4, 2}}}},
    {3, {{{4, 2, 5}, {0, 1, 4}, {0, 4, 5}}}},
    {3, {{{4, 2, 5}, {0, 1, 5}, {1, 4, 5}}}},
    {3, {{{5, 0, 3}, {3, 1, 2}, {3, 2, 5}}}},
    {3, {{{5, 0, 3}, {3, 1, 5}, {1, 2, 5}}}},
    {4, {{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}}},
}};

// Returns the number of a pattern. Bit k of `edges` says whether the edge from corner k is divided. Where two are, a
// quadrilateral remains, which `second_diagonal` cuts along the other diagonal; diagonals_of() names both.
constexpr uint32_t division_pattern(uint32_t edges, bool second_diagonal) {
  constexpr std::array<uint8_t, 8> first{0, 1, 2, 4, 3, 8, 6, 10};
  const bool cuts = edges == 3 || edges == 5 || edges == 6;
  return first[edges] + (cuts && second_diagonal ? 1 : 0);
}

// Returns the ends of the first and of the second diagonal of the quadrilateral that two divided edges leave.
constexpr std::array<std::array<uint8_t, 2>, 2> diagonals_of(uint32_t edges) {
  if (edges == 3) return {{{0, 4}, {3, 2}}};
  if (edges == 6) return {{{0, 4}, {1, 5}}};
  return {{{3, 2}, {1, 5}}};
}

}  // namespace gradus::geometry
