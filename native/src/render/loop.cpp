#include "render/loop.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <cmath>

#include "base/device.h"
#include "base/fpu.h"
#include "frame/cells.h"
#include "frame/pass_planes.h"
#include "render/batches.h"
#include "render/combine.h"
#include "render/denoise_combined.h"
#include "render/pass_read.h"
#include "render/resume.h"
#include "settings/options.h"
#include "settings/pass_table.h"

namespace gradus {
namespace {

// How often a long batch says that there is something new to see.
constexpr int64_t kImageIntervalMs = 300;

// Of what is delivered after a cancel.
void read_error_of_noisy(const Frame& frame, const Region& region, float* pixels) {
  SolveReport report;
  std::vector<float> error;
  combine(
      frame, GRADUS_RECONSTRUCTION_NONE, 0.0f, region, [] { return false; }, &report, &error);
  std::copy(error.begin(), error.end(), pixels);
}

uint64_t rays_of(const Counters& c) { return c.rays_primary + c.rays_bounce + c.rays_shadow + c.rays_shift + c.rays_shift_shadow; }

}  // namespace

RenderLoop::RenderLoop(LoopInput input)
    : input_(std::move(input)),
      denoiser_(choose_denoiser(input_.settings.denoiser, input_.device.get(), &why_no_denoiser_)),
      plan_(make_plan(input_.settings, *input_.snapshot, {denoiser_ ? denoiser_->name() : "", why_no_denoiser_})),
      tiles_(make_cells(plan_.sampled, tile_side(plan_.sampled, input_.threads))),
      arena_(arena_size(input_.threads)),
      process_cpu_start_(process_cpu_nanoseconds()) {
  if (!input_.snapshot->has_camera) throw invalid_operation("the scene has no camera");
  const uint64_t bytes = planned_bytes(plan_), available = machine_memory_bytes();
  if (available > 0 && bytes > available) {
    throw Error(GRADUS_ERROR_OUT_OF_MEMORY, "the frame needs " + std::to_string(bytes >> 20) + " MiB, the machine has " +
                                                std::to_string(available >> 20) + " MiB: render fewer pixels or passes");
  }
  if (input_.resumed) check_resumable(*input_.resumed, input_.settings, plan_, input_.snapshot->content_key);
}

void RenderLoop::run() noexcept {
  try {
    const FlushDenormals flush;
    render();
    end(GRADUS_OK, "");
  } catch (const Error& e) {
    end(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    end(GRADUS_ERROR_OUT_OF_MEMORY, "out of memory while rendering");
  } catch (const std::exception& e) {
    end(GRADUS_ERROR_UNKNOWN, e.what());
  } catch (...) {
    end(GRADUS_ERROR_UNKNOWN, "unknown exception while rendering");
  }
}

void RenderLoop::render() {
  prepare();
  set_phase(GRADUS_PHASE_SAMPLING);
  sample();
  stats_.cpu_seconds.sample += 1e-9 * double(sample_cpu_.load());
  stats_.seconds.sample = clock_.seconds() - sampling_began_;
  if (stop_.load(std::memory_order_relaxed)) throw cancelled();
  set_phase(GRADUS_PHASE_RECONSTRUCTING);
  reconstruct_frame();
  if (plan_.denoises) denoise_frame();
  if (stop_.load(std::memory_order_relaxed)) throw cancelled();
}

IntegratorContext RenderLoop::integrator_context(const GradusSettings& settings) const {
  IntegratorContext context;
  context.snapshot = input_.snapshot;
  context.camera = Camera(input_.snapshot->camera, settings.width, settings.height);
  context.settings = settings;
  return context;
}

GradientMap RenderLoop::choose_gradients() {
  GradientMap map;
  map.share = plan_.gradients ? 1.0 : 0.0;
  if (!plan_.pilot) return map;
  const GradusSettings settings = pilot_settings(input_.settings);
  const uint64_t cpu = process_cpu_nanoseconds();
  const auto integrator = input_.factory(integrator_context(settings), plan_.integrator);
  arena_.execute([&] { map = run_pilot(*integrator, settings, plan_.reconstruction, plan_.sampled, plan_.channels, stop_); });
  stats_.cpu_seconds.sample += 1e-9 * double(process_cpu_nanoseconds() - cpu);
  // A pilot that was cut short has found nothing out.
  if (stop_.load(std::memory_order_relaxed)) throw cancelled();
  return map;
}

void RenderLoop::prepare() {
  const GradusSettings& settings = input_.settings;
  gradients_ = choose_gradients();
  const uint32_t integrator = gradients_.none() ? uint32_t{GRADUS_INTEGRATOR_PATH} : plan_.integrator;
  if (plan_.pilot) explain(gradients_, &stats_.chosen, &stats_.skipped);
  std::shared_ptr<Frame> frame;
  if (input_.resumed) {
    check_gradients(*input_.resumed, !gradients_.none());
    frame = std::make_shared<Frame>(*input_.resumed);
  } else {
    frame = std::make_shared<Frame>(settings.width, settings.height, plan_.sampled, plan_.channels, 1, !gradients_.none());
    frame->passes = make_pass_planes(plan_.passes, size_t(plan_.sampled.area()));
    if (wants(plan_.passes, GRADUS_PASS_FALLBACK)) frame->fallback.assign(size_t(plan_.sampled.area()), 0.0f);
  }
  if (frame->settings.noise_threshold != settings.noise_threshold) frame->shared.stopped.assign(frame->shared.stopped.size(), 0);
  frame->settings = settings;
  frame->settings.struct_size = sizeof(GradusSettings);
  // AUTO is resolved here, once: whoever reads the frame later must not decide again.
  frame->settings.integrator = integrator;
  frame->settings.reconstruction = gradients_.none() ? without_gradients(plan_) : plan_.reconstruction;
  frame->settings.denoiser = plan_.denoises ? GRADUS_DENOISER_OIDN : GRADUS_DENOISER_NONE;
  frame->scene_key = input_.snapshot->content_key;
  frame->frame_number = settings.frame;
  stats_.warnings = input_.snapshot->warnings;

  integrator_ = input_.factory(integrator_context(frame->settings), integrator);
  {
    const std::lock_guard lock(mutex_);
    frame_ = std::move(frame);
    combined_.assign(4 * size_t(plan_.delivered.area()), 0.0f);
  }
  if (input_.resumed) show(plan_.delivered);
}

bool RenderLoop::next_batch(uint32_t begin, uint32_t* end) const {
  if (stop_.load(std::memory_order_relaxed) || begin >= input_.settings.samples) return false;
  *end = std::min(batch_end(begin, input_.settings.samples), begin + affordable_samples(begin));
  return *end > begin;
}

// How many more samples per pixel the time limit allows, by the pace so far and rounded to the nearest: a render ends within half a sample
// of the limit. The first one is always taken.
uint32_t RenderLoop::affordable_samples(uint32_t begin) const {
  const double limit = input_.settings.time_limit;
  if (!(limit > 0.0)) return kLongestBatch;
  const uint32_t taken = begin - first_begin_;
  if (taken == 0) return 1;
  const double elapsed = std::max(clock_.seconds() - sampling_began_, 1e-9);
  return static_cast<uint32_t>(std::clamp((limit - elapsed) / elapsed * taken + 0.5, 0.0, double(kLongestBatch)));
}

void RenderLoop::judge() {
  const uint64_t cpu = process_cpu_nanoseconds();
  const CancelTest cancel = [this] { return stop_.load(std::memory_order_relaxed); };
  const uint32_t reconstruction = frame_->settings.reconstruction;
  std::vector<CellNoise> noise;
  arena_.execute(
      [&] { noise = estimate_noise(*frame_, adaptive_->cells(), reconstruction, input_.settings.reconstruction_alpha, cancel); });
  if (!cancel()) adaptive_->judge(noise);
  stats_.cpu_seconds.reconstruct += 1e-9 * double(process_cpu_nanoseconds() - cpu);
}

// In adaptive renders `begin` and `end` count the samples of pixels on average over the cells that go on.
void RenderLoop::sample() {
  sampling_began_ = clock_.seconds();
  const auto cancel = [this] { return stop_.load(std::memory_order_relaxed); };
  const bool adaptively = input_.settings.noise_threshold > 0.0f;  // a render that is too short to be so may go on as one that is
  uint32_t begin = input_.resumed ? resumed_samples(*input_.resumed, adaptively) : 0;
  const uint32_t first = input_.settings.first_sample;
  if (adaptively) adaptive_ = std::make_unique<AdaptiveSampling>(*frame_, input_.settings.noise_threshold, plan_.first_check);
  first_begin_ = begin;
  tracker_.set_samples(begin);
  work_done_ = uint64_t(begin) * uint64_t(plan_.sampled.area());
  for (uint32_t end = 0; next_batch(begin, &end); begin = end) {
    if (adaptive_ && begin >= kLongestBatch && (begin % kLongestBatch == 0 || begin == first_begin_)) judge();
    if (cancel() || is_done()) break;
    if (adaptive_) adaptive_->start_batch(end - begin);
    frame_->samples.add({first + begin, first + (adaptive_ ? adaptive_->most_taken() : end)});
    frame_->shared = {};
    run_batch(begin, end);
    if (cancel()) break;
    if (adaptive_) frame_->shared = adaptive_->state(end);
    tracker_.set_samples(end);
    tracker_.new_image();
  }
  stats_.stopped = cancel() ? "cancelled" : is_done() ? "noise" : begin < input_.settings.samples ? "time" : "samples";
  tracker_.raise_to(ProgressTracker::kSamplingShare);
}

void RenderLoop::run_batch(uint32_t begin, uint32_t end) {
  arena_.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, tiles_.size(), 1),
        [&](const tbb::blocked_range<size_t>& range) {
          for (size_t i = range.begin(); i < range.end(); ++i) sample_tile(i, begin, end);
        },
        tbb::simple_partitioner());
  });
}

