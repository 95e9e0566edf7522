#include "render/sequence/frame_delivery.h"

#include <algorithm>

#include "base/bill.h"
#include "base/error.h"
#include "frame/features.h"
#include "reconstruct/reconstruct_frame.h"
#include "render/combine.h"
#include "render/component_read.h"
#include "render/denoise_and_bill.h"
#include "render/pass_read.h"
#include "settings/options.h"
#include "settings/pass_table.h"
#include "temporal/frame_window.h"

namespace gradus {
namespace {

constexpr const char* kNotDelivered = "the frame was not delivered: ";

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

}  // namespace

FrameDelivery::FrameDelivery(std::shared_ptr<Sequence> sequence, int32_t frame, const GradusSettings* settings)
    : sequence_(std::move(sequence)), number_(frame), changed_(settings ? std::optional(*settings) : std::nullopt) {}

void FrameDelivery::render() {
  {
    const std::lock_guard lock(mutex_);
    phase_ = GRADUS_PHASE_RECONSTRUCTING;
  }
  std::shared_ptr<Frame> frame;
  const uint32_t threads = threads_of(changed_.value_or(GradusSettings{}), sequence_->device_.get());
  tbb::task_arena arena(arena_size(threads));
  PhaseTimes wall, cpu;
  {
    const Bill bill(&wall.store, &cpu.store);
    arena.execute([&] { frame = load(); });
  }
  record_.stats.seconds.add(wall);
  record_.stats.cpu_seconds.add(cpu);
  {
    const std::lock_guard lock(mutex_);
    frame_ = std::move(frame);
  }
  arena.execute([&] { reconstruct(); });
  RenderStats& stats = record_.stats;
  const bool denoises =
      frame_->settings.denoiser != GRADUS_DENOISER_NONE &&
      (!record_.plan.denoises_if_it_pays || denoises_after(record_.plan, mean_samples(*frame_), &stats.chosen, &stats.skipped));
  if (denoises) denoise();
  if (!denoises) frame_->settings.denoiser = GRADUS_DENOISER_NONE;
  stop_if_asked();
  if (has_light_passes(*frame_)) arena.execute([&] { split_light(); });
  sequence_->forget_before(sequence_->needs(number_).first);
  const std::lock_guard lock(mutex_);
  record_.stats.total_seconds += seconds();
  record_.stats.process_cpu += process_cpu_seconds();
}

std::shared_ptr<Frame> FrameDelivery::load() {
  const SequenceFolder& folder = sequence_->folder_;
  const CancelTest cancel = [this] { return is_stopped(); };
  const std::shared_ptr<Frame> frame = folder.load(number_, FramePart::kBase, StoredContent::kAll, cancel);
  const std::optional<GradusSettings> asked = changed_ ? changed_ : folder.settings(number_);
  read_differences_over_time(*frame, asked ? *asked : frame->settings, cancel);
  const std::shared_ptr<const Frame> offset = folder.load(number_, FramePart::kOffset, StoredContent::kAll, cancel);
  sequence_->merge(number_, frame.get(), *offset);
  const auto record = sequence_->records_.find(number_);
  const bool is_planned = record != sequence_->records_.end();
  if (is_planned) record_ = record->second;
  if (!is_planned) {
    record_.plan = plan_of(*frame);
    record_.stats.stopped = "stored";
  }
  if (asked) deliver_as(*asked, is_planned, frame.get());
  record_.plan.delivered = delivered_region(*frame);
  record_.stats.offset_samples = mean_samples(*offset);
  return frame;
}

// AUTO is what the plan has come to. Of a frame that was sampled elsewhere it is what that was sampled for, and a denoiser where it pays.
void FrameDelivery::deliver_as(const GradusSettings& asked, bool is_planned, Frame* frame) const {
  const Plan& plan = record_.plan;
  const bool denoises = is_planned ? plan.denoises : denoiser_pays(mean_samples(*frame));
  const uint32_t automatic = !denoises ? GRADUS_DENOISER_NONE : is_planned ? GRADUS_DENOISER_OIDN : GRADUS_DENOISER_AUTO;
  GradusSettings& settings = frame->settings;
  settings.reconstruction = asked.reconstruction == GRADUS_RECONSTRUCTION_AUTO ? plan.reconstruction : asked.reconstruction;
  settings.reconstruction_alpha = asked.reconstruction_alpha;
  settings.denoiser = asked.denoiser == GRADUS_DENOISER_AUTO ? automatic : asked.denoiser;
  settings.film_exposure = asked.film_exposure;
}

void FrameDelivery::reconstruct() {
  const Bill bill(&record_.stats.seconds.reconstruct, &record_.stats.cpu_seconds.reconstruct);
  const CancelTest cancel = [this] { return is_stopped(); };
  const GradusSettings& settings = frame_->settings;
  const bool with_error = wants(settings.passes, GRADUS_PASS_ERROR);
  const Region& region = record_.plan.delivered;
  Reconstructed picture;
  std::vector<std::vector<float>> components;
  try {
    for (const ComponentPlanes& planes : frame_->components) {
      const SequenceMethod method{settings.reconstruction, settings.reconstruction_alpha, with_error};
      SequencePictures* pictures = sequence_->pictures(planes.name, method, number_);
      Reconstructed part = pictures->take(sequence_->place_of(number_), cancel, &record_.stats.solve);
      stop_if_asked();
      clamp_component(*frame_, settings.reconstruction, frame_->components.size(), &part.image);
      if (wants_pictures(settings)) components.push_back(crop_component(*frame_, settings.reconstruction, part.image, region));
      add_image(std::move(part.image), &picture.image);
      add_image(std::move(part.error), &picture.error);
    }
  } catch (...) {
    sequence_->pictures_.clear();  // a window that was not solved has left no share in its frames
    throw;
  }
  std::vector<float> rgba = crop_picture(*frame_, settings.reconstruction, picture.image, region);
  std::vector<float> error;
  if (with_error) error = crop_error(*frame_, picture.error, region);
  const std::lock_guard lock(mutex_);
  combined_ = std::move(rgba);
  error_ = std::move(error);
  components_ = std::move(components);
}

void FrameDelivery::denoise() {
  const CancelTest cancel = [this] { return is_stopped(); };
  std::string why_not;
  const auto library = choose_denoiser(frame_->settings.denoiser, sequence_->device_.get(), &why_not);
  if (!library) return;
  if (!has_features(*frame_)) record_.stats.warnings.emplace_back("the frame holds no features to guide the denoiser");
  const uint32_t threads = threads_of(frame_->settings, sequence_->device_.get());
  std::vector<float> rgba = denoise_and_bill(*library, *frame_, record_.plan.delivered, threads, cancel, combined_, &record_.stats);
  if (rgba.empty()) return;
  const std::lock_guard lock(mutex_);
  follow_picture(combined_, rgba, &components_);
  combined_ = std::move(rgba);
  for (float& value : error_) value *= denoised_error(frame_->settings.reconstruction);
}

void FrameDelivery::split_light() {
  const Bill bill(&record_.stats.seconds.reconstruct, &record_.stats.cpu_seconds.reconstruct);
  LightPasses light(*frame_, record_.plan.delivered, combined_, [this] { return is_stopped(); });
  const std::lock_guard lock(mutex_);
  light_ = std::move(light);
}

void FrameDelivery::read_differences_over_time(const Frame& frame, const GradusSettings& asked, const CancelTest& cancel) {
  const Region region = delivered_region(frame);
  const float exposure = asked.film_exposure;
  difference_.assign(3 * size_t(region.area()), 0.0f);
  link_ = difference_;
  const SequenceFolder& folder = sequence_->folder_;
  const int place = sequence_->place_of(number_) + 1;
  const int32_t next = sequence_->frame_at(place);
  const bool is_other = asked.reconstruction != GRADUS_RECONSTRUCTION_AUTO;
  const uint32_t reconstruction = is_other ? asked.reconstruction : frame.settings.reconstruction;
  const bool wanted = wants(frame.settings.passes, GRADUS_PASS_GRADIENT_T) || wants(frame.settings.passes, GRADUS_PASS_GRADIENT_T_LINK);
  if (!wanted || !folder.holds(next) || !sequence_->goes_on_at(place, reconstruction)) return;
  constexpr TemporalContent kPixels{.gradients = false, .halves = false};
  const std::shared_ptr<const Frame> replay = folder.load(next, FramePart::kOffset, StoredContent::kSamples, cancel);
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
      for (size_t c = 0; c < 3; ++c) difference_[out + c] = exposure * differences[i * size_t(channels) + c];
      link_[out] = float(links[i] % width - int32_t(i));
      link_[out + 1] = float(links[i] / width - row);
      link_[out + 2] = 1.0f;
    }
  }
}

