#include "animation/frame_developer.h"

#include <iterator>

#include "animation/frame_window.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/fault.h"
#include "base/threads.h"
#include "film/features.h"
#include "output/combine.h"
#include "reconstruct/error_estimate.h"
#include "reconstruct/reconstruct_film.h"
#include "render/denoise_timed.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::animation {
namespace {

// Reconstructs the plan of a frame that another process or another session sampled.
render::Plan plan_of(const film::Film& film) {
  render::Plan plan;
  plan.integrator = film.settings.integrator;
  plan.reconstruction = film.settings.reconstruction;
  plan.gradients = film.gradients;
  plan.solves = true;
  plan.adaptive = film.settings.noise_threshold > 0.0f;
  plan.unbiased = !plan.adaptive && !(film.settings.clamp_direct > 0.0f) && !(film.settings.clamp_indirect > 0.0f);
  plan.channels = film.color_channels;
  plan.passes = film.settings.passes;
  plan.sampled = film.region;
  return plan;
}

// Returns groups of names of components that are reconstructed with the same weights: all of them by REGULARIZED, each
// one alone by other methods.
std::vector<std::vector<std::string>> reconstructed_together(const film::Film& film, uint32_t reconstruction) {
  std::vector<std::vector<std::string>> groups;
  for (const film::ComponentPlanes& planes : film.components) {
    if (groups.empty() || reconstruction != GRADUS_RECONSTRUCTION_REGULARIZED) groups.emplace_back();
    groups.back().push_back(planes.name);
  }
  return groups;
}

void deliver_by(const Delivery& by, GradusSettings* settings) {
  settings->reconstruction = by.reconstruction;
  settings->reconstruction_alpha = by.reconstruction_alpha;
  settings->denoiser = by.denoiser;
  settings->film_exposure = by.film_exposure;
}

}  // namespace

FrameDeveloper::FrameDeveloper(Sequence* sequence, int32_t number, const std::optional<GradusSettings>& requested,
                               const CancelCheck& is_cancelled)
    : sequence_(*sequence),
      number_(number),
      requested_(requested ? requested : sequence->folder_.settings(number)),
      is_cancelled_(is_cancelled),
      threads_(render::threads_of(requested_.value_or(GradusSettings{}), sequence->device_.get())),
      arena_(arena_size(threads_)) {}

void FrameDeveloper::check_cancelled() const {
  if (is_cancelled_()) throw cancelled();
}

std::shared_ptr<DevelopedFrame> FrameDeveloper::load() {
  std::shared_ptr<DevelopedFrame> developed;
  render::PhaseTimes wall, cpu;
  {
    const ScopedTimer timer(&wall.store, &cpu.store);
    arena_.execute([&] { developed = read(); });
  }
  developed->record.stats.seconds.add(wall);
  developed->record.stats.cpu_seconds.add(cpu);
  return developed;
}

std::shared_ptr<DevelopedFrame> FrameDeveloper::read() {
  const auto developed = std::make_shared<DevelopedFrame>();
  developed->number = number_;
  const SequenceFolder& folder = sequence_.folder_;
  developed->film = folder.load(number_, FrameSamples::kFresh, film_io::StoredContent::kAll, is_cancelled_);
  read_differences_over_time(*developed->film, developed.get());
  const std::shared_ptr<const film::Film> replayed =
      folder.load(number_, FrameSamples::kReplayed, film_io::StoredContent::kAll, is_cancelled_);
  sequence_.merge(number_, developed->film.get(), *replayed);
  const auto record = sequence_.records_.find(number_);
  const bool is_planned = record != sequence_.records_.end();
  if (is_planned) developed->record = record->second;
  if (!is_planned) {
    developed->record.plan = plan_of(*developed->film);
    developed->record.stats.stopped = "stored";
  }
  developed->by = delivery(developed->record, is_planned, *developed->film);
  deliver_by(developed->by, &developed->film->settings);
  developed->record.plan.delivered = film::delivered_region(*developed->film);
  developed->record.stats.replayed_samples = film::mean_samples(*replayed);
  return developed;
}

