#include "animation/sequence.h"

#include <algorithm>
#include <utility>

#include "animation/frame_delivery.h"
#include "animation/frame_sampling.h"
#include "animation/fresh_replayed_shares.h"
#include "animation/spooled_frames.h"
#include "animation/stored_samples.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/fault.h"
#include "film/planes.h"
#include "render/memory_estimate.h"
#include "render/plan.h"
#include "render/resume.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::animation {

namespace {

// Returns the integrator for a frame of a sequence. There is no pilot render, because its findings in one frame would
// not hold for the next. Only a reconstruction by features can do without gradients in space.
uint32_t integrator_of(const GradusSettings& settings) {
  return joins_frames(settings) ? settings.integrator : uint32_t{GRADUS_INTEGRATOR_GRADIENT};
}

// Returns the places of the frames that the picture of a place is made from.
reconstruct::FrameRange frames_of_picture(const reconstruct::WindowGrid& grid, int place, uint32_t reconstruction) {
  return reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED ? grid.joined(place) : grid.around(place);
}

// Whether a stored film has the samples that the sequence would take of the snapshot.
bool is_frame_of(const film::FilmHeader& stored, const scene::Snapshot& snapshot, GradusSettings settings) {
  if (settings.integrator == GRADUS_INTEGRATOR_AUTO)
    settings.integrator = stored.settings.integrator;  // the stored film holds what AUTO was resolved to
  return stored.scene_key == snapshot.content_key && are_equivalent(stored.settings, settings) &&
         has_as_many(stored, FrameSamples::kFresh, settings);
}

}  // namespace

bool sequence_applies(const GradusSettings& settings, std::string* why_not) {
  const uint32_t r = settings.reconstruction;
  const uint64_t pixels = uint64_t(settings.width) * settings.height;
  // REGULARIZED joins samples of any kind. With AUTO, a user who chose plain samples expects the noisy image.
  const bool is_sampled_for_it =
      r == GRADUS_RECONSTRUCTION_REGULARIZED || render::can_sample_gradients(settings.integrator);
  const std::string integrator = schema::choice_name(*schema::find_option("integrator"), settings.integrator);
  *why_not = !is_sampled_for_it                ? "the integrator is " + integrator
             : r == GRADUS_RECONSTRUCTION_NONE ? "reconstruction is none"
             : settings.samples < 2            ? "there is one sample per pixel"
             : pixels > INT32_MAX              ? "the film has more than 2^31 - 1 pixels"
                                               : "";
  return why_not->empty();
}

Sequence::Sequence(std::shared_ptr<scene::Device> device, const SequenceSettings& settings,
                   render::IntegratorFactory factory)
    : device_(std::move(device)),
      settings_(settings),
      factory_(std::move(factory)),
      folder_(settings.folder),
      last_(settings.last) {
  if (settings.step < 1) throw invalid_argument("the step of a sequence must be at least 1");
  reconstruct::WindowGrid(job_places(), settings.windows);  // throws if the range or the windows are not valid
}

int Sequence::place_of(int32_t frame) const {
  const int64_t from_first = int64_t(frame) - settings_.first, step = settings_.step;
  if (from_first % step != 0) throw invalid_argument("frame " + std::to_string(frame) + " is not part of the sequence");
  const int64_t first = GRADUS_FAULT(window_grid_begins_at_job) ? 0 : settings_.first;
  return int(from_first / step + (first >= 0 ? first / step : -((step - 1 - first) / step)));
}

int32_t Sequence::frame_at(int place) const {
  return int32_t(settings_.first + (int64_t(place) - place_of(settings_.first)) * int64_t(settings_.step));
}

reconstruct::FrameRange Sequence::job_places() const {
  if (settings_.last < settings_.first) throw invalid_argument("a sequence ends before it begins");
  reconstruct::FrameRange range{place_of(settings_.first), 0};
  range.last = range.first + int((int64_t(settings_.last) - settings_.first) / settings_.step);
  return range;
}