const Region& FrameDelivery::delivered() const {
  const std::lock_guard lock(mutex_);
  require_frame(frame_, "its passes come", kNotDelivered);
  return record_.plan.delivered;
}

void FrameDelivery::read_pass(uint32_t pass, float* pixels) const {
  const std::lock_guard lock(mutex_);
  require_frame(frame_, "its passes come", kNotDelivered);
  const std::vector<float>* made = pass == GRADUS_PASS_COMBINED          ? &combined_
                                   : pass == GRADUS_PASS_ERROR           ? &error_
                                   : pass == GRADUS_PASS_GRADIENT_T      ? &difference_
                                   : pass == GRADUS_PASS_GRADIENT_T_LINK ? &link_
                                                                         : nullptr;
  if (made != nullptr && !made->empty()) {
    std::copy(made->begin(), made->end(), pixels);
    return;
  }
  if (light_.read(pass, pixels)) return;
  const Region& region = record_.plan.delivered;
  if (pass == GRADUS_PASS_ERROR) {  // it was cancelled: nothing is known of the picture
    std::fill_n(pixels, size_t(region.area()), 0.0f);
    return;
  }
  read_frame_pass(*frame_, pass, region, pixels);
}

void FrameDelivery::read_component(const std::string& name, uint32_t pass, float* pixels) const {
  const std::lock_guard lock(mutex_);
  require_frame(frame_, "its passes come", kNotDelivered);
  check_component(frame_->settings, name);
  const Region& region = record_.plan.delivered;
  const int place = find_component(*frame_, name);
  const bool has_picture = place >= 0 && size_t(place) < components_.size();
  if (place < 0 || (is_of_picture(pass) && !has_picture)) return read_absent_component(pass, region, pixels);
  read_component_pass(*frame_, place, pass, region, has_picture ? components_[size_t(place)] : std::vector<float>(), pixels);
}

std::string FrameDelivery::stats() const {
  const std::lock_guard lock(mutex_);
  require_frame(frame_, "its stats come", kNotDelivered);
  return stats_json(record_.stats, record_.plan, *frame_);
}

std::shared_ptr<const Frame> FrameDelivery::frame() const {
  const std::lock_guard lock(mutex_);
  require_frame(frame_, "its frame comes", kNotDelivered);
  return frame_;
}

uint64_t FrameDelivery::memory_bytes() const { return (frame_ ? frame_->memory_bytes() : 0) + combined_.size() * sizeof(float); }

}  // namespace gradus
