#include "animation/frame_delivery.h"

#include <algorithm>
#include <utility>

#include "base/clock.h"
#include "base/error.h"
#include "base/threads.h"
#include "output/options.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::animation {
namespace {

constexpr const char* kNotDelivered = "the frame was not delivered: ";

// Whether some pass of the frame needs optical flow, and its film knows which points its components show.
bool has_flow(const output::DevelopedFilm& developed) {
  return schema::needs_flow(developed.film->settings) && !developed.film->components[0].shown.empty();
}

bool can_flow(const output::DevelopedFilm& from, const output::DevelopedFilm& to) {
  return has_flow(from) && has_flow(to) && from.region == to.region;
}

// Applies to the settings of `frame` the changes that `changed` makes to the settings of another frame, `other`.
// Numbers may be animated: a number that is unchanged in the other frame keeps the value of `frame`.
GradusSettings as_changed(GradusSettings frame, const GradusSettings& other, const GradusSettings& changed) {
  frame.reconstruction = changed.reconstruction;
  frame.denoiser = changed.denoiser;
  if (changed.reconstruction_alpha != other.reconstruction_alpha)
    frame.reconstruction_alpha = changed.reconstruction_alpha;
  if (changed.film_exposure != other.film_exposure) frame.film_exposure = changed.film_exposure;
  return frame;
}

// Returns the cause to report where a flow is missing: NoNeighbour if nothing else forbids the flow.
motion::Tracking or_no_neighbour(motion::Tracking expected) {
  return expected == motion::Tracking::Tracked ? motion::Tracking::NoNeighbour : expected;
}

}  // namespace

FrameDelivery::FrameDelivery(std::shared_ptr<Sequence> sequence, int32_t frame, const GradusSettings* settings)
    : sequence_(std::move(sequence)), number_(frame), changed_(settings ? std::optional(*settings) : std::nullopt) {}

void FrameDelivery::render() {
  {
    const std::lock_guard lock(mutex_);
    phase_ = GRADUS_PHASE_RECONSTRUCTING;
  }
  const std::shared_ptr<const DevelopedFrame> previous = make();
  double seconds_ahead = 0.0, cpu_ahead = 0.0;
  if (sequence_->settings_.with_flow && has_flow(developed_->pictures))
    find_flow(previous.get(), &seconds_ahead, &cpu_ahead);
  image_bytes_ = developed_->pictures.memory_bytes();
  check_cancelled();
  // Settings may be animated, so that the next frame may be reconstructed in windows.
  sequence_->forget_before(sequence_->first_of_windows(number_));
  const std::lock_guard lock(mutex_);
  developed_->record.stats.total_seconds += seconds() - seconds_ahead;
  developed_->record.stats.process_cpu += process_cpu_seconds() - cpu_ahead;
}

std::shared_ptr<const DevelopedFrame> FrameDelivery::make() {
  FrameDeveloper developer(sequence_.get(), number_, changed_, cancel_);
  std::shared_ptr<DevelopedFrame> own = std::exchange(sequence_->ahead_, nullptr);
  const bool is_developed = own && developer.would_develop(*own);
  std::shared_ptr<const DevelopedFrame> previous;
  if (!is_developed) {
    sequence_->back_.clear();
    if (leads_to(sequence_->place_of(number_)) == motion::Tracking::Tracked)
      previous = develop_neighbour(number_ - 1);  // before this frame, because pictures are solved in order
    own = developer.load();
  }
  {
    const std::lock_guard lock(mutex_);
    developed_ = own;
  }
  if (!is_developed) developer.develop_picture(own.get());
  image_bytes_ = own->pictures.memory_bytes();
  return previous;
}

GradusSettings FrameDelivery::sampled_settings(int32_t number) const {
  const std::optional<GradusSettings> stored = sequence_->folder_.settings(number);
  return stored ? *stored : sequence_->traits_at(sequence_->place_of(number)).settings;
}

std::shared_ptr<DevelopedFrame> FrameDelivery::develop_neighbour(int32_t number) const {
  std::optional<GradusSettings> requested;  // without a value: the settings that the folder holds
  if (changed_) requested = as_changed(sampled_settings(number), sampled_settings(number_), *changed_);
  FrameDeveloper developer(sequence_.get(), number, requested, cancel_);
  std::shared_ptr<DevelopedFrame> developed = developer.load();
  developer.develop_picture(developed.get());
  return developed;
}

