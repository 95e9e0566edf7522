#include "render/sequence/frame_sampling.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "settings/options.h"
#include "temporal/pixel_links.h"

namespace gradus {
namespace {

// Of a time limit; the other half takes as long, and the differences over time make it no shorter (contract 4.6).
constexpr float kBaseShareOfTime = 0.4f;

// Whether pixels may differ in their samples, which a replay then repeats.
bool has_counts(const GradusSettings& settings) { return settings.noise_threshold > 0.0f || settings.time_limit > 0.0f; }

uint32_t base_samples(uint32_t samples) { return samples - samples / 2; }

uint64_t key_without_frame(GradusSettings settings) {
  settings.frame = 0;
  return sampling_key(settings);
}

std::vector<uint32_t> samples_of(const Frame& frame) {
  std::vector<uint32_t> samples(frame.count[0].size());
  for (size_t i = 0; i < samples.size(); ++i) samples[i] = frame.count[0][i] + frame.count[1][i];
  return samples;
}

void require_same(const Frame& stored, const std::string& path, const GradusSettings& settings, uint64_t scene_key) {
  const auto refuse = [&](const std::string& why) {
    throw invalid_argument("stored frame " + path + " " + why + ": remove it, or choose another frame store");
  };
  if (sampling_key(stored.settings) != sampling_key(settings)) refuse("was sampled with other settings");
  if (stored.settings.passes != settings.passes) refuse("was sampled with other passes");
  if (!std::equal(stored.settings.region, stored.settings.region + 4, settings.region)) refuse("shows another region");
  if (stored.scene_key != scene_key) refuse("shows another scene");
}

}  // namespace

FrameSampling::FrameSampling(std::shared_ptr<Sequence> sequence, LoopInput input)
    : sequence_(std::move(sequence)), input_(std::move(input)), stored_base_(stored(FramePart::kBase)), base_(base_input()) {
  record_.plan = base_.plan();
  record_.plan.chosen.emplace_back("differences over time", "frames of an animation: half of the samples repeat those of the frame before");
}

LoopInput FrameSampling::base_input() const {
  LoopInput input = input_;
  input.settings.samples = base_samples(input.settings.samples);
  input.settings.time_limit *= kBaseShareOfTime;
  if (stored_base_ && !is_enough(*stored_base_, input.settings.samples)) input.resumed = stored_base_;
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
  p.memory_bytes = base.memory_bytes;
  if (!offset_) return p;
  const GradusProgress offset = offset_->progress();
  p.fraction += 0.5f * offset.fraction;
  p.samples_done += offset.samples_done;
  p.memory_bytes += offset.memory_bytes;
  return p;
}

std::string FrameSampling::stats() const {
  const std::lock_guard lock(mutex_);
  require_end("its stats come");
  if (!frame_) throw invalid_operation("the render failed: " + text_);
  return stats_json(record_.stats, record_.plan, *frame_);
}

std::shared_ptr<const Frame> FrameSampling::frame() const {
  const std::lock_guard lock(mutex_);
  require_end("its frame comes");
  if (!frame_) throw invalid_operation("the render failed: " + text_);
  return frame_;
}

void FrameSampling::render() {
  {
    const std::lock_guard lock(mutex_);
    phase_ = GRADUS_PHASE_SAMPLING;
  }
  if (!stored_base_ && repeats_before()) return repeat_before();
  sample_parts();
}

std::shared_ptr<const Frame> FrameSampling::stored(FramePart part) const {
  const SequenceFolder& folder = sequence_->folder_;
  const int32_t number = input_.settings.frame;
  if (!folder.holds(number)) return nullptr;
  std::shared_ptr<const Frame> frame = folder.load(number, part);
  GradusSettings settings = input_.settings;
  settings.frame = frame->frame_number;  // that of the first of several frames that are alike
  if (settings.integrator == GRADUS_INTEGRATOR_AUTO) settings.integrator = frame->settings.integrator;  // what it came to
  require_same(*frame, folder.path(number, part), settings, input_.snapshot->content_key);
  return frame;
}

// Where counts differ, a frame is whole or not there.
bool FrameSampling::is_enough(const Frame& frame, uint32_t samples) const {
  return has_counts(input_.settings) || frame.frame_number != input_.settings.frame || frame.settings.samples >= samples;
}

bool FrameSampling::repeats_before() const {
  const FrameBefore* before = sequence_->before_.get();
  const GradusSettings& now = input_.settings;
  return before && before->is_sampled && before->snapshot->content_key == input_.snapshot->content_key &&
         key_without_frame(before->settings) == key_without_frame(now) && before->settings.samples >= now.samples &&
         before->settings.noise_threshold <= now.noise_threshold && std::equal(now.region, now.region + 4, before->settings.region) &&
         before->settings.passes == now.passes;
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

void FrameSampling::save(const Frame& frame, FramePart part) const {
  tbb::task_arena(arena_size(input_.threads)).execute([&] { sequence_->folder_.save(frame, input_.settings.frame, part); });
}

void FrameSampling::repeat_before() {
  const FrameBefore& before = *sequence_->before_;
  sequence_->folder_.repeat(before.settings.frame, input_.settings.frame);
  record_.stats.stopped = "unchanged";
  finish(sequence_->folder_.load(input_.settings.frame, FramePart::kBase));
}

void FrameSampling::sample_parts() {
  std::shared_ptr<const Frame> base = stored_base_;
  const bool samples_base = !base || base_.resumes();
  if (samples_base) {
    run(&base_);
    base = base_.frame();
  }
  sample_offset(*base);
  if (samples_base) save(*base, FramePart::kBase);
  record_.stats.stopped = samples_base ? record_.stats.stopped : "stored";
  finish(base);
}

void FrameSampling::sample_offset(const Frame& base) {
  LoopInput input = input_;
  input.settings.samples /= 2;
  const std::shared_ptr<const Frame> found = stored(FramePart::kOffset);
  if (found && is_enough(*found, input.settings.samples)) return;
  input.resumed = found;
  input.replay = follow(base);
  const std::vector<uint32_t>& counts = input.replay->counts;
  if (!counts.empty()) input.settings.samples = *std::max_element(counts.begin(), counts.end());
  auto offset = std::make_unique<RenderLoop>(std::move(input));
  {
    const std::lock_guard lock(mutex_);
    offset_ = std::move(offset);
  }
  run(offset_.get());
  save(*offset_->frame(), FramePart::kOffset);
}

std::shared_ptr<const Replay> FrameSampling::follow(const Frame& base) const {
  auto replay = std::make_shared<Replay>();
  const size_t pixels = size_t(base.region.area());
  replay->sources = {input_.settings.frame, std::vector<int32_t>(pixels, kNoLink)};
  const bool counted = has_counts(input_.settings);
  const FrameBefore* before = sequence_->before_.get();
  const bool follows = before && before->settings.width == input_.settings.width && before->settings.height == input_.settings.height &&
                       !is_cut(before->snapshot->camera, input_.snapshot->camera) && (!counted || before->counts.size() == pixels);
  if (follows) {
    const auto camera = [&](const Snapshot& snapshot) { return Camera(snapshot.camera, input_.settings.width, input_.settings.height); };
    const Camera camera_before = camera(*before->snapshot), camera_now = camera(*input_.snapshot);
    tbb::task_arena(arena_size(input_.threads)).execute([&] {
      const auto from = view_centres(*before->snapshot, camera_before, base.region);
      const auto to = view_centres(*input_.snapshot, camera_now, base.region);
      replay->sources = {before->stream_frame, inverse_links(link_pixels(from, to))};
    });
  }
  if (counted) {
    const auto mean = uint32_t(std::max(1L, std::lround(mean_samples(base))));
    replay->counts.assign(pixels, mean);
    for (size_t i = 0; i < pixels; ++i) {
      const int32_t source = replay->sources.pixel[i];
      if (source != kNoLink) replay->counts[i] = before->counts[size_t(source)];
    }
  }
  return replay;
}

void FrameSampling::finish(const std::shared_ptr<const Frame>& base) {
  auto before = std::make_unique<FrameBefore>();
  before->snapshot = input_.snapshot;
  before->settings = input_.settings;
  before->stream_frame = base->frame_number;
  if (has_counts(input_.settings)) before->counts = samples_of(*base);
  sequence_->before_ = std::move(before);
  sequence_->records_[input_.settings.frame] = record_;
  const std::lock_guard lock(mutex_);
  frame_ = base;
}

}  // namespace gradus
