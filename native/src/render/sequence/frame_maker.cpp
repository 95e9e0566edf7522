#include "render/sequence/frame_maker.h"

#include <iterator>

#include "base/bill.h"
#include "base/error.h"
#include "frame/features.h"
#include "reconstruct/error_estimate.h"
#include "reconstruct/reconstruct_frame.h"
#include "render/combine.h"
#include "render/denoise_and_bill.h"
#include "settings/options.h"
#include "settings/pass_table.h"
#include "temporal/frame_window.h"

namespace gradus {
namespace {

// Of a frame that was sampled by another process, or in another session.
Plan plan_of(const Frame& frame) {
  Plan plan;
  plan.integrator = frame.settings.integrator;
  plan.reconstruction = frame.settings.reconstruction;
  plan.gradients = frame.gradients;
  plan.solves = true;
  plan.adaptive = frame.settings.noise_threshold > 0.0f;
  plan.unbiased = !plan.adaptive && !(frame.settings.clamp_direct > 0.0f) && !(frame.settings.clamp_indirect > 0.0f);
  plan.channels = frame.channels;
  plan.passes = frame.settings.passes;
  plan.sampled = frame.region;
  return plan;
}

// Names of components, those that share what they are reconstructed by.
std::vector<std::vector<std::string>> reconstructed_together(const Frame& frame, uint32_t reconstruction) {
  std::vector<std::vector<std::string>> groups;
  for (const ComponentPlanes& planes : frame.components) {
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

FrameMaker::FrameMaker(Sequence* sequence, int32_t number, const std::optional<GradusSettings>& asked, const CancelTest& is_cancelled)
    : sequence_(*sequence),
      number_(number),
      asked_(asked ? asked : sequence->folder_.settings(number)),
      is_cancelled_(is_cancelled),
      threads_(threads_of(asked_.value_or(GradusSettings{}), sequence->device_.get())),
      arena_(arena_size(threads_)) {}

void FrameMaker::stop_if_asked() const {
  if (is_cancelled_()) throw cancelled();
}

std::shared_ptr<MadeFrame> FrameMaker::load() {
  std::shared_ptr<MadeFrame> made;
  PhaseTimes wall, cpu;
  {
    const Bill bill(&wall.store, &cpu.store);
    arena_.execute([&] { made = read(); });
  }
  made->record.stats.seconds.add(wall);
  made->record.stats.cpu_seconds.add(cpu);
  return made;
}

std::shared_ptr<MadeFrame> FrameMaker::read() {
  const auto made = std::make_shared<MadeFrame>();
  made->number = number_;
  const SequenceFolder& folder = sequence_.folder_;
  made->frame = folder.load(number_, FramePart::kBase, StoredContent::kAll, is_cancelled_);
  read_differences_over_time(*made->frame, made.get());
  const std::shared_ptr<const Frame> offset = folder.load(number_, FramePart::kOffset, StoredContent::kAll, is_cancelled_);
  sequence_.merge(number_, made->frame.get(), *offset);
  const auto record = sequence_.records_.find(number_);
  const bool is_planned = record != sequence_.records_.end();
  if (is_planned) made->record = record->second;
  if (!is_planned) {
    made->record.plan = plan_of(*made->frame);
    made->record.stats.stopped = "stored";
  }
  made->by = delivery(made->record, is_planned, *made->frame);
  deliver_by(made->by, &made->frame->settings);
  made->record.plan.delivered = delivered_region(*made->frame);
  made->record.stats.offset_samples = mean_samples(*offset);
  return made;
}

bool FrameMaker::would_make(const MadeFrame& made) const {
  return made.number == number_ && delivery(made.record, sequence_.records_.count(number_) > 0, *made.frame) == made.by;
}

// AUTO is what the plan has come to. Of a frame that was sampled elsewhere it is what that was sampled for, and a denoiser where it pays.
Delivery FrameMaker::delivery(const FrameRecord& record, bool is_planned, const Frame& frame) const {
  const GradusSettings& own = frame.settings;
  if (!asked_) return {own.reconstruction, own.reconstruction_alpha, own.denoiser, own.film_exposure};
  const Plan& plan = record.plan;
  const bool denoises = is_planned ? plan.denoises : denoiser_pays(mean_samples(frame));
  const uint32_t automatic = !denoises ? GRADUS_DENOISER_NONE : is_planned ? GRADUS_DENOISER_OIDN : GRADUS_DENOISER_AUTO;
  return {asked_->reconstruction == GRADUS_RECONSTRUCTION_AUTO ? plan.reconstruction : asked_->reconstruction, asked_->reconstruction_alpha,
          asked_->denoiser == GRADUS_DENOISER_AUTO ? automatic : asked_->denoiser, asked_->film_exposure};
}

void FrameMaker::make_picture(MadeFrame* made) {
  arena_.execute([&] { reconstruct(made); });
  RenderStats& stats = made->record.stats;
  const Plan& plan = made->record.plan;
  const bool denoises = made->frame->settings.denoiser != GRADUS_DENOISER_NONE &&
                        (!plan.denoises_if_it_pays || denoises_after(plan, mean_samples(*made->frame), &stats.chosen, &stats.skipped));
  if (denoises) denoise(made);
  if (!denoises) made->frame->settings.denoiser = GRADUS_DENOISER_NONE;
  stop_if_asked();
  if (has_light_passes(*made->frame)) arena_.execute([&] { split_light(made); });
}

void FrameMaker::reconstruct(MadeFrame* made) {
  RenderStats& stats = made->record.stats;
  const Bill bill(&stats.seconds.reconstruct, &stats.cpu_seconds.reconstruct);
  const Frame& frame = *made->frame;
  const GradusSettings& settings = frame.settings;
  const bool with_error = wants(settings.passes, GRADUS_PASS_ERROR), with_flow = sequence_.settings_.with_flow && wants_flow(settings);
  const Region& region = made->delivered();
  Reconstructed picture;
  const std::vector<std::vector<std::string>> groups = reconstructed_together(frame, settings.reconstruction);
  try {
    for (const std::vector<std::string>& together : groups) {
      const SequenceMethod method{settings.reconstruction, settings.reconstruction_alpha, with_error};
      SequencePictures* pictures = sequence_.pictures(together, method, number_);
      Reconstructed part = pictures->take(sequence_.place_of(number_), is_cancelled_, &stats.solve);
      stop_if_asked();
      if (part.components.empty()) part.components.push_back(part.image);
      std::move(part.components.begin(), part.components.end(), std::back_inserter(picture.components));
      add_image(std::move(part.image), &picture.image);
      add_image(std::move(part.error), &picture.error);
      add_image(std::move(part.terms.noise), &picture.terms.noise);
      add_image(std::move(part.terms.apart), &picture.terms.apart);
    }
  } catch (...) {
    sequence_.pictures_.clear();  // a window that was not solved has left no share in its frames
    throw;
  }
  sequence_.keep_pictures(groups);
  made->combined = crop_picture(frame, settings.reconstruction, picture.image, region);
  if (!picture.terms.noise.empty()) picture.error = error_of_pixels(picture.terms, frame.region.width(), frame.region.height(), 3);
  if (with_error) made->error = crop_error(frame, picture.error, region);
  if (with_flow || wants_pictures(settings)) {
    made->components = crop_components(frame, settings.reconstruction, std::move(picture.components), region);
  }
}

void FrameMaker::denoise(MadeFrame* made) {
  const Frame& frame = *made->frame;
  RenderStats& stats = made->record.stats;
  Device* device = sequence_.device_.get();
  std::string why_not;
  const auto library = choose_denoiser(frame.settings.denoiser, device, &why_not);
  if (!library) return;
  if (!has_features(frame)) stats.warnings.emplace_back("the frame holds no features to guide the denoiser");
  std::vector<float> rgba = denoise_and_bill(*library, frame, made->delivered(), threads_, is_cancelled_, made->combined, &stats);
  if (rgba.empty()) return;
  arena_.execute([&] { follow_picture(made->combined, rgba, &made->components); });
  made->combined = std::move(rgba);
  for (float& value : made->error) value *= denoised_error(frame.settings.reconstruction);
}

void FrameMaker::split_light(MadeFrame* made) {
  RenderStats& stats = made->record.stats;
  const Bill bill(&stats.seconds.reconstruct, &stats.cpu_seconds.reconstruct);
  made->light = LightPasses(*made->frame, made->delivered(), made->combined, is_cancelled_);
}

void FrameMaker::read_differences_over_time(const Frame& frame, MadeFrame* made) {
  const GradusSettings& asked = asked_ ? *asked_ : frame.settings;
  const Region region = delivered_region(frame);
  const float exposure = asked.film_exposure;
  made->difference.assign(3 * size_t(region.area()), 0.0f);
  made->link = made->difference;
  const SequenceFolder& folder = sequence_.folder_;
  const int place = sequence_.place_of(number_) + 1;
  const int32_t next = sequence_.frame_at(place);
  const bool is_other = asked.reconstruction != GRADUS_RECONSTRUCTION_AUTO;
  const uint32_t reconstruction = is_other ? asked.reconstruction : frame.settings.reconstruction;
  const bool wanted = wants(frame.settings.passes, GRADUS_PASS_GRADIENT_T) || wants(frame.settings.passes, GRADUS_PASS_GRADIENT_T_LINK);
  if (!wanted || !folder.holds(next) || !sequence_.goes_on_at(place, reconstruction)) return;
  constexpr TemporalContent kPixels{.gradients = false, .halves = false};
  const std::shared_ptr<const Frame> replay = folder.load(next, FramePart::kOffset, StoredContent::kSamples, is_cancelled_);
  const FrameWindow window(
      {std::make_shared<TemporalFrame>(make_base(frame, kPixels)),
       std::make_shared<TemporalFrame>(make_replay(*replay, folder.header(next, FramePart::kBase).frame_number, kPixels))});
  const int width = frame.region.width(), channels = frame.channels;
  std::vector<float> differences(size_t(width) * size_t(channels));
  std::vector<int32_t> links(static_cast<size_t>(width));
  size_t out = 0;
  for (int32_t y = region.y0; y < region.y1; ++y) {
    stop_if_asked();
    const int row = y - frame.region.y0;
    window.read_row(RowKind::kDt, 0, row, differences.data());
    window.read_links(0, row, links.data());
    for (int32_t x = region.x0; x < region.x1; ++x, out += 3) {
      const auto i = size_t(x - frame.region.x0);
      if (links[i] == kNoLink || !is_finite(differences[i * size_t(channels)])) continue;
      for (size_t c = 0; c < 3; ++c) made->difference[out + c] = exposure * differences[i * size_t(channels) + c];
      made->link[out] = float(links[i] % width - int32_t(i));
      made->link[out + 1] = float(links[i] / width - row);
      made->link[out + 2] = 1.0f;
    }
  }
}

}  // namespace gradus