motion::Tracking FrameDelivery::leads_to(int place) {
  if (!sequence_->settings_.with_flow) return motion::Tracking::NoNeighbour;
  const GradusSettings settings = sequence_->traits_at(sequence_->place_of(number_)).settings;
  if (!schema::needs_flow(settings)) return motion::Tracking::NoNeighbour;
  output::Options options;
  options.reconstruction = changed_ ? changed_->reconstruction : uint32_t{GRADUS_RECONSTRUCTION_AUTO};
  options = output::resolve_auto(options, sequence_->facts_of(number_));
  const motion::Tracking found = sequence_->flows_to(place, options.reconstruction);
  const bool has_library = sequence_->flow_library(&warnings_) != nullptr;
  return found == motion::Tracking::Tracked && !has_library ? motion::Tracking::NoFlowLibrary : found;
}

void FrameDelivery::find_flow(const DevelopedFrame* previous, double* seconds_ahead, double* cpu_ahead) {
  const int place = sequence_->place_of(number_);
  const motion::Tracking leads_here = leads_to(place), leads_on = leads_to(place + 1);
  std::shared_ptr<DevelopedFrame> next;
  if (leads_on == motion::Tracking::Tracked) {
    const ScopedTimer timer(seconds_ahead, cpu_ahead);
    next = develop_neighbour(number_ + 1);
  }
  if (next) {
    next->record.stats.total_seconds += *seconds_ahead;
    next->record.stats.process_cpu += *cpu_ahead;
  }
  render::RenderStats& stats = developed_->record.stats;
  const ScopedTimer timer(&stats.seconds.correspondence, &stats.cpu_seconds.correspondence);
  const uint32_t threads =
      output::threads_of(changed_ ? *changed_ : sampled_settings(number_), sequence_->device_.get());
  tbb::task_arena(arena_size(threads)).execute([&] { join(previous, leads_here, std::move(next), leads_on); });
  for (const std::string& warning : warnings_)
    stats.leave_out(warning, developed_->pictures.film->settings.strict != 0);
}

void FrameDelivery::join(const DevelopedFrame* previous, motion::Tracking leads_here,
                         std::shared_ptr<DevelopedFrame> next, motion::Tracking leads_on) {
  const motion::FlowLibrary* library = sequence_->flow_library(&warnings_);
  output::DevelopedFilm& pictures = developed_->pictures;
  FrameFlows back = std::exchange(sequence_->back_, {});
  if (back.empty() && previous && can_flow(previous->pictures, pictures))
    back = flows_between(*library, previous->pictures, pictures)[1];
  complete_flows(pictures, Side::Previous, or_no_neighbour(leads_here), &back);
  check_cancelled();
  FrameFlows forth;
  if (next && can_flow(pictures, next->pictures)) {
    std::array<FrameFlows, 2> both = flows_between(*library, pictures, next->pictures);
    forth = std::move(both[0]);
    sequence_->back_ = std::move(both[1]);
  }
  complete_flows(pictures, Side::Next, or_no_neighbour(leads_on), &forth);
  sequence_->ahead_ = std::move(next);
  store_flows(back, forth, &pictures);
}

std::shared_ptr<const DevelopedFrame> FrameDelivery::developed(const char* what) const {
  const std::lock_guard lock(mutex_);
  require_film(developed_ ? developed_->pictures.film : nullptr, what, kNotDelivered);
  return developed_;
}

const Region& FrameDelivery::delivered() const { return developed("its passes come")->pictures.region; }

void FrameDelivery::read_pass(uint32_t pass, float* pixels) const {
  developed("its passes come")->pictures.read_pass(pass, pixels);
}

void FrameDelivery::read_component(const std::string& name, uint32_t pass, float* pixels) const {
  developed("its passes come")->pictures.read_component(name, pass, pixels);
}

void FrameDelivery::read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) const {
  developed("its channels come")->pictures.read_channel(kind, name, layer, pixels);
}

std::string FrameDelivery::stats() const {
  const std::shared_ptr<const DevelopedFrame> own = developed("its stats come");
  return render::stats_json(own->record.stats, own->record.plan, *own->pictures.film);
}

std::shared_ptr<const film::Film> FrameDelivery::film() const { return developed("its film comes")->pictures.film; }

uint64_t FrameDelivery::memory_bytes() const {
  if (!developed_) return 0;
  return developed_->pictures.film->memory_bytes() + image_bytes_;
}

}  // namespace gradus::animation