void RenderLoop::sample_tile(size_t tile, uint32_t begin, uint32_t end) {
  if (stop_.load(std::memory_order_relaxed)) return;
  const FlushDenormals flush;
  WorkUnit unit;
  unit.tile = tiles_[tile];
  unit.first_sample = input_.settings.first_sample + begin;
  unit.count = end - begin;
  if (!gradients_.all() && !gradients_.none()) unit.gradient_map = &gradients_.pixels;
  Counters counters;
  const uint64_t cpu = thread_cpu_nanoseconds();
  if (adaptive_) {
    counters = sample_cells(unit);
  } else {
    integrator_->sample(unit, frame_.get(), &counters, stop_);
  }
  show(unit.tile);
  sample_cpu_ += thread_cpu_nanoseconds() - cpu;
  {
    const std::lock_guard lock(counters_mutex_);
    frame_->counters.add(counters);
  }
  tile_done(uint64_t(unit.tile.area()) * unit.count);
}

// Cell by cell, so that the cost of each is known.
Counters RenderLoop::sample_cells(WorkUnit unit) {
  unit.first_map = &adaptive_->batch().first;
  unit.count_map = &adaptive_->batch().count;
  Counters sum;
  for (const Region& cell : make_cells(unit.tile)) {
    unit.tile = cell;
    Counters counters;
    integrator_->sample(unit, frame_.get(), &counters, stop_);
    adaptive_->add_rays(cell, rays_of(counters));
    sum.add(counters);
  }
  return sum;
}

