#include "film/channel.h"

#include <algorithm>

#include "base/error.h"
#include "film/plane_names.h"
#include "schema/pass_table.h"

namespace gradus::film {
namespace {

constexpr size_t kMaxName = 200, kMaxChannels = 255;
constexpr uint32_t kMaxValues = 4;

// Returns whether planes of the film itself or the weight of another channel may have this name, or whether the name
// holds control characters.
bool is_reserved(const std::string& name) {
  const std::string_view first = std::string_view(name).substr(0, name.find('.'));
  return std::ranges::find(plane_names::kReserved, first) != std::end(plane_names::kReserved) ||
         first.starts_with(plane_names::kComponentPrefix) || name.ends_with(plane_names::kWeightSuffix) ||
         std::ranges::any_of(name, [](char c) { return (c & ~0x1f) == 0; });
}

bool is_consistent(const ChannelInfo& info) {
  const bool pairs = info.type == ValueType::kIdAndWeight;
  if (info.values_per_pixel < 1 || info.values_per_pixel > (pairs ? kMaxPairValues : kMaxValues)) return false;
  if (pairs && (info.values_per_pixel % 2 != 0 || info.takes_splats)) return false;
  switch (info.normalisation) {
    case Normalisation::kSampleCount:
      return !(pairs && info.in_halves);  // identifiers of two halves cannot be added
    case Normalisation::kOwnWeight:
      return !info.in_halves && !info.takes_splats && !pairs;
    case Normalisation::kAllPaths:
      return info.takes_splats;
    case Normalisation::kFirstSample:
      return !info.in_halves && !info.takes_splats && !pairs;
  }
  return false;
}

ChannelInfo channel_of(const schema::PassInfo& pass) {
  ChannelInfo info{pass.name, pass.channels};
  if (schema::is_of_light(pass.kind)) info.type = ValueType::kRadiance;
  if (pass.kind == schema::PassKind::First) info.normalisation = Normalisation::kFirstSample;
  if (pass.kind == schema::PassKind::Weighted) info.normalisation = Normalisation::kOwnWeight;
  info.in_halves = schema::is_in_halves(pass.kind);
  return info;
}

// Returns whether the channel may stand for the pass with its name: readers of the pass rely on its description.
bool fits_pass(const ChannelInfo& info, uint32_t pass) {
  const std::vector<ChannelInfo> stored = channels_of_passes(uint64_t{1} << pass);
  return std::ranges::find(stored, info) != stored.end();
}

uint32_t pass_with_name(std::string_view name) {
  const auto passes = schema::all_passes();
  const auto found = std::ranges::find_if(passes, [&](const schema::PassInfo& pass) { return pass.name == name; });
  return found != passes.end() ? found->pass : uint32_t{GRADUS_PASS_COUNT};
}

}  // namespace

std::string stored_name(std::string_view name) {
  std::string stored(name);
  std::ranges::replace(stored, ' ', '_');
  return stored;
}

void ChannelList::add(const ChannelInfo& info, size_t pixels) {
  const std::string name = stored_name(info.name);
  const auto has_name = [&](const Channel& channel) { return stored_name(channel.info.name) == name; };
  if (name.empty() || name.size() > kMaxName || is_reserved(name) || list_.size() >= kMaxChannels ||
      std::ranges::any_of(list_, has_name)) {
    throw invalid_argument("there can be no channel of the name " + info.name);
  }
  const uint32_t pass = pass_with_name(info.name);
  if (!is_consistent(info) || (pass < GRADUS_PASS_COUNT && !fits_pass(info, pass)))
    throw invalid_argument("the description of channel " + info.name + " contradicts itself");
  Channel& channel = list_.emplace_back();
  channel.info = info;
  channel.pass = pass;
  for (int half = 0; half < (info.in_halves ? kHalves : 1); ++half)
    channel.values[half].assign(pixels * info.values_per_pixel, 0.0f);
  if (channel.has_weight()) channel.weight.assign(pixels, 0.0f);
  if (pass < GRADUS_PASS_COUNT) place_of_pass_[pass] = uint8_t(list_.size());
}

const Channel* ChannelList::find(std::string_view name) const {
  const auto found = std::ranges::find_if(list_, [&](const Channel& channel) { return channel.info.name == name; });
  return found != list_.end() ? &*found : nullptr;
}

Channel* ChannelList::find(std::string_view name) {
  return const_cast<Channel*>(static_cast<const ChannelList*>(this)->find(name));
}

const Channel* ChannelList::of_pass(uint32_t pass) const {
  return pass < GRADUS_PASS_COUNT && place_of_pass_[pass] != 0 ? &list_[place_of_pass_[pass] - 1] : nullptr;
}

Channel* ChannelList::of_pass(uint32_t pass) {
  return const_cast<Channel*>(static_cast<const ChannelList*>(this)->of_pass(pass));
}

uint64_t ChannelList::passes() const {
  uint64_t passes = 0;
  for (const Channel& channel : list_) passes |= channel.pass < GRADUS_PASS_COUNT ? uint64_t{1} << channel.pass : 0;
  return passes;
}

std::vector<ChannelInfo> channels_of_passes(uint64_t passes) {
  std::vector<ChannelInfo> channels;
  for (const schema::PassInfo& pass : schema::stored_passes(passes)) channels.push_back(channel_of(pass));
  return channels;
}

}  // namespace gradus::film