bool FrameDeveloper::would_develop(const DevelopedFrame& developed) const {
  return developed.number == number_ &&
         delivery(developed.record, sequence_.records_.count(number_) > 0, *developed.film) == developed.by;
}

// AUTO becomes what the plan has chosen. For a frame that another process sampled it becomes the reconstruction with
// which that was sampled, and a denoiser if the number of samples makes one worthwhile.
Delivery FrameDeveloper::delivery(const FrameRecord& record, bool is_planned, const film::Film& film) const {
  const GradusSettings& own = film.settings;
  if (!requested_) return {own.reconstruction, own.reconstruction_alpha, own.denoiser, own.film_exposure};
  const render::Plan& plan = record.plan;
  const bool denoises = is_planned ? plan.denoises : render::denoiser_pays(film::mean_samples(film));
  const uint32_t automatic = !denoises    ? GRADUS_DENOISER_NONE
                             : is_planned ? GRADUS_DENOISER_OIDN
                                          : GRADUS_DENOISER_AUTO;
  return {requested_->reconstruction == GRADUS_RECONSTRUCTION_AUTO ? plan.reconstruction : requested_->reconstruction,
          requested_->reconstruction_alpha,
          requested_->denoiser == GRADUS_DENOISER_AUTO ? automatic : requested_->denoiser, requested_->film_exposure};
}

void FrameDeveloper::develop_picture(DevelopedFrame* developed) {
  arena_.execute([&] { reconstruct(developed); });
  render::RenderStats& stats = developed->record.stats;
  const render::Plan& plan = developed->record.plan;
  const bool denoises = developed->film->settings.denoiser != GRADUS_DENOISER_NONE &&
                        (!plan.denoises_if_it_pays || render::denoises_after(plan, film::mean_samples(*developed->film),
                                                                             &stats.chosen, &stats.skipped));
  if (denoises) denoise(developed);
  if (!denoises) developed->film->settings.denoiser = GRADUS_DENOISER_NONE;
  check_cancelled();
  if (output::has_light_passes(*developed->film)) arena_.execute([&] { split_light(developed); });
}

void FrameDeveloper::reconstruct(DevelopedFrame* developed) {
  render::RenderStats& stats = developed->record.stats;
  const ScopedTimer timer(&stats.seconds.reconstruct, &stats.cpu_seconds.reconstruct);
  const film::Film& film = *developed->film;
  const GradusSettings& settings = film.settings;
  const bool with_error = schema::has_bit(settings.passes, GRADUS_PASS_ERROR),
             with_flow = sequence_.settings_.with_flow && schema::needs_flow(settings);
  const Region& region = developed->delivered();
  reconstruct::Reconstructed picture;
  const std::vector<std::vector<std::string>> groups = reconstructed_together(film, settings.reconstruction);
  try {
    for (const std::vector<std::string>& together : groups) {
      const reconstruct::SequenceMethod method{settings.reconstruction, settings.reconstruction_alpha, with_error};
      reconstruct::SequencePictures* pictures = sequence_.pictures(together, method, number_);
      reconstruct::Reconstructed part = pictures->take(sequence_.place_of(number_), is_cancelled_, &stats.solve);
      check_cancelled();
      if (part.components.empty()) part.components.push_back(part.image);
      std::move(part.components.begin(), part.components.end(), std::back_inserter(picture.components));
      reconstruct::add_image(std::move(part.image), &picture.image);
      reconstruct::add_image(std::move(part.error), &picture.error);
      reconstruct::add_image(std::move(part.terms.noise), &picture.terms.noise);
      reconstruct::add_image(std::move(part.terms.l2_difference), &picture.terms.l2_difference);
    }
  } catch (...) {
    sequence_.pictures_.clear();  // its frames lack the share of the window that was not solved
    throw;
  }
  sequence_.retain_pictures(groups);
  developed->combined = output::crop_picture(film, settings.reconstruction, picture.image, region);
  if (!picture.terms.noise.empty())
    picture.error = reconstruct::error_of_pixels(picture.terms, film.region.width(), film.region.height(), 3);
  if (with_error) developed->error = output::crop_error(film, picture.error, region);
  if (with_flow || schema::needs_pictures(settings)) {
    developed->components =
        output::crop_components(film, settings.reconstruction, std::move(picture.components), region);
  }
}