void Sequence::warn_of_needs(const render::Plan& plan, std::vector<std::string>* warnings) {
  if (needs_are_checked_) return;
  needs_are_checked_ = true;
  const reconstruct::WindowShape& windows = settings_.windows;
  const int all = job_places().count(), at_a_time = std::min(all, 2 * windows.frames - windows.overlap);
  const std::string memory = render::memory_warning(render::estimated_memory(plan, windows), machine_memory_bytes());
  const std::string disk =
      render::disk_warning(render::estimated_files(plan, folder_.is_temporary() ? at_a_time : all), folder_.path());
  for (const std::string& warning : {memory, disk}) {
    if (!warning.empty()) warnings->push_back(warning);
  }
}

reconstruct::FrameRange Sequence::places_with_neighbours() const {
  reconstruct::FrameRange range = job_places();
  if (folder_.is_temporary()) return range;
  const int maximum = settings_.windows.frames;  // frames further away share no window with the job
  for (int i = 0; i < maximum && folder_.holds(frame_at(range.first - 1)); ++i) --range.first;
  for (int i = 0; i < maximum && last_ == settings_.last && folder_.holds(frame_at(range.last + 1)); ++i) ++range.last;
  return range;
}

const FrameTraits& Sequence::traits_at(int place) {
  const int32_t frame = frame_at(place);
  const auto known = traits_.find(frame);
  if (known != traits_.end()) return known->second;
  return traits_[frame] = read_with_advice([&] {
           return traits_of(folder_.header(frame, FrameSamples::kFresh),
                            folder_.header(frame, FrameSamples::kReplayed));
         });
}

bool Sequence::is_usable(int32_t frame) const {
  return !samples_ || records_.count(frame) > 0 || GRADUS_FAULT(windows_extend_over_skipped_frame);
}

bool Sequence::shares_window_with_previous(int place, uint32_t reconstruction) {
  if (!is_usable(frame_at(place)) || !is_usable(frame_at(place - 1))) return false;
  const FrameTraits &here = traits_at(place), &before = traits_at(place - 1);
  const reconstruct::FrameRange own = job_places();
  // Settings may be animated within a job.
  const bool one_job = own.contains(place) && own.contains(place - 1);
  return (one_job || GRADUS_FAULT(stored_neighbour_of_other_job_accepted) ||
          are_equivalent(before.settings, here.settings)) &&
         share_windows(before, here, reconstruction);
}

int Sequence::first_connected(int place, int begin, uint32_t reconstruction) {
  while (place > begin && shares_window_with_previous(place, reconstruction)) --place;
  return place;
}

int Sequence::last_connected(int place, int end, uint32_t reconstruction) {
  while (place < end && shares_window_with_previous(place + 1, reconstruction)) ++place;
  return place;
}

reconstruct::FrameRange Sequence::needs(const GradusSettings& settings) const {
  const reconstruct::FrameRange own = job_places();
  const int place = place_of(settings.frame);
  if (!own.contains(place))
    throw invalid_argument("frame " + std::to_string(settings.frame) + " is not part of the sequence");
  const reconstruct::FrameRange places = places_with_neighbours();
  const reconstruct::WindowGrid grid(places, settings_.windows);
  const uint32_t reconstruction =
      joins_frames(settings) ? uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED} : settings.reconstruction;
  const auto of_picture = [&](int other) {
    return frames_of_picture(grid, std::clamp(other, places.first, places.last), reconstruction);
  };
  // The flow of a frame is found between its picture and those of its neighbours.
  const int reach = settings_.with_flow && settings_.step == 1 ? 1 : 0;
  const int32_t last = frame_at(of_picture(place + reach).last);
  return {frame_at(of_picture(place - reach).first), last_ < settings_.last ? std::min(last, last_) : last};
}

int32_t Sequence::first_of_windows(int32_t frame) const {
  return frame_at(reconstruct::WindowGrid(job_places(), settings_.windows).around(place_of(frame)).first);
}

void Sequence::end_at(int32_t frame) {
  last_ = std::min(last_, frame);
  for (auto& [components, pictures] : pictures_) pictures->end_at(place_of(last_));
}

std::unique_ptr<render::RenderTask> Sequence::sample(std::shared_ptr<const scene::Snapshot> snapshot,
                                                     const GradusSettings& settings) {
  std::string why_not;
  if (!sequence_applies(settings, &why_not))
    throw invalid_argument("the frame cannot be reconstructed together with others: " + why_not);
  place_of(settings.frame);  // throws if the frame is not part of the sequence
  samples_ = true;
  if (before_ && int64_t{before_->settings.frame} + settings_.step != settings.frame) before_.reset();
  render::LoopInput input;
  input.device = device_;
  input.snapshot = std::move(snapshot);
  input.settings = settings;
  input.settings.integrator = integrator_of(settings);
  input.threads = output::threads_of(settings, device_.get());
  input.factory = factory_;
  input.samples_only = true;
  input.joins_frames = joins_frames(settings);
  return std::make_unique<FrameSampling>(shared_from_this(), std::move(input));
}

