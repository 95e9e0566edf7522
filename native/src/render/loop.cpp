#include "render/loop.h"

#include <cmath>

#include "base/clock.h"
#include "base/error.h"
#include "base/fault.h"
#include "base/threads.h"
#include "film/film.h"
#include "motion/component_motion.h"
#include "output/denoise_combined.h"
#include "output/developer.h"
#include "render/batches.h"
#include "render/develop.h"
#include "render/edge_sampling.h"
#include "render/guiding.h"
#include "render/memory_estimate.h"
#include "render/resume.h"
#include "render/small_components.h"
#include "render/tiles.h"
#include "scene/device.h"
#include "schema/pass_table.h"
#include "shading/faulty_materials.h"
#include "shading/material.h"

namespace gradus::render {
namespace {

// Minimum time between two notifications of a new image during a long batch.
constexpr int64_t kImageIntervalMs = 300;

// Copies the names and expressions of the components into the film.
void name_planes(const lpe::ComponentSet& set, film::Film* film) {
  for (int c = 0; c < set.count(); ++c) {
    film->components[size_t(c)].name = set[c].name;
    film->components[size_t(c)].expression = set[c].expression;
  }
}

// Returns the plan of the render. A frame of an animation keeps all components, because a component that is small in
// one frame may not be small in the next.
Plan planned(const LoopInput& input, const HostDenoiser& denoiser) {
  Plan plan = make_plan(input.planned_settings(), *input.snapshot, denoiser, input.joins_frames);
  if (!plan.merges_components || !input.samples_only) return plan;
  plan.merges_components = false;
  plan.skipped.emplace_back("merging of small components",
                            "a component that is small in one frame of an animation may not be small in the next");
  return plan;
}

// Throws `unsupported` if the setting `strict` is on and something of the scene was left out or replaced.
void refuse_warnings(const LoopInput& input) {
  const std::vector<std::string>& warnings = input.snapshot->warnings;
  if (!input.settings.strict || warnings.empty()) return;
  const size_t others = warnings.size() - 1;
  throw unsupported("strict: " + warnings[0] +
                    (others > 0 ? " (and " + std::to_string(others) + " other warnings)" : ""));
}

// Returns a warning about the materials of which rays have met values that are not finite, or "" without any.
std::string fault_warning(const scene::Snapshot& snapshot) {
  if (!snapshot.faulty_materials) return "";
  std::vector<std::string> names;
  for (uint32_t i = 0; i < snapshot.faulty_materials->size(); ++i)
    if (snapshot.faulty_materials->contains(i)) names.push_back(snapshot.materials[i]->name);
  if (names.empty()) return "";
  const std::string others = names.size() > 1 ? " (and " + std::to_string(names.size() - 1) + " other materials)" : "";
  return "light, closures or bumps of '" + names[0] + "'" + others + " were left out where they are not finite";
}

// Further samples at edges over usual ones, as the progress expects them.
constexpr double kUsualShareAtEdges = 0.25;
// Number of samples from which every pixel has samples in both half-buffers, which the reconstruction needs.
constexpr uint32_t kBothHalves = 2;

}  // namespace

std::unique_ptr<integrator::Integrator> LoopInput::make_integrator(const GradusSettings& its_settings,
                                                                   uint32_t integrator,
                                                                   lpe::ComponentSet components) const {
  integrator::IntegratorContext context;
  context.snapshot = snapshot;
  context.camera = camera::Camera(snapshot->camera, its_settings.width, its_settings.height);
  context.settings = its_settings;
  context.components = std::move(components);
  return factory(context, integrator);
}

RenderLoop::RenderLoop(LoopInput input)
    : input_(std::move(input)),
      denoiser_(output::choose_denoiser(input_.settings.denoiser, input_.device.get(), &why_no_denoiser_)),
      plan_(planned(input_, {denoiser_ ? denoiser_->name() : "", why_no_denoiser_})),
      arena_(arena_size(input_.threads)),
      picture_(plan_.delivered, input_.threads),
      live_view_(input_, plan_, stop_, &arena_, &picture_, &tracker_) {
  if (!input_.snapshot->has_camera) throw invalid_operation("the scene has no camera");
  refuse_warnings(input_);
  stats_.threads = static_cast<uint32_t>(arena_.max_concurrency());
  if (input_.resumed) resume(input_.resumed);
}

void RenderLoop::resume(std::shared_ptr<const film::Film> film) {
  check_resumable(*film, input_.settings, plan_, input_.snapshot->content_key);
  input_.resumed = std::move(film);
}

void RenderLoop::render() {
  prepare();
  set_phase(GRADUS_PHASE_SAMPLING);
  sample();
  check_cancelled();
  if (plan_.component_motion && !input_.replay) find_motion();
  if (input_.samples_only) return;
  const bool denoises = denoises_after(plan_, film::mean_samples(*film_), &stats_.chosen, &stats_.skipped);
  film_->settings.denoiser = denoises ? GRADUS_DENOISER_OIDN : GRADUS_DENOISER_NONE;
  set_phase(GRADUS_PHASE_RECONSTRUCTING);
  develop_film(denoises);
}

// The preview is requested for the reconstruction without gradients, because the pilot may find that no gradients are
// used.
bool RenderLoop::quarter_is_due() const {
  return !input_.resumed && live_view_.quarter_is_due(without_gradients(plan_));
}

void RenderLoop::learn_guide() {
  const GradusSettings& settings = input_.settings;
  std::string why_not = input_.meets_replays() ? "samples are replayed in other frames" : "";
  uint32_t samples = net_samples() > 0 ? net_samples() : settings.samples;
  if (settings.noise_threshold > 0.0f) samples = std::min(samples, plan_.first_check);  // all blocks may stop there
  const uint32_t paths = guide_paths(settings, samples, plan_.delivered, &why_not);
  if (paths == 0) {
    stats_.skipped.emplace_back("path guiding", why_not);
    return;
  }
  if (quarter_is_due()) live_view_.show_quarter();
  const integrator::IntegratorContext context{
      input_.snapshot, camera::Camera(input_.snapshot->camera, settings.width, settings.height), settings};
  std::atomic<uint64_t> cpu{0};
  integrator::GuideTraining training;
  arena_.execute([&] { training = integrator::train_guide(context, paths, stop_, &cpu); });
  stats_.cpu_seconds.sample += 1e-9 * double(cpu.load());
  check_cancelled();
  explain(training, &stats_.chosen, &stats_.skipped);
  if (training.pays) input_.snapshot = integrator::guided_snapshot(*input_.snapshot, training.field);
}

GradientMap RenderLoop::choose_gradients() {
  GradientMap map;
  map.share = plan_.gradients ? 1.0 : 0.0;
  if (!plan_.pilot) return map;
  const GradusSettings settings = pilot_settings(input_.settings);
  Interruption quarter;
  quarter.is_due = [this] { return quarter_is_due(); };
  quarter.run = [this] { live_view_.show_quarter(); };
  const auto integrator = input_.make_integrator(settings, plan_.integrator);
  arena_.execute([&] {
    map = run_pilot(*integrator, settings, plan_.reconstruction, plan_.sampled, plan_.channels, stop_, quarter);
  });
  stats_.cpu_seconds.sample += map.cpu_seconds;
  // The result of a cancelled pilot is not usable.
  check_cancelled();
  return map;
}

lpe::ComponentSet RenderLoop::choose_components() {
  if (!plan_.merges_components) return plan_.components;
  if (input_.resumed) return resumed_components(*input_.resumed, plan_);
  const GradusSettings settings = pilot_settings(input_.settings);
  const auto integrator = input_.make_integrator(settings, GRADUS_INTEGRATOR_PATH, plan_.components);
  SmallComponents small;
  arena_.execute(
      [&] { small = find_small_components(*integrator, settings, plan_.components, plan_.channels, stop_); });
  stats_.cpu_seconds.sample += small.cpu_seconds;
  check_cancelled();
  explain(small, plan_.components, &stats_.skipped);
  return plan_.components.merged(small.bits);
}

void RenderLoop::prepare() {
  const GradusSettings& settings = input_.settings;
  if (GRADUS_FAULT(library_leaks_memory)) std::fill_n(new char[1 << 20], 1 << 20, char(1));
  gradients_ = choose_gradients();
  components_ = choose_components();
  learn_guide();  // behind the choices above, which do not depend on the number of samples
  const bool has_lost_gradients = plan_.gradients && gradients_.none();
  const uint32_t integrator = has_lost_gradients ? uint32_t{GRADUS_INTEGRATOR_PATH} : plan_.integrator;
  if (plan_.pilot) explain(gradients_, &stats_.chosen, &stats_.skipped);
  std::shared_ptr<film::Film> film;
  if (input_.resumed) {
    check_gradients(*input_.resumed, !gradients_.none());
    film = std::make_shared<film::Film>(*input_.resumed);
  } else {
    film = std::make_shared<film::Film>(settings.width, settings.height, plan_.sampled, plan_.channels,
                                        components_.count(), !gradients_.none());
    name_planes(components_, film.get());
    const bool motion = plan_.component_motion && !input_.replay;
    film::allocate_component_content(
        {plan_.non_specular_vertices, plan_.non_specular_details, motion, motion && input_.samples_only}, film.get());
    film::add_pass_channels(plan_.passes, film.get());
    for (const film::ChannelInfo& info : plan_.scene_channels) film->channels.add(info, size_t(film->region.area()));
  }
  if (film->settings.noise_threshold != settings.noise_threshold)
    film->shared.stopped.assign(film->shared.stopped.size(), 0);
  film->settings = settings;
  film->settings.struct_size = sizeof(GradusSettings);
  film->settings.net_samples = net_samples();
  // The film stores the choices made for AUTO, so that its later readers do not choose again.
  film->settings.integrator = integrator;
  film->settings.reconstruction = gradients_.none() ? without_gradients(plan_) : plan_.reconstruction;
  film->settings.denoiser = stored_denoiser(plan_);
  film->scene_key = input_.snapshot->content_key;
  film->frame_number = settings.frame;
  film->view_rotation = camera::Camera(input_.snapshot->camera, film->full_width, film->full_height).view_rotation();
  if (input_.replay) film->replayed = input_.replay->replay_map;
  stats_.warnings = input_.snapshot->warnings;
  for (const std::string& text : input_.snapshot->noise_warnings) stats_.warnings.push_back(text);
  const std::string warning = memory_warning(estimated_memory(plan_), machine_memory_bytes());
  // an animation checks the memory of all its frames itself
  if (!warning.empty() && !input_.samples_only) stats_.warnings.push_back(warning);

  integrator_ = input_.make_integrator(film->settings, integrator, components_);
  picture_.expect_tiles();
  if (input_.resumed) picture_.show_tile(*film, plan_.delivered);
  const std::lock_guard lock(mutex_);
  film_ = std::move(film);
}

// A film keeps the nets of its first samples; those of earlier versions have none. Samples that are replayed have none
// either, so that the frames of a sequence need not have as many samples to replay each other.
uint32_t RenderLoop::net_samples() const {
  if (input_.resumed) return input_.resumed->settings.net_samples;
  if (input_.meets_replays()) return 0;
  return input_.settings.net_samples > 0 ? input_.settings.net_samples : input_.settings.samples;
}

bool RenderLoop::next_batch(uint32_t begin, uint32_t* end) const {
  if (is_stopped() || begin >= input_.settings.samples || (input_.replay && !input_.replay->takes_samples))
    return false;
  *end = std::min(batch_end(begin, input_.settings.samples), begin + affordable_samples(begin));
  if (input_.replay && !input_.replay->counts.empty())
    *end = input_.settings.samples;  // the number of replayed samples differs between pixels
  return *end > begin;
}

// Returns how many more samples per pixel the time limit allows, at the mean speed so far and rounded to the nearest
// integer: a render ends within half a sample of the limit. The first sample is always taken.
uint32_t RenderLoop::affordable_samples(uint32_t begin) const {
  const double limit = input_.settings.time_limit;
  if (!(limit > 0.0) || input_.replay) return kMaxBatch;
  const uint32_t taken = begin - first_begin_;
  if (taken == 0) return 1;
  const double elapsed = std::max(sampling_.seconds(), 1e-9);
  return static_cast<uint32_t>(std::clamp((limit - elapsed) / elapsed * taken + 0.5, 0.0, double(kMaxBatch)));
}

void RenderLoop::judge() {
  const uint64_t cpu = process_cpu_nanoseconds();
  const CancelCheck cancel = [this] { return is_stopped(); };
  const uint32_t reconstruction = film_->settings.reconstruction;
  std::vector<BlockNoise> noise;
  arena_.execute([&] {
    noise = estimate_noise(*film_, adaptive_->blocks(), reconstruction, input_.settings.reconstruction_alpha, cancel);
  });
  if (!cancel()) adaptive_->judge(noise);
  stats_.cpu_seconds.reconstruct += 1e-9 * double(process_cpu_nanoseconds() - cpu);
}

// Takes all batches. In adaptive renders `begin` and `end` count the mean number of samples of pixels in blocks that
// have not stopped.
void RenderLoop::sample() {
  sampling_.start();
  const auto cancel = [this] { return is_stopped(); };
  // Uses the setting and not the plan: a render with too few samples to be adaptive may be resumed as one with enough.
  const bool adaptively =
      input_.settings.noise_threshold > 0.0f && !input_.replay && input_.snapshot->catchers == nullptr;
  uint32_t begin = input_.resumed ? resumed_samples(*input_.resumed, adaptively) : 0;
  const uint32_t first = input_.settings.first_sample;
  if (adaptively)
    adaptive_ = std::make_unique<AdaptiveSampling>(*film_, input_.settings.noise_threshold, plan_.first_check);
  first_begin_ = begin;
  sampler_ = std::make_unique<TileSampler>(
      *integrator_, film::make_pixel_blocks(plan_.sampled, tile_side(plan_.sampled, input_.threads)), gradients_,
      edges_, adaptive_.get(), input_.replay.get(), stop_, film_.get());
  tracker_.set_samples(begin);
  work_done_ = uint64_t(begin) * uint64_t(plan_.sampled.area());
  for (uint32_t end = 0; next_batch(begin, &end); begin = end) {
    if (adaptive_ && begin >= kMaxBatch && (begin % kMaxBatch == 0 || begin == first_begin_)) judge();
    if (is_done()) film_->shared = adaptive_->state(begin);  // so that a later render can continue from it
    if (cancel() || is_done()) break;
    if (show_is_due(begin)) show(begin);
    if (begin == first_begin_) find_edges();
    if (cancel()) break;
    if (adaptive_) adaptive_->start_batch(end - begin);
    film_->samples.add({first + begin, first + (adaptive_ ? adaptive_->max_taken() : end)});
    film_->shared = {};
    run_batch(begin, end);
    if (!cancel() && refines_edges(end)) sample_edges(end);
    if (cancel()) break;
    if (adaptive_) film_->shared = adaptive_->state(end);
    tracker_.set_samples(end);
    if (!picture_.is_reconstructed()) tracker_.new_image();
  }
  stats_.stopped = cancel() ? "cancelled" : is_done() ? "noise" : begin < input_.settings.samples ? "time" : "samples";
  tracker_.raise_to(ProgressTracker::kSamplingShare);
  stats_.cpu_seconds.sample += sampler_->cpu_seconds();
  stats_.seconds.sample = sampling_.seconds();
  stats_.cpu_seconds.preview = live_view_.cpu_seconds();
  stats_.seconds.preview = live_view_.seconds();
  if (const std::string text = fault_warning(*input_.snapshot); !text.empty()) stats_.warnings.push_back(text);
}

void RenderLoop::find_edges() {
  if (input_.meets_replays()) return;
  const uint64_t cpu = process_cpu_nanoseconds();
  edges_ = arena_.execute([&] { return integrator_->find_edges(plan_.sampled, stop_); });
  stats_.cpu_seconds.sample += 1e-9 * double(process_cpu_nanoseconds() - cpu);
}

void RenderLoop::run_batch(uint32_t begin, uint32_t end) {
  sampler_->start_batch(begin, end);
  finish_batch(begin);
}

// A noise threshold shares the samples by noise from kMaxBatch on.
bool RenderLoop::refines_edges(uint32_t end) const {
  const bool shares_by_noise = input_.settings.noise_threshold > 0.0f && end > kMaxBatch;
  return may_refine_edges() && !shares_by_noise && end >= kEdgeCheck && is_batch_end(end);
}

// Replayed samples have no further ones, and those that they are compared with have none either.
bool RenderLoop::may_refine_edges() const {
  return film_->settings.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED && gradients_.none() &&
         !input_.meets_replays();
}

void RenderLoop::sample_edges(uint32_t end) {
  const uint32_t begin = end > kEdgeCheck ? batch_begin(end) : 0;
  if (affordable_samples(end) < (end - begin + 1) / 2) return;
  std::vector<uint32_t> counts;
  arena_.execute([&] { counts = further_samples_at_edges(*film_, end - begin); });
  if (counts.empty()) return;
  sampler_->start_counted_batch(first_further_sample(input_.settings.first_sample + begin), &counts);
  finish_batch(end);
}

void RenderLoop::finish_batch(uint32_t begin) {
  const auto after_tile = [&](const Region& tile, uint64_t pixel_samples) {
    tile_done(tile, pixel_samples);
    return show_is_due(begin);
  };
  for (;;) {
    bool is_whole = false;
    arena_.execute([&] { is_whole = sampler_->run(after_tile); });
    if (is_whole || is_stopped()) return;
    show(begin);
  }
}

bool RenderLoop::show_is_due(uint32_t begin) const {
  const uint32_t reconstruction = film_->settings.reconstruction;
  if (begin < kBothHalves) return live_view_.quarter_is_due(reconstruction);
  return live_view_.refresh_is_due(reconstruction, sampling_.seconds(),
                                   tracker_.fraction() / ProgressTracker::kSamplingShare);
}

void RenderLoop::show(uint32_t begin) {
  sampling_.stop();
  if (begin < kBothHalves) {
    live_view_.show_quarter();
  } else {
    live_view_.refresh(film_, sampling_.seconds());
  }
  sampling_.start();
}

void RenderLoop::tile_done(const Region& tile, uint64_t pixel_samples) {
  picture_.show_tile(*film_, tile);
  const uint64_t done = work_done_ += pixel_samples;
  const uint32_t samples = input_.settings.samples,
                 refined = input_.settings.noise_threshold > 0.0f ? std::min(samples, kMaxBatch) : samples;
  const double further = may_refine_edges() && samples >= kEdgeCheck ? kUsualShareAtEdges * refined : 0.0,
               whole = double(plan_.sampled.area()) * (samples + further);
  double fraction = double(done) / whole;
  const double sampled = sampling_.seconds();
  if (input_.settings.time_limit > 0.0f) fraction = std::max(fraction, sampled / input_.settings.time_limit);
  tracker_.raise_to(ProgressTracker::kSamplingShare * static_cast<float>(std::min(fraction, 1.0)));
  if (picture_.is_reconstructed()) return;  // the reconstruction is shown, not the tiles
  const auto ms = static_cast<int64_t>(1e3 * sampled);
  int64_t last = last_image_ms_.load(std::memory_order_relaxed);
  if (ms - last >= kImageIntervalMs && last_image_ms_.compare_exchange_strong(last, ms)) tracker_.new_image();
}

void RenderLoop::develop_film(bool denoises) {
  output::Developer developer(
      input_.threads, [this] { return is_stopped(); }, denoises ? denoiser_ : nullptr);
  output::DevelopedFilm developed{film_, plan_.delivered, input_.threads, output::options_of(film_->settings)};
  const auto show = [&] { picture_.show(developed); };
  develop(&developer, output::wanted_images(film_->settings), nullptr, show, &developed, &stats_);
  check_cancelled();
}

void RenderLoop::find_motion() {
  const ScopedTimer timer(&stats_.seconds.correspondence, &stats_.cpu_seconds.correspondence);
  const CancelCheck cancel = [this] { return is_stopped(); };
  std::vector<motion::ComponentMotion> motion;
  arena_.execute([&] {
    motion = motion::component_motion(*input_.snapshot, input_.settings, components_, lpe::kEveryComponent,
                                      plan_.sampled, cancel);
  });
  check_cancelled();
  // progress() reads the sizes of these vectors at the same time.
  const std::lock_guard lock(mutex_);
  for (size_t c = 0; c < motion.size(); ++c) {
    film_->components[c].motion = std::move(motion[c].vectors);
    film_->components[c].tracked = std::move(motion[c].tracked);
    if (input_.samples_only) film_->components[c].shown = std::move(motion[c].shown);
  }
}

void RenderLoop::set_phase(GradusPhase phase) {
  const std::lock_guard lock(mutex_);
  phase_ = phase;
  if (!is_sampling()) picture_.end_tiles(film_);
}

void RenderLoop::ending(GradusError) {
  integrator_.reset();
  stats_.total_seconds = seconds();
  stats_.process_cpu = process_cpu_seconds();
  picture_.end_tiles(film_);
}

uint64_t RenderLoop::memory_bytes() const { return (film_ ? film_->memory_bytes() : 0) + picture_.memory_bytes(); }

void RenderLoop::read_pass(uint32_t pass, float* pixels) const {
  if (pass == GRADUS_PASS_COMBINED) live_view_.watch();
  {
    const std::lock_guard lock(mutex_);
    if (is_sampling() && schema::pass_info(pass).kind != schema::PassKind::Image) {
      throw invalid_operation("pass " + std::string(schema::pass_info(pass).name) + " comes when sampling has ended");
    }
  }
  picture_.read(pass, pixels);
}

void RenderLoop::read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) const {
  {
    const std::lock_guard lock(mutex_);
    if (is_sampling()) throw invalid_operation("channel " + name + " comes when sampling has ended");
  }
  picture_.shown().read_channel(kind, name, layer, pixels);
}

void RenderLoop::read_component(const std::string& name, uint32_t pass, float* pixels) const {
  const GradusSettings& settings = input_.settings;
  output::check_component(settings, name);
  {
    const std::lock_guard lock(mutex_);
    if (is_sampling()) throw invalid_operation("component " + name + " comes when sampling has ended");
  }
  const output::DevelopedFilm shown = picture_.shown();
  const bool is_sampled = shown.film && film::find_component(*shown.film, name) >= 0;
  if (is_sampled && !schema::has_bit(settings.component_passes, pass))
    throw invalid_operation("pass " + std::string(schema::component_pass_info(pass).name) +
                            " of components was not asked for");
  shown.read_component(name, pass, pixels);
}

std::string RenderLoop::stats() const {
  {
    const std::lock_guard lock(mutex_);
    require_film(film_, "its stats come", "the render failed before it began: ");
  }
  // The film and the statistics do not change after the end, so the lock is released before the sums over all pixels.
  return stats_json(stats_, plan_, *film_);
}

std::shared_ptr<const film::Film> RenderLoop::film() const {
  const std::lock_guard lock(mutex_);
  require_film(film_, "its film comes", "the render failed before it began: ");
  return film_;
}

}  // namespace gradus::render
