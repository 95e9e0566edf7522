#include "animation/frame_sampling.h"

#include <algorithm>
#include <cmath>

#include "animation/fresh_replayed_shares.h"
#include "animation/replay_plan.h"
#include "animation/stored_samples.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/fault.h"
#include "base/threads.h"
#include "scene/group_factors.h"
#include "schema/options.h"

namespace gradus::animation {

FrameSampling::FrameSampling(std::shared_ptr<Sequence> sequence, render::LoopInput input)
    : sequence_(std::move(sequence)), input_(std::move(input)), fresh_(fresh_input()) {
  record_.plan = fresh_.plan();
  sequence_->warn_of_needs(record_.plan, &record_.stats.warnings);
  const bool replays = takes_replays(input_.settings);
  record_.plan.chosen.emplace_back(
      replays ? "temporal gradients" : "regression over time",
      replays ? "frame of an animation: half of its samples replay those of the previous frame"
              : "frame of an animation: the frames around it contribute where they show the same light");
}

render::LoopInput FrameSampling::fresh_input() const {
  render::LoopInput input = input_;
  input.settings.samples = samples_of(FrameSamples::kFresh, input_.settings);
  input.settings.time_limit *= fresh_share_of_time(input_.settings);
  input.settings.noise_threshold *= fresh_share_of_threshold(input_.settings);
  input.whole_samples = input_.settings.samples;
  input.is_replayed = takes_replays(input_.settings);
  return input;
}

void FrameSampling::cancel() {
  const std::lock_guard lock(mutex_);
  render::RenderTask::cancel();
  fresh_.cancel();
  if (replayed_) replayed_->cancel();
}

GradusProgress FrameSampling::progress() const {
  GradusProgress p = render::RenderTask::progress();
  const std::lock_guard lock(mutex_);
  if (is_ended()) return p;
  const GradusProgress fresh = fresh_.progress();
  const float of_fresh = takes_replays(input_.settings) ? 0.5f : 1.0f;
  p.fraction = of_fresh * fresh.fraction;
  p.samples_done = fresh.samples_done;
  p.version = fresh.version;
  p.memory_bytes = fresh.memory_bytes;
  if (!replayed_) return p;
  const GradusProgress replayed = replayed_->progress();
  p.fraction += (1.0f - of_fresh) * replayed.fraction;
  p.samples_done += replayed.samples_done;
  p.memory_bytes += replayed.memory_bytes;
  return p;
}

std::string FrameSampling::stats() const {
  const std::shared_ptr<const film::Film> film = fresh_film("its stats come");
  return render::stats_json(record_.stats, record_.plan, *film);  // the record does not change after the end
}

std::shared_ptr<const film::Film> FrameSampling::film() const { return fresh_film("its film comes"); }

std::shared_ptr<const film::Film> FrameSampling::fresh_film(const char* what) const {
  const std::lock_guard one_reader(reading_);
  bool is_stored = false;
  {
    const std::lock_guard lock(mutex_);
    require_end(what);
    is_stored = !film_ && text_.empty();
  }
  // progress() and cancel() take the lock, so no file is read under it.
  std::shared_ptr<const film::Film> film =
      is_stored ? read(FrameSamples::kFresh, film_io::StoredContent::kAll, [] { return false; }) : nullptr;
  const std::lock_guard lock(mutex_);
  if (film) film_ = std::move(film);
  require_film(film_, what, "the render failed: ");
  return film_;
}

void FrameSampling::render() {
  {
    const std::lock_guard lock(mutex_);
    phase_ = GRADUS_PHASE_SAMPLING;
  }
  find_stored();
  if (!is_in_job() && !stored_fresh_) {
    sequence_->before_ = make_previous_frame(input_.snapshot, input_.settings, nullptr);
    return;
  }
  const bool repeats = is_in_job() && repeats_before();
  const bool is_repeated = stored_fresh_ && repeats && stored_fresh_->frame_number == sequence_->before_->stream_frame;
  if (repeats && !is_repeated) return repeat_before();
  sample_fresh_and_replayed();
}

void FrameSampling::find_stored() {
  if (!sequence_->folder_.holds(input_.settings.frame)) return;
  stored_fresh_ = find_stored(FrameSamples::kFresh);
  if (stored_fresh_) stored_replayed_ = find_stored(FrameSamples::kReplayed);
  // Fresh and replayed samples are both taken from an earlier frame, or neither.
  const bool is_of_earlier = stored_fresh_ && stored_fresh_->frame_number != input_.settings.frame;
  if (is_of_earlier && !stored_replayed_) stored_fresh_.reset();
}

bool FrameSampling::has_enough(const film::FilmHeader& header, FrameSamples kind) const {
  // With different numbers of samples per pixel, the replayed samples repeat the counts of the fresh ones.
  const bool follows_fresh = kind == FrameSamples::kReplayed && has_counts(header.settings);
  return follows_fresh || has_as_many(header, kind, input_.settings);
}

std::optional<film::FilmHeader> FrameSampling::find_stored(FrameSamples kind) {
  const int32_t number = input_.settings.frame;
  try {
    const film::FilmHeader header = sequence_->folder_.header(number, kind);
    // The file may be that of an earlier frame that was identical. If the file has too few samples, the frame is
    // sampled by itself or repeats the earlier frame again.
    if (header.frame_number != number && is_in_job() && !has_enough(header, kind)) return std::nullopt;
    const std::string why = difference_of(header, kind);
    if (!why.empty()) {
      sequence_->add_stale(number, why);
      return std::nullopt;
    }
    check(kind);  // so that a damaged file is found while the frame can still be sampled
    return header;
  } catch (const Error& e) {
    if (e.code() == GRADUS_ERROR_CANCELLED) throw;
    sequence_->add_stale(number, e.what());
    return std::nullopt;
  }
}

std::string FrameSampling::difference_of(const film::FilmHeader& header, FrameSamples kind) const {
  const int32_t number = header.frame_number;  // that of the first one of a series of identical frames
  if (number != input_.settings.frame && differs_from_before())
    return "samples of frame " + std::to_string(number) + ", which shows something else";
  GradusSettings settings = input_.settings;
  settings.frame = number;
  if (settings.integrator == GRADUS_INTEGRATOR_AUTO)
    settings.integrator = header.settings.integrator;  // the stored film holds what AUTO was resolved to
  return difference(header, kind, settings, input_.snapshot->content_key);
}

std::shared_ptr<film::Film> FrameSampling::read(FrameSamples kind, film_io::StoredContent content,
                                                const CancelCheck& cancel) const {
  std::shared_ptr<film::Film> film;
  tbb::task_arena(arena_size(input_.threads)).execute([&] {
    film = sequence_->folder_.load(input_.settings.frame, kind, content, cancel);
  });
  return film;
}

void FrameSampling::check(FrameSamples kind) {
  const ScopedTimer timer(&record_.stats.seconds.store, &record_.stats.cpu_seconds.store);
  tbb::task_arena(arena_size(input_.threads)).execute([&] {
    sequence_->folder_.check(input_.settings.frame, kind, [this] { return is_stopped(); });
  });
}

std::shared_ptr<film::Film> FrameSampling::load(FrameSamples kind, film_io::StoredContent content) {
  const ScopedTimer timer(&record_.stats.seconds.store, &record_.stats.cpu_seconds.store);
  return read(kind, content, [this] { return is_stopped(); });
}

bool FrameSampling::repeats_before() const {
  const PreviousFrame* before = sequence_->before_.get();
  const GradusSettings& now = input_.settings;
  return before && before->sampled && before->snapshot->content_key == input_.snapshot->content_key &&
         are_equivalent(before->settings, now) && before->settings.samples >= now.samples &&
         before->settings.noise_threshold <= now.noise_threshold;
}

bool FrameSampling::differs_from_before() const {
  const PreviousFrame* before = sequence_->before_.get();
  return before && before->sampled && !repeats_before();
}

void FrameSampling::run(render::RenderLoop* loop) {
  check_cancelled();
  loop->run();
  std::string text;
  const GradusError code = loop->outcome(&text);
  if (code != GRADUS_OK) throw Error(code, text);
  const std::string stopped = record_.stats.stopped;
  record_.stats.add(loop->what_it_took());
  record_.stats.stopped = stopped.empty() ? loop->what_it_took().stopped : stopped;
}

void FrameSampling::save(const film::Film& film, FrameSamples kind) {
  const ScopedTimer timer(&record_.stats.seconds.store, &record_.stats.cpu_seconds.store);
  const CancelCheck cancel = [this] { return is_stopped(); };
  tbb::task_arena(arena_size(input_.threads)).execute([&] {
    sequence_->folder_.save(film, input_.settings.frame, kind, cancel);
  });
}

void FrameSampling::repeat_before() {
  const PreviousFrame& before = *sequence_->before_;
  sequence_->folder_.repeat(before.settings.frame, input_.settings.frame);
  record_.stats.stopped = "unchanged";
  finish(sequence_->folder_.header(input_.settings.frame, FrameSamples::kFresh), before.counts);
}

void FrameSampling::resume_samples() {
  const std::shared_ptr<const film::Film> stored_film = load(FrameSamples::kFresh);
  resumed_mean_ = film::mean_samples(*stored_film);
  fresh_.resume(stored_film);
}

void FrameSampling::sample_fresh_and_replayed() {
  const bool continues = stored_fresh_ && is_in_job() && !GRADUS_FAULT(stored_frame_with_few_samples_accepted) &&
                         !has_as_many(*stored_fresh_, FrameSamples::kFresh, input_.settings),
             samples_fresh = !stored_fresh_ || continues;
  if (continues) resume_samples();
  if (samples_fresh) run(&fresh_);
  const std::shared_ptr<const film::Film> sampled = samples_fresh ? fresh_.film() : nullptr;
  const film::FilmHeader fresh = sampled ? film::header_of(*sampled) : *stored_fresh_;
  std::vector<uint32_t> counts;
  if (has_counts(input_.settings))
    counts =
        film::samples_of_pixels(sampled ? *sampled : *load(FrameSamples::kFresh, film_io::StoredContent::kSamples));
  sample_replayed(fresh, counts, samples_fresh);
  if (sampled) save(*sampled, FrameSamples::kFresh);
  if (!sampled && !replayed_) record_.stats.stopped = "stored";
  finish(fresh, std::move(counts));
  const std::lock_guard lock(mutex_);
  film_ = sampled;
}

void FrameSampling::sample_replayed(const film::FilmHeader& fresh, const std::vector<uint32_t>& fresh_counts,
                                    bool samples_fresh) {
  render::LoopInput input = input_;
  input.whole_samples = input.settings.samples;
  if (takes_replays(input_.settings)) input.settings.samples = samples_of(FrameSamples::kReplayed, input_.settings);
  std::optional<film::FilmHeader> found = stored_replayed_;
  if (found && found->frame_number != fresh.frame_number) found.reset();
  if (found && fresh.frame_number != input_.settings.frame) return;  // both files are those of the earlier frame
  if (found && !replays_before(*found)) found.reset();
  const bool counted = has_counts(input_.settings) && takes_replays(input_.settings);
  if (found && !counted && has_as_many(*found, FrameSamples::kReplayed, input_.settings)) return;
  // With a time limit, the stored replay has as many samples as the time of the fresh samples allowed.
  if (found && !samples_fresh && input.settings.time_limit > 0.0f) return;
  input.replay = follow(fresh, fresh_counts);
  if (follows_before()) input.snapshot = scene::with_factors_of(*sequence_->before_->snapshot, input.snapshot);
  const std::vector<uint32_t>& counts = input.replay->counts;
  if (found && counted &&
      film::samples_of_pixels(*load(FrameSamples::kReplayed, film_io::StoredContent::kSamples)) == counts)
    return;
  const bool may_resume = found && !counted && !has_counts(found->settings);
  const std::shared_ptr<const film::Film> stored_replayed = may_resume ? load(FrameSamples::kReplayed) : nullptr;
  if (stored_replayed && film::replays_same(stored_replayed->replayed, input.replay->replay_map))
    input.resumed = stored_replayed;
  if (counted) input.settings.samples = *std::max_element(counts.begin(), counts.end());
  auto replayed = std::make_unique<render::RenderLoop>(std::move(input));
  {
    const std::lock_guard lock(mutex_);
    replayed_ = std::move(replayed);
  }
  run(replayed_.get());
  save(*replayed_->film(), FrameSamples::kReplayed);
}

bool FrameSampling::follows_before() const {
  return follows(sequence_->before_.get(), *input_.snapshot, input_.settings);
}

bool FrameSampling::replays_before(const film::FilmHeader& replayed) const {
  const PreviousFrame* before = sequence_->before_.get();
  if (!before) return true;
  if (!follows_before()) return replayed.replayed_frame == input_.settings.frame;
  const bool shows_it = replayed.replayed_key == 0 || replayed.replayed_key == before->snapshot->content_key;
  return replayed.replayed_frame == before->stream_frame && replayed.replayed_seed == before->settings.seed &&
         replayed.replayed_net_samples == before->net_samples && shows_it;
}

std::shared_ptr<const render::Replay> FrameSampling::follow(const film::FilmHeader& fresh,
                                                            const std::vector<uint32_t>& counts) {
  auto replay = std::make_shared<render::Replay>();
  const GradusSettings& now = input_.settings;
  replay->replay_map = {
      now.frame, film::PixelCorrespondence{std::vector<int32_t>(size_t(fresh.region.area()), film::kNoCorrespondence)},
      fresh.scene_key, now.seed};
  const PreviousFrame* before = sequence_->before_.get();
  if (follows_before()) {
    const ScopedTimer timer(&record_.stats.seconds.correspondence, &record_.stats.cpu_seconds.correspondence);
    tbb::task_arena(arena_size(input_.threads)).execute([&] {
      const CancelCheck cancel = [this] { return is_stopped(); };
      centres_ = std::make_shared<const motion::CentreView>(
          motion::view_centres(*input_.snapshot, now.width, now.height, fresh.region, cancel));
      replay->replay_map = make_replay_map(*before, *centres_, now, record_.plan.components, fresh, cancel);
      check_cancelled();
    });
  }
  replay->components = render::replays_of_components(replay->replay_map);
  if (const uint64_t apart = replay->components.pixels; apart > 0 && takes_replays(now)) {
    const double share = 100.0 * double(apart) / double(fresh.region.area());
    record_.plan.chosen.emplace_back("separate replays of components",
                                     "in " + std::to_string(std::lround(share)) +
                                         " % of the pixels, reflections or refractions move differently from surfaces");
  }
  replay->takes_samples = takes_replays(now);
  if (!replay->takes_samples || !has_counts(now)) return replay;
  const double mean = mean_of(counts);
  const bool is_counted = before && before->sampled && *before->sampled == fresh.region;
  replay->counts = replayed_counts(replay->replay_map, is_counted ? before : nullptr, mean);
  const double seconds = fresh_.what_it_took().seconds.sample;
  if (input_.settings.time_limit > 0.0f && seconds > 0.0) {
    limit_mean((1.0 - fresh_share_of_time(now)) * input_.settings.time_limit / seconds * (mean - resumed_mean_),
               &replay->counts);
  }
  return replay;
}

void FrameSampling::finish(const film::FilmHeader& fresh, std::vector<uint32_t> counts) {
  auto before = make_previous_frame(input_.snapshot, input_.settings, &fresh);
  before->counts = std::move(counts);
  before->centres = std::move(centres_);
  if (!has_enough(fresh, FrameSamples::kFresh)) before->sampled.reset();  // no other frame may share its samples
  sequence_->before_ = std::move(before);
  record_.stats.total_seconds = seconds();
  record_.stats.process_cpu = process_cpu_seconds();
  sequence_->records_[input_.settings.frame] = record_;
  sequence_->traits_[input_.settings.frame] =
      traits_of(fresh, sequence_->folder_.header(input_.settings.frame, FrameSamples::kReplayed));
  if (!is_in_job()) return;  // the settings for delivery are those of the job that rendered the frame
  GradusSettings delivered = input_.settings;
  delivered.reconstruction = record_.plan.reconstruction;
  delivered.denoiser = render::stored_denoiser(record_.plan);
  sequence_->folder_.save_settings(delivered, delivered.frame);
}

}  // namespace gradus::animation