// What the tile has now becomes what is seen of it. Readers take the picture from here: they wait for no sampler, whose batch may take
// long, and see no half of one.
void RenderLoop::show(const Region& tile) {
  const Region &all = plan_.delivered, part = intersection(tile, all);
  if (part.width() <= 0 || part.height() <= 0) return;
  std::vector<float> rgba(4 * size_t(part.area()));
  read_frame_pass(*frame_, GRADUS_PASS_NOISY_IMAGE, part, rgba.data());
  const size_t row = 4 * size_t(part.width());
  const std::lock_guard lock(mutex_);
  for (int32_t y = part.y0; y < part.y1; ++y) {
    const size_t to = 4 * (size_t(y - all.y0) * size_t(all.width()) + size_t(part.x0 - all.x0));
    std::copy_n(rgba.data() + size_t(y - part.y0) * row, row, combined_.data() + to);
  }
}

void RenderLoop::tile_done(uint64_t pixel_samples) {
  const uint64_t done = work_done_ += pixel_samples;
  const double whole = double(plan_.sampled.area()) * input_.settings.samples;
  double fraction = double(done) / whole;
  const double now = clock_.seconds();
  if (input_.settings.time_limit > 0.0f) fraction = std::max(fraction, (now - sampling_began_) / input_.settings.time_limit);
  tracker_.raise_to(ProgressTracker::kSamplingShare * static_cast<float>(std::min(fraction, 1.0)));
  const auto ms = static_cast<int64_t>(1e3 * now);
  int64_t last = last_image_ms_.load(std::memory_order_relaxed);
  if (ms - last >= kImageIntervalMs && last_image_ms_.compare_exchange_strong(last, ms)) tracker_.new_image();
}

void RenderLoop::reconstruct_frame() {
  const double began = clock_.seconds();
  const uint64_t cpu = process_cpu_nanoseconds();
  const CancelTest cancel = [this] { return stop_.load(std::memory_order_relaxed); };
  const GradusSettings& settings = frame_->settings;
  std::vector<float> rgba, error;
  std::vector<float>* wanted = wants(plan_.passes, GRADUS_PASS_ERROR) ? &error : nullptr;
  arena_.execute([&] {
    rgba = combine(*frame_, settings.reconstruction, settings.reconstruction_alpha, plan_.delivered, cancel, &stats_.solve, wanted);
  });
  stats_.seconds.reconstruct = clock_.seconds() - began;
  stats_.cpu_seconds.reconstruct += 1e-9 * double(process_cpu_nanoseconds() - cpu);
  if (stats_.solve.hit_cap) stats_.warnings.push_back("the reconstruction stopped at its limit of steps");
  const std::lock_guard lock(mutex_);
  combined_ = std::move(rgba);
  error_ = std::move(error);
}

