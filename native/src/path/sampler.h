// Random values as a pure function of their key (contract 1.1): Owen-scrambled Sobol points, scrambled and shuffled by
// hashes.
#pragma once

#include "base/types.h"

namespace gradus::path {

enum class StreamKind : uint32_t { Pixel = 0, Pilot = 1, LightPath = 2, Chain = 3, Disocclusion = 4, PixelBlock = 5 };

// Film pixel and scene time are separate from the key on purpose: a temporal offset sample has another film pixel and
// time but the stream of its base (contract 1.1).
struct SampleKey {
  uint32_t seed = 0;
  StreamKind kind = StreamKind::Pixel;
  uint32_t stream = 0;  // pixel streams: y·width + x of the full frame
  int32_t stream_frame = 0;
  uint32_t index =
      0;  // sample number; halves A and B are the even and odd numbers, scrambled independently (contract 1.2)
};

// Dimensions come in blocks, so that an integrator can count events instead of numbers and a shift can replay one
// event.
namespace dimension {
inline constexpr uint32_t kFilm = 0;  // 2-D
inline constexpr uint32_t kLens = 1;  // 2-D
inline constexpr uint32_t kTime = 2;  // 1-D
inline constexpr uint32_t kFirstVertex = 4;
// Blocks of one path vertex, added to kFirstVertex + vertex·kPerVertex.
inline constexpr uint32_t kBsdf = 0;         // 2-D direction
inline constexpr uint32_t kLobe = 1;         // x: class, y: lobe in the class
inline constexpr uint32_t kLight = 2;        // 2-D point on the emitter
inline constexpr uint32_t kLightChoice = 3;  // x: which emitter, y: spare
inline constexpr uint32_t kRoulette = 4;     // x: roulette, y: transparency
inline constexpr uint32_t kOcclusion = 5;    // ambient occlusion pass
inline constexpr uint32_t kPerVertex = 6;
}  // namespace dimension

// What a path needs at one vertex: its blocks but for the occlusion's.
struct VertexSample {
  Vec2 bsdf, lobe, light, light_choice, roulette;
};

class Sampler {
 public:
  Sampler() = default;
  // independent: values of an independent-random generator in place of the net; for statistical tests only.
  explicit Sampler(const SampleKey& key, bool independent = false);

  // Point of block `block` in [0, 1)²: any order, any number of times, always the same.
  Vec2 get2(uint32_t block) const;
  float get1(uint32_t block) const { return get2(block).x; }
  // The blocks of the vertex with `depth` scatterings before it, the same values: eight lanes cost about what one does.
  VertexSample vertex(int depth) const;

 private:
  uint32_t stream_hash_ = 0;
  uint32_t index_ = 0;
  uint32_t reversed_index_ = 0;
  bool independent_ = false;
};

}  // namespace gradus::path
