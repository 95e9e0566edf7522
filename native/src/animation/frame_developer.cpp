#include "animation/frame_developer.h"

#include <iterator>

#include "animation/frame_window.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/fault.h"
#include "base/threads.h"
#include "film/features.h"
#include "film/scene_channels.h"
#include "output/denoise_combined.h"
#include "output/light_passes.h"
#include "reconstruct/error_estimate.h"
#include "reconstruct/reconstruct_film.h"
#include "render/develop.h"
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
  plan.adaptive = render::is_adaptive(film.settings);
  plan.unbiased = render::takes_unbiased_samples(film.settings);
  plan.channels = film.color_channels;
  plan.passes = film.settings.passes;
  plan.scene_channels = film::other_channels(film);
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

}  // namespace

FrameDeveloper::FrameDeveloper(Sequence* sequence, int32_t number, const std::optional<GradusSettings>& requested,
                               const CancelCheck& is_cancelled)
    : sequence_(*sequence),
      number_(number),
      requested_(requested ? requested : sequence->folder_.settings(number)),
      is_cancelled_(is_cancelled),
      threads_(output::threads_of(requested_.value_or(GradusSettings{}), sequence->device_.get())),
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

output::Options FrameDeveloper::requested_options(const GradusSettings& own) const {
  return output::options_of(requested_ ? *requested_ : own);
}

std::shared_ptr<DevelopedFrame> FrameDeveloper::read() {
  const auto frame = std::make_shared<DevelopedFrame>();
  const SequenceFolder& folder = sequence_.folder_;
  const std::shared_ptr<film::Film> film =
      folder.load(number_, FrameSamples::kFresh, film_io::StoredContent::kAll, is_cancelled_);
  if (requested_) film->settings.film_exposure = requested_->film_exposure;
  output::DevelopedFilm& pictures = frame->pictures;
  pictures.region = film::delivered_region(*film);
  pictures.threads = threads_;
  read_differences_over_time(*film, &pictures);
  render::Plan& plan = frame->record.plan;
  render::RenderStats& stats = frame->record.stats;
  double replayed_samples = 0.0;
  if (folder.header(number_, FrameSamples::kReplayed).samples.total() > 0) {
    const std::shared_ptr<const film::Film> replayed =
        folder.load(number_, FrameSamples::kReplayed, film_io::StoredContent::kAll, is_cancelled_);
    sequence_.merge(number_, film.get(), *replayed);
    replayed_samples = film::mean_samples(*replayed);
  }
  // The film of a repeated frame has the number of the one that it repeats.
  film->frame_number = film->settings.frame = number_;
  film->shared = {};
  const auto record = sequence_.records_.find(number_);
  if (record != sequence_.records_.end()) {
    frame->record = record->second;
  } else {
    plan = plan_of(*film);
    stats.stopped = "stored";
  }
  plan.delivered = pictures.region;
  stats.replayed_samples = replayed_samples;

  if (requested_) frame->requested = output::options_of(*requested_);
  const output::Options requested = requested_options(film->settings);
  std::string why_not;
  denoiser_ = output::choose_denoiser(requested.denoiser, sequence_.device_.get(), &why_not);
  output::FilmFacts facts = sequence_.facts_of(number_);
  facts.has_denoiser = denoiser_ != nullptr;
  facts.samples = sequence_.joined_samples(number_);
  pictures.options = output::resolve_auto(requested, facts);
  if (!denoiser_ && record == sequence_.records_.end()) {
    facts.has_denoiser = true;
    const bool would_denoise = output::resolve_auto(requested, facts).denoiser != GRADUS_DENOISER_NONE;
    if (would_denoise) plan.skipped.emplace_back("denoiser", why_not);
  }
  const bool is_automatic = denoiser_ != nullptr && requested.denoiser == GRADUS_DENOISER_AUTO &&
                            output::is_denoised_by_default(pictures.options.reconstruction);
  if (is_automatic) {
    // The frame may have been planned with another denoiser, or by another process.
    plan.denoises_if_it_pays = true;
    plan.denoiser = denoiser_->name();
    std::erase_if(plan.skipped, [](const auto& reason) { return reason.first == "denoiser"; });
    render::denoises_after(plan, facts.samples, &stats.chosen, &stats.skipped);
  }
  output::store_options(pictures.options, &film->settings);
  pictures.film = film;
  return frame;
}