void RenderLoop::denoise_frame() {
  const double began = clock_.seconds();
  const uint64_t cpu = process_cpu_nanoseconds();
  const CancelTest cancel = [this] { return stop_.load(std::memory_order_relaxed); };
  std::vector<float> rgba = combined_;
  const std::string failure =
      denoise_combined(*denoiser_, *frame_, frame_->settings.reconstruction, plan_.delivered, input_.threads, cancel, &rgba);
  if (failure.empty()) {
    stats_.denoiser = denoiser_->name();
  } else {
    stats_.warnings.push_back(failure);
  }
  stats_.seconds.denoise = clock_.seconds() - began;
  stats_.cpu_seconds.denoise = 1e-9 * double(process_cpu_nanoseconds() - cpu);
  const std::lock_guard lock(mutex_);
  combined_ = std::move(rgba);
}

void RenderLoop::set_phase(GradusPhase phase) {
  const std::lock_guard lock(mutex_);
  phase_ = phase;
}

void RenderLoop::end(GradusError code, const std::string& text) noexcept {
  try {
    integrator_.reset();
    const std::lock_guard lock(mutex_);
    stats_.total_seconds = clock_.seconds();
    stats_.process_cpu = 1e-9 * double(process_cpu_nanoseconds() - process_cpu_start_);
    code_ = code;
    phase_ = code == GRADUS_OK ? GRADUS_PHASE_DONE : code == GRADUS_ERROR_CANCELLED ? GRADUS_PHASE_CANCELLED : GRADUS_PHASE_FAILED;
    if (code == GRADUS_OK) tracker_.raise_to(1.0f);
    tracker_.new_image();
    text_ = text;
  } catch (...) {  // only the text can fail; the phase is set
  }
  ended_.notify_all();
}

bool RenderLoop::wait(double seconds) const {
  std::unique_lock lock(mutex_);
  const auto ended = [this] { return is_ended(); };
  // Far beyond any render, and no overflow of the clock.
  if (!(seconds >= 0.0) || seconds > 1e8) {
    ended_.wait(lock, ended);
    return true;
  }
  return ended_.wait_for(lock, std::chrono::duration<double>(seconds), ended);
}

GradusProgress RenderLoop::progress() const {
  GradusProgress p{};
  p.struct_size = sizeof(p);
  p.seconds = static_cast<float>(clock_.seconds());
  p.samples_done = tracker_.samples();
  p.version = tracker_.version();
  p.fraction = tracker_.fraction();
  p.peak_memory_bytes = peak_memory_bytes();
  const std::lock_guard lock(mutex_);
  p.phase = phase_;
  if (is_ended()) {
    p.fraction = tracker_.fraction();
    p.seconds = static_cast<float>(stats_.total_seconds);
  }
  p.memory_bytes = (frame_ ? frame_->memory_bytes() : 0) + (combined_.size() + error_.size()) * sizeof(float);
  return p;
}

GradusError RenderLoop::outcome(std::string* text) const {
  const std::lock_guard lock(mutex_);
  if (!is_ended()) throw invalid_operation("the render is still running");
  if (text) *text = text_;
  return code_;
}

void RenderLoop::read_pass(uint32_t pass, float* pixels) const {
  const bool is_image = pass_info(pass).kind == PassKind::Image;
  std::shared_ptr<const Frame> frame;
  {
    const std::lock_guard lock(mutex_);
    if (is_sampling() && !is_image) throw invalid_operation("pass " + std::string(pass_info(pass).name) + " comes when sampling has ended");
    if (!combined_.empty() && (is_sampling() || pass == GRADUS_PASS_COMBINED)) {
      std::copy(combined_.begin(), combined_.end(), pixels);
      return;
    }
    if (pass == GRADUS_PASS_ERROR && !error_.empty()) {
      std::copy(error_.begin(), error_.end(), pixels);
      return;
    }
    frame = frame_;
  }
  if (frame && pass == GRADUS_PASS_ERROR && wants(plan_.passes, pass)) return read_error_of_noisy(*frame, plan_.delivered, pixels);
  if (frame) return read_frame_pass(*frame, pass, plan_.delivered, pixels);
  std::fill_n(pixels, size_t(plan_.delivered.area()) * pass_info(pass).channels, 0.0f);
}

std::string RenderLoop::stats() const {
  const std::lock_guard lock(mutex_);
  if (!is_ended()) throw invalid_operation("the render is still running: its stats come at the end");
  if (!frame_) throw invalid_operation("the render failed before it began: " + text_);
  return stats_json(stats_, plan_, *frame_);
}

std::shared_ptr<const Frame> RenderLoop::frame() const {
  const std::lock_guard lock(mutex_);
  if (!is_ended()) throw invalid_operation("the render is still running: its frame comes at the end");
  if (!frame_) throw invalid_operation("the render failed before it began: " + text_);
  return frame_;
}

}  // namespace gradus
