// Random numbers as a function of a sample key: Owen-scrambled Sobol points, scrambled and shuffled by hashes.
#pragma once

#include "base/types.h"

namespace gradus::path {

// Returns a bijective mix of 32 bits ("lowbias32" of Wellons' search for low-bias multiply-xorshift hashes).
inline uint32_t mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

// Returns a hash of two values. It depends on their order.
inline uint32_t combine(uint32_t seed, uint32_t value) {
  return mix(seed ^ (mix(value + 0x9e3779b9u) + (seed << 6) + (seed >> 2)));
}

enum class StreamKind : uint32_t {
  Pixel = 0,
  Pilot = 1,
  LightPath = 2,
  Chain = 3,
  Disocclusion = 4,
  PixelBlock = 5,
  EdgeProbe = 6,
  EdgeRay = 7,
};

// A random number depends on its key and dimension alone. The film pixel and the time are not in the key: a replayed
// sample has the pixel and time of its own frame, but the stream of the frame before.
struct SampleKey {
  uint32_t seed = 0;
  StreamKind kind = StreamKind::Pixel;
  uint32_t stream = 0;  // y·width + x of the full frame in streams of single pixels
  int32_t stream_frame = 0;
  // Sample number. Even numbers belong to half-buffer A and odd ones to B. The two are scrambled independently.
  uint32_t index = 0;
  // If above 0, all pixels share the stream, and the first so many samples of all of them are parts of one net.
  uint32_t net_samples = 0;
  uint32_t morton = 0;  // Morton code of the pixel in such a stream
};

// Returns the number of a pixel in an order in which each aligned square of 2^k × 2^k pixels is consecutive (Morton
// 1966): the bits of x and y in turn. x and y below 2^16.
uint32_t morton_code(uint32_t x, uint32_t y);

// Dimensions are counted in blocks, so that an integrator counts events instead of numbers, and a shift can replay one
// event.
namespace dimension {
inline constexpr uint32_t kFilm = 0;  // 2D
inline constexpr uint32_t kLens = 1;  // 2D
inline constexpr uint32_t kTime = 2;  // 1D
inline constexpr uint32_t kFirstVertex = 4;
// Blocks of the walks below surfaces, far above those of vertices and of transparent surfaces: for each vertex those of
// the steps of its walk, then those of the vertex at which the walk ends.
inline constexpr uint32_t kFirstWalk = 1u << 24;
inline constexpr uint32_t kPerStep = 4;
inline constexpr uint32_t kMaxSteps = 256;
inline constexpr uint32_t kPerWalk = kPerStep * (kMaxSteps + 1) + 8;
// Blocks of one path vertex, added to kFirstVertex + vertex·kPerVertex.
inline constexpr uint32_t kBsdf = 0;         // 2D direction
inline constexpr uint32_t kLobe = 1;         // x: class, y: lobe in the class
inline constexpr uint32_t kLight = 2;        // 2D point on the light
inline constexpr uint32_t kLightChoice = 3;  // x: which light, y: unused
inline constexpr uint32_t kRoulette = 4;     // x: Russian roulette, y: transparency
inline constexpr uint32_t kOcclusion = 5;    // ambient occlusion pass
inline constexpr uint32_t kPerVertex = 6;
}  // namespace dimension

// Blocks of one path vertex, without that of ambient occlusion.
struct VertexSample {
  Vec2 bsdf, lobe, light, light_choice, roulette;
};

// Blocks of one step of a walk below a surface.
struct StepSample {
  Vec2 distance;  // x: colour channel, y: length of the step
  Vec2 direction;
  Vec2 guide;  // x: whether the direction is guided, y: to which side
};

class Sampler {
 public:
  Sampler() = default;
  // `independent` selects independent random numbers instead of Sobol points, for statistical tests.
  explicit Sampler(const SampleKey& key, bool independent = false);

  // Returns the point of a block in [0, 1)². It does not depend on earlier calls.
  Vec2 get2(uint32_t block) const;
  float get1(uint32_t block) const { return get2(block).x; }
  // Returns a hash of the sample key, for random numbers that need no Sobol net.
  uint32_t key() const { return combine(stream_hash_, index_); }
  // Returns the blocks of the vertex with `depth` scattering events before it, with the values of get2(). They are
  // computed in eight SIMD lanes at about the cost of one block.
  VertexSample vertex(int depth) const;
  // Returns the blocks of a step of the walk that starts at the vertex with `depth` scattering events before it, and
  // those of the vertex at which that walk ends.
  StepSample walk_step(int depth, uint32_t step) const;
  VertexSample walk_end(int depth) const;

 private:
  // Takes the points of a pixel from the nets of all pixels.
  void join_net(uint32_t samples, uint32_t morton);
  // Returns the blocks of a vertex that begin with `first`.
  VertexSample vertex_at(uint32_t first) const;
  // Computes consecutive blocks in SIMD lanes.
  template <uint32_t kLanes>
  void points(uint32_t first, float x[kLanes], float y[kLanes]) const;

  uint32_t stream_hash_ = 0;
  uint32_t index_ = 0;
  uint32_t reversed_index_ = 0;
  bool independent_ = false;
};

}  // namespace gradus::path