void FrameDeveloper::denoise(DevelopedFrame* developed) {
  const film::Film& film = *developed->film;
  render::RenderStats& stats = developed->record.stats;
  scene::Device* device = sequence_.device_.get();
  std::string why_not;
  const auto library = output::choose_denoiser(film.settings.denoiser, device, &why_not);
  if (!library) return;
  if (!film::has_features(film)) stats.warnings.emplace_back("the frame holds no features to guide the denoiser");
  std::vector<float> rgba = render::denoise_timed(*library, film, developed->delivered(), threads_, is_cancelled_,
                                                  developed->combined, &stats);
  if (rgba.empty()) return;
  arena_.execute([&] { output::follow_picture(developed->combined, rgba, &developed->components); });
  developed->combined = std::move(rgba);
  for (float& value : developed->error) value *= output::denoised_error(film.settings.reconstruction);
}

void FrameDeveloper::split_light(DevelopedFrame* developed) {
  render::RenderStats& stats = developed->record.stats;
  const ScopedTimer timer(&stats.seconds.reconstruct, &stats.cpu_seconds.reconstruct);
  developed->light = output::LightPasses(*developed->film, developed->delivered(), developed->combined, is_cancelled_);
}

void FrameDeveloper::read_differences_over_time(const film::Film& film, DevelopedFrame* developed) {
  const GradusSettings& requested = requested_ ? *requested_ : film.settings;
  const Region region = film::delivered_region(film);
  const float exposure = requested.film_exposure;
  developed->difference.assign(3 * size_t(region.area()), 0.0f);
  developed->link = developed->difference;
  const SequenceFolder& folder = sequence_.folder_;
  const int place = sequence_.place_of(number_) + 1;
  const int32_t next = sequence_.frame_at(place);
  const bool is_other = requested.reconstruction != GRADUS_RECONSTRUCTION_AUTO;
  const uint32_t reconstruction = is_other ? requested.reconstruction : film.settings.reconstruction;
  const bool wanted = schema::has_bit(film.settings.passes, GRADUS_PASS_GRADIENT_T) ||
                      schema::has_bit(film.settings.passes, GRADUS_PASS_GRADIENT_T_LINK);
  if (!wanted || !folder.holds(next) || !sequence_.shares_window_with_previous(place, reconstruction)) return;
  constexpr TemporalContent kPixels{.gradients = false, .halves = false};
  const std::shared_ptr<const film::Film> replay = folder.load(
      next, GRADUS_FAULT(temporal_difference_loads_fresh_frame) ? FrameSamples::kFresh : FrameSamples::kReplayed,
      film_io::StoredContent::kSamples, is_cancelled_);
  const FrameWindow window({std::make_shared<TemporalFrame>(make_fresh(film, kPixels)),
                            std::make_shared<TemporalFrame>(make_replay(
                                *replay, folder.header(next, FrameSamples::kFresh).frame_number, kPixels))});
  const int width = film.region.width(), channels = film.color_channels;
  std::vector<float> differences(size_t(width) * size_t(channels));
  std::vector<int32_t> correspondence(static_cast<size_t>(width));
  size_t out = 0;
  for (int32_t y = region.y0; y < region.y1; ++y) {
    check_cancelled();
    const int row = y - film.region.y0;
    window.read_row(reconstruct::RowKind::kDt, 0, row, differences.data());
    window.read_correspondence(0, row, correspondence.data());
    for (int32_t x = region.x0; x < region.x1; ++x, out += 3) {
      const auto i = size_t(x - film.region.x0);
      if (correspondence[i] == film::kNoCorrespondence || !is_finite(differences[i * size_t(channels)])) continue;
      for (size_t c = 0; c < 3; ++c) developed->difference[out + c] = exposure * differences[i * size_t(channels) + c];
      developed->link[out] = float(correspondence[i] % width - int32_t(i));
      developed->link[out + 1] = float(correspondence[i] / width - row);
      developed->link[out + 2] = 1.0f;
    }
  }
}

}  // namespace gradus::animation