bool FrameDeveloper::would_develop(const DevelopedFrame& developed) const {
  if (developed.pictures.film->frame_number != number_) return false;
  if (!requested_) return !developed.requested;
  return developed.requested == output::options_of(*requested_) &&
         developed.pictures.film->settings.film_exposure == requested_->film_exposure;
}

void FrameDeveloper::develop_picture(DevelopedFrame* frame) {
  const GradusSettings& settings = frame->pictures.film->settings;
  reconstruct::ReconstructionOutputs wanted = output::wanted_images(settings);
  if (sequence_.settings_.with_flow && schema::needs_flow(settings)) wanted.components = true;
  const auto from_windows = [&](reconstruct::SolveReport* report) {
    return take_from_windows(frame->pictures, wanted.components, report);
  };
  output::Developer developer(threads_, is_cancelled_, denoiser_);
  render::develop(
      &developer, wanted, from_windows, [this] { check_cancelled(); }, &frame->pictures, &frame->record.stats);
}

reconstruct::Reconstructed FrameDeveloper::take_from_windows(const output::DevelopedFilm& developed, bool by_components,
                                                             reconstruct::SolveReport* report) {
  const film::Film& film = *developed.film;
  const reconstruct::SequenceMethod method{developed.options.reconstruction, developed.options.alpha,
                                           output::wanted_images(film.settings).error};
  reconstruct::JoinedOutputs wanted{by_components, developed.options.denoiser != GRADUS_DENOISER_NONE};
  if (output::has_light_passes(film)) wanted.terms = output::read_light_terms;
  reconstruct::Reconstructed picture;
  const std::vector<std::vector<std::string>> groups = reconstructed_together(film, method.reconstruction);
  try {
    for (const std::vector<std::string>& together : groups) {
      reconstruct::SequencePictures* pictures = sequence_.pictures(together, method, number_);
      reconstruct::Reconstructed part = pictures->take(sequence_.place_of(number_), is_cancelled_, report, wanted);
      check_cancelled();
      if (part.components.empty() && groups.size() > 1) part.components.push_back(part.image);
      std::move(part.components.begin(), part.components.end(), std::back_inserter(picture.components));
      picture.sampled = std::move(part.sampled);
      picture.sampled_terms = std::move(part.sampled_terms);
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
  if (!picture.terms.noise.empty())
    picture.error = reconstruct::error_of_pixels(picture.terms, film.region.width(), film.region.height(), 3);
  return picture;
}

void FrameDeveloper::read_differences_over_time(const film::Film& film, output::DevelopedFilm* developed) {
  const output::Options options = output::resolve_auto(requested_options(film.settings), sequence_.facts_of(number_));
  const float exposure = film.settings.film_exposure;
  const Region& region = developed->region;
  const SequenceFolder& folder = sequence_.folder_;
  const int place = sequence_.place_of(number_) + 1;
  const int32_t next = sequence_.frame_at(place);
  const bool wanted = schema::has_bit(film.settings.passes, GRADUS_PASS_GRADIENT_T) ||
                      schema::has_bit(film.settings.passes, GRADUS_PASS_GRADIENT_T_CORRESPONDENCE);
  if (!wanted || !folder.holds(next) || !sequence_.shares_window_with_previous(place, options.reconstruction)) return;
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
  std::vector<float> difference(3 * size_t(region.area()), 0.0f), displacement = difference;
  size_t out = 0;
  for (int32_t y = region.y0; y < region.y1; ++y) {
    check_cancelled();
    const int row = y - film.region.y0;
    window.read_row(reconstruct::RowKind::kDt, 0, row, differences.data());
    window.read_correspondence(0, row, correspondence.data());
    for (int32_t x = region.x0; x < region.x1; ++x, out += 3) {
      const auto i = size_t(x - film.region.x0);
      if (correspondence[i] == film::kNoCorrespondence || !is_finite(differences[i * size_t(channels)])) continue;
      for (size_t c = 0; c < 3; ++c) difference[out + c] = exposure * differences[i * size_t(channels) + c];
      displacement[out] = float(correspondence[i] % width - int32_t(i));
      displacement[out + 1] = float(correspondence[i] / width - row);
      displacement[out + 2] = 1.0f;
    }
  }
  developed->passes[GRADUS_PASS_GRADIENT_T] = output::make_image(std::move(difference));
  developed->passes[GRADUS_PASS_GRADIENT_T_CORRESPONDENCE] = output::make_image(std::move(displacement));
}

}  // namespace gradus::animation
