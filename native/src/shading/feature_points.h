// The feature points of cellular textures: every cell of a lattice in 1 to 4 dimensions has a random point and a random
// colour. They are computed for all cells around a cell at once, eight in lanes. Coordinates fill the first D
// components of a Vec4.
#pragma once

#include <array>
#include <cmath>

#include "base/types.h"
#include "shading/lattice_hash.h"
#include "shading/scalar.h"

namespace gradus::shading {

// The hash of the cells: of the bits of floats, as before Blender 5.0, or of whole numbers. In one dimension it is
// always that of floats.
enum class CellHash { Floats, Integers };

// A cell, as the position of its lower corner.
template <int D>
Vec4 cell_of(const Vec4& p) {
  Vec4 cell(0.0f);
  for (int axis = 0; axis < D; axis++) cell[axis] = std::floor(p[axis]);
  return cell;
}

// The cells up to R cells away from a cell. The offset along x changes fastest.
template <int D, int R>
struct Neighbourhood {
  static constexpr int kSide = 2 * R + 1;
  static constexpr int kCells = kSide * (D > 1 ? kSide : 1) * (D > 2 ? kSide : 1) * (D > 3 ? kSide : 1);
  static constexpr int kBlocks = (kCells + kLanes - 1) / kLanes;
  static constexpr int kCenter = kCells / 2;

  // Offsets by axis and cell. Lanes after the last cell repeat offsets and count as no cell.
  using Offsets = std::array<std::array<float, kBlocks * kLanes>, D>;
  static constexpr Offsets make_offsets() {
    Offsets offsets{};
    for (int cell = 0; cell < kBlocks * kLanes; cell++)
      for (int axis = 0, rest = cell; axis < D; axis++, rest /= kSide)
        offsets[axis][cell] = static_cast<float>(rest % kSide - R);
    return offsets;
  }
  alignas(32) static constexpr Offsets kOffsets = make_offsets();

  static FloatLanes offset(int axis, int block) {
    return (FloatLanes)_mm256_load_ps(kOffsets[axis].data() + block * kLanes);
  }
  static Vec4 offset_of(int cell) {
    Vec4 offset(0.0f);
    for (int axis = 0; axis < D; axis++) offset[axis] = kOffsets[axis][cell];
    return offset;
  }
  static SignedLanes is_cell(int block) {
    return kLaneNumber + static_cast<float>(block * kLanes) < static_cast<float>(kCells);
  }
};

// ------------------------------------------------------------------------------------------------ hashes

namespace detail {
inline void point_hash(const FloatLanes (&c)[1], FloatLanes (&out)[1]) { out[0] = float_hash(c[0]); }
inline void point_hash(const FloatLanes (&c)[2], FloatLanes (&out)[2]) {
  out[0] = float_hash(c[0], c[1]);
  out[1] = float_hash(c[0], c[1], 1.0f);
}
inline void point_hash(const FloatLanes (&c)[3], FloatLanes (&out)[3]) {
  out[0] = float_hash(c[0], c[1], c[2]);
  out[1] = float_hash(c[0], c[1], c[2], 1.0f);
  out[2] = float_hash(c[0], c[1], c[2], 2.0f);
}
inline void point_hash(const FloatLanes (&c)[4], FloatLanes (&out)[4]) {
  out[0] = float_hash(c[0], c[1], c[2], c[3]);
  out[1] = float_hash(c[3], c[0], c[1], c[2]);
  out[2] = float_hash(c[2], c[3], c[0], c[1]);
  out[3] = float_hash(c[1], c[2], c[3], c[0]);
}
}  // namespace detail

// Writes the random points of eight cells, relative to their lower corners, in 0…1.
template <int D>
void cell_points(CellHash hash, const FloatLanes (&cell)[D], FloatLanes (&out)[D]) {
  if (D == 1 || hash == CellHash::Floats) {
    detail::point_hash(cell, out);
  } else if constexpr (D > 1) {
    Lanes index[D];
    for (int axis = 0; axis < D; axis++) index[axis] = (Lanes) __builtin_convertvector(cell[axis], SignedLanes);
    pcg_hash(index, out);
  }
}

// Returns the random colour of a cell.
template <int D>
Rgb cell_color(CellHash hash, const Vec4& cell) {
  if constexpr (D == 1) return color_hash(cell.x);
  if (hash == CellHash::Integers) {
    constexpr int kHashed = D == 4 ? 4 : 3;
    uint32_t index[kHashed] = {};
    float out[kHashed];
    for (int axis = 0; axis < D; axis++) index[axis] = static_cast<uint32_t>(to_int(cell[axis]));
    pcg_hash(index, out);
    return Rgb(out[0], out[1], out[2]);
  }
  if constexpr (D == 2) return color_hash(cell.x, cell.y);
  if constexpr (D == 3) return color_hash(cell.x, cell.y, cell.z);
  return color_hash(cell.x, cell.y, cell.z, cell.w);
}

// ------------------------------------------------------------------------------------------------ points

// The points of all cells of a neighbourhood.
template <int D, int R>
struct FeaturePoints {
  using Cells = Neighbourhood<D, R>;
  FloatLanes at[Cells::kBlocks][D];

  // The points around `cell` + `shift`, relative to `cell`. A `randomness` of 0 puts them on the lower corners.
  FeaturePoints(CellHash hash, const Vec4& cell, float randomness, const Vec4& shift = Vec4(0.0f)) {
    for (int block = 0; block < Cells::kBlocks; block++) {
      FloatLanes offset[D], neighbour[D], random[D];
      for (int axis = 0; axis < D; axis++) {
        offset[axis] = Cells::offset(axis, block) + shift[axis];
        neighbour[axis] = cell[axis] + offset[axis];
      }
      cell_points(hash, neighbour, random);
      for (int axis = 0; axis < D; axis++) at[block][axis] = offset[axis] + random[axis] * randomness;
    }
  }

  Vec4 of(int index) const {
    Vec4 point(0.0f);
    for (int axis = 0; axis < D; axis++) point[axis] = at[index / kLanes][axis][index % kLanes];
    return point;
  }
};

// A number for each cell of a neighbourhood, infinite in lanes that count as no cell.
template <int D, int R>
struct CellValues {
  using Cells = Neighbourhood<D, R>;
  FloatLanes in[Cells::kBlocks];

  void set(int block, FloatLanes values) { in[block] = Cells::is_cell(block) ? values : FloatLanes{} + kInfinity; }
  float of(int index) const { return in[index / kLanes][index % kLanes]; }
  void remove(int index) { in[index / kLanes][index % kLanes] = kInfinity; }

  // Returns the first cell with the smallest value, or -1 if no value is below `limit`.
  int smallest(float limit) const {
    FloatLanes least = in[0], number = kLaneNumber;
    for (int block = 1; block < Cells::kBlocks; block++) {
      const SignedLanes is_less = in[block] < least;
      least = is_less ? in[block] : least;
      number = is_less ? kLaneNumber + static_cast<float>(block * kLanes) : number;
    }
    int best = 0;
    for (int lane = 1; lane < kLanes; lane++)
      if (least[lane] < least[best] || (least[lane] == least[best] && number[lane] < number[best])) best = lane;
    return least[best] < limit ? static_cast<int>(number[best]) : -1;
  }
};

}  // namespace gradus::shading