void Sequence::pass_by(std::shared_ptr<const scene::Snapshot> snapshot, const GradusSettings& settings) {
  GradusSettings resolved = settings;
  resolved.integrator = integrator_of(settings);
  samples_ = true;
  const StoredFrame found = stored_frame_of(*snapshot, resolved);
  auto before = make_previous_frame(std::move(snapshot), resolved, found.fresh ? &*found.fresh : nullptr);
  before->counts = found.counts;
  before_ = std::move(before);
}

Sequence::StoredFrame Sequence::stored_frame_of(const scene::Snapshot& snapshot, const GradusSettings& settings) const {
  StoredFrame found;
  if (!folder_.holds(settings.frame)) return found;
  try {
    const film::FilmHeader fresh = folder_.header(settings.frame, FrameSamples::kFresh);
    if (!is_frame_of(fresh, snapshot, settings)) return found;
    if (has_counts(settings)) {
      found.counts = film::samples_of_pixels(
          *folder_.load(settings.frame, FrameSamples::kFresh, film_io::StoredContent::kSamples));
    }
    found.fresh = fresh;
  } catch (const Error&) {
    return {};  // a damaged file
  }
  return found;
}

void Sequence::add_stale(int32_t frame, const std::string& why) {
  (is_in_job(frame) ? sampled_again_ : unused_neighbours_).add(frame, why);
}

void Sequence::warn_of_stale_frames(Warnings* warnings) {
  const auto step = int32_t(settings_.step);
  const StaleFrames again = std::exchange(sampled_again_, {}), unused = std::exchange(unused_neighbours_, {});
  if (!again.empty()) warnings->add(again.text("sampled again", step));
  if (!unused.empty()) warnings->add(unused.text("beside the rendered ones not used", step));
}

std::unique_ptr<render::RenderTask> Sequence::deliver(int32_t frame, const GradusSettings* settings) {
  return std::make_unique<FrameDelivery>(shared_from_this(), frame, settings);
}

LoadSamples Sequence::load_samples(FrameSamples kind, const std::vector<std::string>& components) const {
  return [this, kind, components](int place, const CancelCheck& cancel) {
    return read_with_advice([&] {
      if (components.size() == 1) return folder_.load_component(frame_at(place), kind, components[0], cancel);
      const std::shared_ptr<film::Film> film =
          folder_.load(frame_at(place), kind, film_io::StoredContent::kAll, cancel);
      film::select_components(components, film.get());
      return film;
    });
  };
}

void Sequence::merge(int32_t number, film::Film* fresh, const film::Film& replayed) const {
  if (!film::can_add(*fresh, replayed) ||
      schema::sampling_key(fresh->settings) != schema::sampling_key(replayed.settings)) {
    throw invalid_argument("stored film " + folder_.path(number, FrameSamples::kFresh) +
                           " and its replayed samples do not belong together");
  }
  if (!GRADUS_FAULT(passes_read_fresh_samples_alone)) film::add_sums(fresh, replayed);
  fresh->settings.samples += uint32_t(replayed.samples.total());
}

reconstruct::SequenceSource Sequence::source(const reconstruct::SequenceMethod& method,
                                             const std::vector<std::string>& components) const {
  const LoadSamples fresh = load_samples(FrameSamples::kFresh, components),
                    replayed = load_samples(FrameSamples::kReplayed, components);
  const auto spooled = std::make_shared<SpooledFrames>(fresh, replayed, TemporalContent{.halves = method.with_error});
  return {[spooled](const reconstruct::FrameRange& window, const CancelCheck& cancel) {
            return spooled->window(window.first, window.last, cancel);
          },
          [=, this](int place, const CancelCheck& cancel) {
            const int32_t frame = frame_at(place);
            std::shared_ptr<film::Film> film = fresh(place, cancel);
            if (folder_.header(frame, FrameSamples::kReplayed).samples.total() > 0)
              merge(frame, film.get(), *replayed(place, cancel));
            return film;
          },
          [=, this](int place, const CancelCheck& cancel) {
            const int32_t frame = frame_at(place);
            return reconstruct::FrameStep{folder_.header(frame, FrameSamples::kFresh).frame_number,
                                          read_with_advice([&] {
                                            return folder_.load(frame, FrameSamples::kReplayed,
                                                                film_io::StoredContent::kSamples, cancel);
                                          })->replayed.correspondence};
          }};
}

