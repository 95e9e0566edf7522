// Channels of a film: planes of any quantity beside the radiance of the components. Passes, AOVs, light groups and
// Cryptomatte ranks are channels. A channel is made from a description at run time and found by its name. The samplers,
// the store, merging and the readers go by the description, so that none of them knows what a channel shows.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gradus/gradus.h"

namespace gradus::film {

inline constexpr int kHalves = 2;

// Meaning of a channel's values.
enum class ValueType : uint8_t {
  kRadiance,     // Light, which the film's exposure multiplies when it is read.
  kData,         // Any other quantity.
  kIdAndWeight,  // Pairs of an identifier and the sum of its weights, such as Cryptomatte ranks. Weight 0: no pair.
};

// Divisor of a channel's sums when they are read.
enum class Normalisation : uint8_t {
  kSampleCount,  // The number of samples of the pixel; a sample without a value counts as 0.
  kOwnWeight,    // Channel::weight, the weight of those samples of the pixel that have a value.
  kAllPaths,     // Channel::paths, the number of paths of the whole render.
  kFirstSample,  // None: the channel keeps the value of the first sample.
};

struct ChannelInfo {
  std::string name;
  // At most 4; for pairs of identifier and weight an even number up to kMaxPairValues.
  uint32_t values_per_pixel = 1;
  ValueType type = ValueType::kData;
  Normalisation normalisation = Normalisation::kSampleCount;
  bool in_halves = false;     // kept in half-buffers, from which the noise is estimated
  bool takes_splats = false;  // paths of any pixel may add to it (film/splats.h)
  bool operator==(const ChannelInfo&) const = default;
};

inline constexpr uint32_t kMaxPairValues = 32;

struct Channel {
  ChannelInfo info;
  uint32_t pass = GRADUS_PASS_COUNT;  // the pass that has this name; GRADUS_PASS_COUNT if there is none
  // Sums over samples or paths, row-major over the film's region. The second is empty unless the channel is in halves.
  std::array<std::vector<float>, kHalves> values;
  std::vector<float> weight;              // empty unless the channel is normalised by its own weight
  std::array<uint64_t, kHalves> paths{};  // paths that may have added to `values`, if normalised by all paths

  int buffer_of(int half) const { return info.in_halves ? half : 0; }
  std::vector<float>& of_half(int half) { return values[buffer_of(half)]; }
  bool keeps_first_sample() const { return info.normalisation == Normalisation::kFirstSample; }
  bool has_weight() const { return info.normalisation == Normalisation::kOwnWeight; }
};

// The channels of a film, in the order in which they were added.
class ChannelList {
 public:
  // Adds a channel with zeroed planes for so many pixels. Invalidates pointers to other channels. Throws
  // invalid_argument if the description contradicts itself or the pass of that name, or if a stored film could not hold
  // the name: it is empty or too long, differs from another one only in spaces and underscores, or is a name of the
  // film's own planes.
  void add(const ChannelInfo& info, size_t pixels);
  void clear() { *this = {}; }

  // Returns the channel, or nullptr. Inner loops call find() once and keep the pointer; of_pass() is a table look-up.
  const Channel* find(std::string_view name) const;
  Channel* find(std::string_view name);
  const Channel* of_pass(uint32_t pass) const;
  Channel* of_pass(uint32_t pass);
  // Returns the passes that have a channel, one bit each.
  uint64_t passes() const;

  size_t size() const { return list_.size(); }
  bool empty() const { return list_.empty(); }
  Channel& operator[](size_t i) { return list_[i]; }
  const Channel& operator[](size_t i) const { return list_[i]; }
  auto begin() { return list_.begin(); }
  auto end() { return list_.end(); }
  auto begin() const { return list_.begin(); }
  auto end() const { return list_.end(); }

 private:
  std::vector<Channel> list_;
  std::array<uint8_t, GRADUS_PASS_COUNT> place_of_pass_{};  // place in the list plus one; 0 if there is none
};

// Returns the channels that an integrator fills for these passes (one bit each), in order of pass number. They include
// the colours by which light passes are divided.
std::vector<ChannelInfo> channels_of_passes(uint64_t passes);
// Returns the passes with channels of these names, one bit each.
uint64_t passes_of(std::span<const ChannelInfo> channels);

}  // namespace gradus::film
