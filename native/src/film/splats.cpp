#include "film/splats.h"

#include <utility>

#include "base/error.h"
#include "film/finite_check.h"

namespace gradus::film {

SplatQueue::SplatQueue(Film* film, Channel* channel) : film_(film), channel_(channel) {
  if (!channel->info.takes_splats) throw invalid_argument("channel " + channel->info.name + " takes no splats");
}

void SplatQueue::merge(uint32_t unit, int half, uint64_t paths, std::vector<Splat> splats, Counters* counters) {
  const std::lock_guard lock(mutex_);
  early_[unit] = {half, paths, std::move(splats)};
  for (auto i = early_.begin(); i != early_.end() && i->first == next_; i = early_.erase(i), ++next_) {
    add(i->second, counters);
  }
}

void SplatQueue::add(const Unit& unit, Counters* counters) {
  for (const Splat& splat : unit.splats) {
    if (film_->region.contains(splat.x, splat.y))
      add_feature(&splat.value.x, 1.0f, film_->index(splat.x, splat.y), unit.half, channel_, counters);
  }
  channel_->paths[channel_->buffer_of(unit.half)] += unit.paths;
}

}  // namespace gradus::film