reconstruct::SequencePictures* Sequence::pictures(const std::vector<std::string>& components,
                                                  const reconstruct::SequenceMethod& method, int32_t frame) {
  const int place = place_of(frame);
  const auto known = pictures_.find(components);
  reconstruct::SequencePictures* pictures = known != pictures_.end() ? known->second.get() : nullptr;
  if (!pictures || !(pictures->method() == method) || !pictures->has(place)) {
    reconstruct::FrameRange places = places_with_neighbours();
    const reconstruct::WindowGrid grid(places, settings_.windows);
    const int begin = frames_of_picture(grid, place, method.reconstruction).first,
              first = first_connected(place, begin, method.reconstruction);
    if (first > begin) places.first = first;
    auto made =
        std::make_unique<reconstruct::SequencePictures>(places, settings_.windows, source(method, components), method);
    pictures = made.get();
    pictures_[components] = std::move(made);
    if (last_ < settings_.last) pictures->end_at(place_of(last_));
  }
  const int end = pictures->around(place).last, last = last_connected(place, end, method.reconstruction);
  if (last < end) pictures->end_at(last);
  return pictures;
}

double Sequence::joined_samples(int32_t frame) {
  return traits_at(place_of(frame)).fresh_samples * (2 * settings_.windows.reach() + 1);
}

void Sequence::retain_pictures(const std::vector<std::vector<std::string>>& groups) {
  std::erase_if(pictures_, [&](const auto& entry) {
    return std::find(groups.begin(), groups.end(), entry.first) == groups.end();
  });
}

output::FilmFacts Sequence::facts_of(int32_t frame) {
  const FrameTraits& traits = traits_at(place_of(frame));
  const auto record = records_.find(frame);
  output::FilmFacts facts;
  facts.sampled_for = record != records_.end() ? record->second.plan.reconstruction : traits.settings.reconstruction;
  facts.has_features = traits.features;
  facts.has_gradients = traits.gradients;
  return facts;
}

motion::Tracking Sequence::flows_to(int place, uint32_t reconstruction) {
  if (!settings_.with_flow || settings_.step != 1)
    return motion::Tracking::NoNeighbour;  // the motion of surfaces is known for a step of one frame
  const int32_t frame = frame_at(place);
  const bool is_expected = last_ == settings_.last || frame <= last_;
  if (!is_expected || !folder_.holds(frame) || !folder_.holds(frame - 1) ||
      !shares_window_with_previous(place, reconstruction))
    return motion::Tracking::NoNeighbour;
  const reconstruct::WindowGrid grid(places_with_neighbours(), settings_.windows);
  if (!folder_.holds(frame_at(frames_of_picture(grid, place - 1, reconstruction).first)))
    return motion::Tracking::NoNeighbour;  // the frame was delivered, and its files were removed
  const FrameTraits &before = traits_at(place - 1), &here = traits_at(place);
  return here.stream == before.stream || here.replayed_stream == before.stream ? motion::Tracking::Tracked
                                                                               : motion::Tracking::ShotChange;
}

const motion::FlowLibrary* Sequence::flow_library(std::vector<std::string>* warnings) {
  if (!flow_library_) {
    Warnings found;
    flow_library_ = motion::flow_library_or_warning(
        settings_.flow_folder.empty() ? motion::flow_library_folder() : settings_.flow_folder, &found);
    for (std::string text; found.take(&text);) warnings->push_back(text);
  }
  return flow_library_->get();
}

void Sequence::forget_before(int32_t frame) {
  while (!records_.empty() && records_.begin()->first < frame) {
    folder_.forget(records_.begin()->first);
    records_.erase(records_.begin());
  }
  traits_.erase(traits_.begin(), traits_.lower_bound(frame));
}

}  // namespace gradus::animation
