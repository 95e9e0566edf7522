#include "render/sequence/frame_sampling.h"

#include <algorithm>
#include <cmath>

#include "base/bill.h"
#include "base/error.h"
#include "render/sequence/halves.h"
#include "render/sequence/replay_plan.h"
#include "render/sequence/stored_half.h"
#include "settings/options.h"

namespace gradus {

FrameSampling::FrameSampling(std::shared_ptr<Sequence> sequence, LoopInput input)
    : sequence_(std::move(sequence)), input_(std::move(input)), stored_base_(stored_base()), base_(base_input()) {
  record_.plan = base_.plan();
  if (stored_base_ && record_.plan.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) {
    require_features(*stored_base_, sequence_->folder_.path(input_.settings.frame, FramePart::kBase));
  }
  record_.stats.planned = sequence_->plan_job(record_.plan, input_.settings, &record_.stats.warnings);
  record_.plan.chosen.emplace_back("differences over time", "frames of an animation: half of the samples repeat those of the frame before");
}

LoopInput FrameSampling::base_input() const {
  LoopInput input = input_;
  input.settings.samples = samples_of(FramePart::kBase, input.settings.samples);
  input.settings.time_limit *= kBaseShareOfTime;
  input.settings.noise_threshold *= kBaseShareOfThreshold;
  input.whole_samples = input_.settings.samples;
  return input;
}

void FrameSampling::cancel() {
  const std::lock_guard lock(mutex_);
  RenderTask::cancel();
  base_.cancel();
  if (offset_) offset_->cancel();
}

GradusProgress FrameSampling::progress() const {
  GradusProgress p = RenderTask::progress();
  const std::lock_guard lock(mutex_);
  if (is_ended()) return p;
  const GradusProgress base = base_.progress();
  p.fraction = 0.5f * base.fraction;
  p.samples_done = base.samples_done;
  p.version = base.version;
  p.memory_bytes = base.memory_bytes;
  if (!offset_) return p;
  const GradusProgress offset = offset_->progress();
  p.fraction += 0.5f * offset.fraction;
  p.samples_done += offset.samples_done;
  p.memory_bytes += offset.memory_bytes;
  return p;
}

std::string FrameSampling::stats() const {
  const std::shared_ptr<const Frame> half = own_half("its stats come");
  return stats_json(record_.stats, record_.plan, *half);  // the record does not change after the end
}

std::shared_ptr<const Frame> FrameSampling::frame() const { return own_half("its frame comes"); }

std::shared_ptr<const Frame> FrameSampling::own_half(const char* what) const {
  const std::lock_guard one_reader(reading_);
  bool is_stored = false;
  {
    const std::lock_guard lock(mutex_);
    require_end(what);
    is_stored = !frame_ && text_.empty();
  }
  // progress() and cancel() take the lock, so no file is read under it.
  std::shared_ptr<const Frame> half = is_stored ? read(FramePart::kBase, StoredContent::kAll, [] { return false; }) : nullptr;
  const std::lock_guard lock(mutex_);
  if (half) frame_ = std::move(half);
  require_frame(frame_, what, "the render failed: ");
  return frame_;
}

void FrameSampling::render() {
  {
    const std::lock_guard lock(mutex_);
    phase_ = GRADUS_PHASE_SAMPLING;
  }
  const bool repeats = repeats_before();
  const bool is_repeated = stored_base_ && repeats && stored_base_->frame_number == sequence_->before_->stream_frame;
  if (repeats && !is_repeated) return repeat_before();
  sample_parts();
}

std::optional<FrameHeader> FrameSampling::stored_base() const {
  std::optional<FrameHeader> base = stored(FramePart::kBase);
  const bool is_of_earlier = base && base->frame_number != input_.settings.frame;
  if (is_of_earlier && !stored(FramePart::kOffset)) return std::nullopt;  // of an earlier frame come both halves, or none
  return base;
}

bool FrameSampling::has_enough(const FrameHeader& half, FramePart part) const {
  // Counted offsets have what they have by their base.
  const bool follows_base = part == FramePart::kOffset && has_counts(half.settings);
  return follows_base || has_as_many(half, part, input_.settings);
}

std::optional<FrameHeader> FrameSampling::stored(FramePart part) const {
  const SequenceFolder& folder = sequence_->folder_;
  const int32_t number = input_.settings.frame;
  if (!folder.holds(number)) return std::nullopt;
  std::optional<FrameHeader> frame = read_or_name_the_way_out([&] { return folder.header(number, part); });
  // The file of an earlier frame that was as this one, and is no longer, or has too few samples: taken anew, or from that frame again.
  if (frame->frame_number != number && (!has_enough(*frame, part) || differs_from_before())) return std::nullopt;
  GradusSettings settings = input_.settings;
  settings.frame = frame->frame_number;  // that of the first of several frames that are alike
  if (settings.integrator == GRADUS_INTEGRATOR_AUTO) settings.integrator = frame->settings.integrator;  // what it came to
  require_same(*frame, part, folder.path(number, part), settings, input_.snapshot->content_key);
  return frame;
}

std::shared_ptr<Frame> FrameSampling::read(FramePart part, StoredContent content, const CancelTest& cancel) const {
  std::shared_ptr<Frame> frame;
  tbb::task_arena(arena_size(input_.threads)).execute([&] {
    frame = read_or_name_the_way_out([&] { return sequence_->folder_.load(input_.settings.frame, part, content, cancel); });
  });
  return frame;
}

std::shared_ptr<Frame> FrameSampling::load(FramePart part, StoredContent content) {
  const Bill bill(&record_.stats.seconds.store, &record_.stats.cpu_seconds.store);
  return read(part, content, [this] { return is_stopped(); });
}

bool FrameSampling::repeats_before() const {
  const FrameBefore* before = sequence_->before_.get();
  const GradusSettings& now = input_.settings;
  return before && before->sampled && before->snapshot->content_key == input_.snapshot->content_key && are_alike(before->settings, now) &&
         before->settings.samples >= now.samples && before->settings.noise_threshold <= now.noise_threshold;
}

bool FrameSampling::differs_from_before() const {
  const FrameBefore* before = sequence_->before_.get();
  return before && before->sampled && !repeats_before();
}

void FrameSampling::run(RenderLoop* loop) {
  stop_if_asked();
  loop->run();
  std::string text;
  const GradusError code = loop->outcome(&text);
  if (code != GRADUS_OK) throw Error(code, text);
  const std::string stopped = record_.stats.stopped;
  record_.stats.add(loop->what_it_took());
  record_.stats.stopped = stopped.empty() ? loop->what_it_took().stopped : stopped;
}

void FrameSampling::save(const Frame& frame, FramePart part) {
  const Bill bill(&record_.stats.seconds.store, &record_.stats.cpu_seconds.store);
  const CancelTest cancel = [this] { return is_stopped(); };
  tbb::task_arena(arena_size(input_.threads)).execute([&] { sequence_->folder_.save(frame, input_.settings.frame, part, cancel); });
}

void FrameSampling::repeat_before() {
  const FrameBefore& before = *sequence_->before_;
  sequence_->folder_.repeat(before.settings.frame, input_.settings.frame);
  record_.stats.stopped = "unchanged";
  finish(sequence_->folder_.header(input_.settings.frame, FramePart::kBase), before.counts);
}

void FrameSampling::go_on() {
  const std::shared_ptr<const Frame> stored_half = load(FramePart::kBase);
  resumed_mean_ = mean_samples(*stored_half);
  base_.resume(stored_half);
}

void FrameSampling::sample_parts() {
  const bool goes_on = stored_base_ && !has_as_many(*stored_base_, FramePart::kBase, input_.settings),
             samples_base = !stored_base_ || goes_on;
  if (goes_on) go_on();
  if (samples_base) run(&base_);
  const std::shared_ptr<const Frame> sampled = samples_base ? base_.frame() : nullptr;
  const FrameHeader base = sampled ? header_of(*sampled) : *stored_base_;
  std::vector<uint32_t> counts;
  if (has_counts(input_.settings)) counts = samples_of_pixels(sampled ? *sampled : *load(FramePart::kBase, StoredContent::kSamples));
  sample_offset(base, counts, samples_base);
  if (sampled) save(*sampled, FramePart::kBase);
  if (!sampled && !offset_) record_.stats.stopped = "stored";
  finish(base, std::move(counts));
  const std::lock_guard lock(mutex_);
  frame_ = sampled;
}

void FrameSampling::sample_offset(const FrameHeader& base, const std::vector<uint32_t>& base_counts, bool samples_base) {
  LoopInput input = input_;
  input.whole_samples = input.settings.samples;
  input.settings.samples = samples_of(FramePart::kOffset, input.settings.samples);
  std::optional<FrameHeader> found = stored(FramePart::kOffset);
  if (found && found->frame_number != base.frame_number) found.reset();
  if (found && base.frame_number != input_.settings.frame) return;  // both are those of the earlier frame
  if (found && !replays_before(*found)) found.reset();
  const bool counted = has_counts(input_.settings);
  if (found && !counted && has_as_many(*found, FramePart::kOffset, input_.settings)) return;
  if (found && !samples_base && input.settings.time_limit > 0.0f) return;  // as many as the time of its base allowed
  input.replay = follow(base, base_counts);
  const std::vector<uint32_t>& counts = input.replay->counts;
  if (found && counted && samples_of_pixels(*load(FramePart::kOffset, StoredContent::kSamples)) == counts) return;
  const bool may_go_on = found && !counted && !has_counts(found->settings);
  const std::shared_ptr<const Frame> stored_offset = may_go_on ? load(FramePart::kOffset) : nullptr;
  if (stored_offset && replays_same(stored_offset->replayed, input.replay->sources)) input.resumed = stored_offset;
  if (counted) input.settings.samples = *std::max_element(counts.begin(), counts.end());
  auto offset = std::make_unique<RenderLoop>(std::move(input));
  {
    const std::lock_guard lock(mutex_);
    offset_ = std::move(offset);
  }
  run(offset_.get());
  save(*offset_->frame(), FramePart::kOffset);
}

bool FrameSampling::follows_before() const { return follows(sequence_->before_.get(), *input_.snapshot, input_.settings); }

bool FrameSampling::replays_before(const FrameHeader& offset) const {
  const FrameBefore* before = sequence_->before_.get();
  if (!before) return true;
  if (!follows_before()) return offset.replayed_frame == input_.settings.frame;
  const bool shows_it = offset.replayed_key == 0 || offset.replayed_key == before->snapshot->content_key;
  return offset.replayed_frame == before->stream_frame && offset.replayed_seed == before->settings.seed && shows_it;
}

std::shared_ptr<const Replay> FrameSampling::follow(const FrameHeader& base, const std::vector<uint32_t>& counts) {
  auto replay = std::make_shared<Replay>();
  const GradusSettings& now = input_.settings;
  replay->sources = {now.frame, PixelLinks{std::vector<int32_t>(size_t(base.region.area()), kNoLink)}, base.scene_key, now.seed};
  const FrameBefore* before = sequence_->before_.get();
  if (follows_before()) {
    const Bill bill(&record_.stats.seconds.links, &record_.stats.cpu_seconds.links);
    tbb::task_arena(arena_size(input_.threads)).execute([&] {
      replay->sources =
          link_sources(*before, *input_.snapshot, input_.settings, record_.plan.components, base.region, [this] { return is_stopped(); });
      stop_if_asked();
    });
  }
  replay->components = replays_of_components(replay->sources);
  if (const uint64_t apart = replay->components.pixels; apart > 0) {
    const double share = 100.0 * double(apart) / double(base.region.area());
    record_.plan.chosen.emplace_back(
        "replays of components by themselves",
        "in " + std::to_string(std::lround(share)) + " % of the pixels what mirrors and glass show goes another way than they do");
  }
  if (!has_counts(input_.settings)) return replay;
  const double mean = mean_of(counts);
  const bool is_counted = before && before->sampled && *before->sampled == base.region;
  replay->counts = replayed_counts(replay->sources, is_counted ? before : nullptr, mean);
  const double seconds = base_.what_it_took().seconds.sample;
  if (input_.settings.time_limit > 0.0f && seconds > 0.0) {
    limit_mean((1.0 - kBaseShareOfTime) * input_.settings.time_limit / seconds * (mean - resumed_mean_), &replay->counts);
  }
  return replay;
}

void FrameSampling::finish(const FrameHeader& base, std::vector<uint32_t> counts) {
  auto before = make_before(input_.snapshot, input_.settings, &base);
  before->counts = std::move(counts);
  sequence_->before_ = std::move(before);
  record_.stats.total_seconds = seconds();
  record_.stats.process_cpu = process_cpu_seconds();
  sequence_->records_[input_.settings.frame] = record_;
  sequence_->forms_[input_.settings.frame] = form_of(base, sequence_->folder_.header(input_.settings.frame, FramePart::kOffset));
  GradusSettings delivered = input_.settings;
  delivered.reconstruction = record_.plan.reconstruction;
  delivered.denoiser = record_.plan.denoises ? GRADUS_DENOISER_OIDN : GRADUS_DENOISER_NONE;
  sequence_->folder_.save_settings(delivered, delivered.frame);
}

}  // namespace gradus
