// gradus_frame_*
#include "frame/frame.h"

#include <algorithm>

#include "api/arrays.h"
#include "api/guard.h"
#include "api/objects.h"
#include "base/fpu.h"
#include "frame/features.h"
#include "frame/store.h"
#include "plan/plan.h"
#include "reconstruct/reconstruct_frame.h"
#include "render/combine.h"
#include "render/component_read.h"
#include "render/denoise_combined.h"
#include "render/pass_read.h"
#include "render/resume.h"
#include "settings/options.h"
#include "settings/pass_table.h"

using namespace gradus;

namespace gradus::api {
namespace {

void check_count(size_t count, const Region& region, uint32_t channels) {
  const size_t expected = size_t(region.area()) * channels;
  if (count != expected)
    throw invalid_argument("expected " + std::to_string(expected) + " floats, " + std::to_string(count) + " were given");
}

uint32_t resolve(uint32_t reconstruction, const Frame& frame) {
  switch (reconstruction) {
    case GRADUS_RECONSTRUCTION_AUTO:
      if (has_features(frame)) return GRADUS_RECONSTRUCTION_REGULARIZED;
      return frame.gradients ? GRADUS_RECONSTRUCTION_WEIGHTED : GRADUS_RECONSTRUCTION_NONE;
    case GRADUS_RECONSTRUCTION_NONE:
    case GRADUS_RECONSTRUCTION_L2:
    case GRADUS_RECONSTRUCTION_L1:
    case GRADUS_RECONSTRUCTION_WEIGHTED:
    case GRADUS_RECONSTRUCTION_REGULARIZED:
      return reconstruction;
    default:
      throw invalid_argument("there is no reconstruction " + std::to_string(reconstruction));
  }
}

uint32_t threads_for(const FrameObject& object, const Frame& frame) {
  return frame.settings.threads > 0 ? frame.settings.threads : object.device->threads();
}

// RGBA, and the error unless it is nullptr, by as many threads as a render with the frame's settings has.
MadePicture make_picture(FrameObject* object, const Frame& frame, uint32_t reconstruction, float alpha, uint32_t denoiser, float* error) {
  const auto never = [] { return false; };
  reconstruction = resolve(reconstruction, frame);
  const uint32_t threads = threads_for(*object, frame);
  std::string why_not;
  if (denoiser == GRADUS_DENOISER_AUTO && !denoiser_pays(mean_samples(frame))) denoiser = GRADUS_DENOISER_NONE;
  const auto library = choose_denoiser(denoiser, object->device.get(), &why_not);
  std::vector<float> image, estimate;
  std::vector<std::vector<float>> components;
  tbb::task_arena arena(arena_size(threads));
  arena.execute([&] {
    const FlushDenormals flush;
    SolveReport report;
    image = combine(frame, reconstruction, alpha, delivered_region(frame), never, &report, error != nullptr ? &estimate : nullptr,
                    frame.components.size() > 1 ? &components : nullptr);
  });
  if (library) {
    if (!has_features(frame)) object->device->warnings().add("the frame holds no features to guide the denoiser");
    std::string failure;
    std::vector<float> denoised =
        denoise_combined(*library, frame, reconstruction, delivered_region(frame), threads, never, image, &failure);
    if (denoised.empty()) {
      object->device->warnings().add(failure);
    } else {
      arena.execute([&] { follow_picture(image, denoised, &components); });
      image = std::move(denoised);
      for (float& value : estimate) value *= denoised_error(reconstruction);
    }
  }
  std::copy(estimate.begin(), estimate.end(), error);
  return {std::move(image), std::move(components), reconstruction == GRADUS_RECONSTRUCTION_NONE && !library, {}};
}

// Light passes and components that are read from now on are those of this picture.
std::shared_ptr<MadePicture> keep_made(FrameObject* object, const std::shared_ptr<const Frame>& frame, MadePicture made) {
  auto kept = std::make_shared<MadePicture>(std::move(made));
  const std::lock_guard lock(object->mutex);
  if (object->frame == frame && (has_light_passes(*frame) || frame->components.size() > 1)) object->made = kept;
  return kept;
}

void reconstruct_into(FrameObject* object, const std::shared_ptr<const Frame>& frame, uint32_t reconstruction, float alpha,
                      uint32_t denoiser, float* rgba, float* error) {
  MadePicture made = make_picture(object, *frame, reconstruction, alpha, denoiser, error);
  std::copy(made.rgba.begin(), made.rgba.end(), rgba);
  keep_made(object, frame, std::move(made));
}

std::vector<float> read_error(FrameObject* object, const Frame& frame) {
  const GradusSettings& s = frame.settings;
  std::vector<float> error(size_t(delivered_region(frame).area()));
  make_picture(object, frame, s.reconstruction, s.reconstruction_alpha, GRADUS_DENOISER_NONE, error.data());
  return error;
}

// The picture that was made last; that of the frame's own settings where none was.
std::shared_ptr<MadePicture> made_of(FrameObject* object, const std::shared_ptr<const Frame>& frame) {
  {
    const std::lock_guard lock(object->mutex);
    if (object->frame == frame && object->made) return object->made;
  }
  const GradusSettings& s = frame->settings;
  return keep_made(object, frame, make_picture(object, *frame, s.reconstruction, s.reconstruction_alpha, s.denoiser, nullptr));
}

// Reads a pass of what was sampled, by as many threads.
void read_sampled(const FrameObject& object, const Frame& frame, uint32_t pass, float* pixels) {
  tbb::task_arena arena(arena_size(threads_for(object, frame)));
  arena.execute([&] { read_frame_pass(frame, pass, delivered_region(frame), pixels); });
}

void read_light(FrameObject* object, const std::shared_ptr<const Frame>& frame, uint32_t pass, float* pixels) {
  const std::shared_ptr<MadePicture> made = made_of(object, frame);
  const Region region = delivered_region(*frame);
  if (made->is_noisy) return read_sampled(*object, *frame, pass, pixels);
  const std::lock_guard lock(object->mutex);
  if (!made->light) {
    tbb::task_arena(arena_size(threads_for(*object, *frame))).execute([&] {
      const FlushDenormals flush;
      made->light = LightPasses(*frame, region, made->rgba, [] { return false; });
    });
  }
  made->light->read(pass, pixels);
}

std::vector<float> rgb_of(const std::vector<float>& rgba) {
  std::vector<float> rgb;
  for (size_t i = 0; i < rgba.size(); i += 4) rgb.insert(rgb.end(), {rgba[i], rgba[i + 1], rgba[i + 2]});
  return rgb;
}

std::vector<float> component_color(FrameObject* object, const std::shared_ptr<const Frame>& frame, int component) {
  const std::shared_ptr<MadePicture> made = made_of(object, frame);
  return frame->components.size() > 1 ? made->components[size_t(component)] : rgb_of(made->rgba);
}

}  // namespace
}  // namespace gradus::api

GradusError gradus_frame_save(GradusFrame frame, const char* path) {
  return api::guard([&] {
    const auto object = api::find_handle<api::FrameObject>(frame);
    const std::string file = &api::require(path, "path");
    object->device->arena().execute([&] { save_frame(*object->get(), file); });
  });
}

GradusError gradus_frame_load(GradusDevice device, const char* path, GradusFrame* frame) {
  return api::guard([&] {
    api::require(frame, "frame") = 0;
    auto object = std::make_shared<api::FrameObject>(api::find_handle<Device>(device));
    const std::string file = &api::require(path, "path");
    object->device->arena().execute([&] { object->frame = load_frame(file); });
    *frame = api::add_handle(std::move(object));
  });
}

GradusError gradus_frame_merge(GradusFrame frame, GradusFrame other) {
  return api::guard([&] {
    const auto to = api::find_handle<api::FrameObject>(frame);
    const std::shared_ptr<const Frame> from = api::find_handle<api::FrameObject>(other)->get();
    const std::lock_guard lock(to->mutex);
    auto merged = std::make_shared<Frame>(*to->frame);
    merge_frames(merged.get(), *from);
    to->frame = std::move(merged);
    to->made = nullptr;
  });
}

GradusError gradus_frame_size(GradusFrame frame, uint32_t* width, uint32_t* height) {
  return api::guard([&] {
    const Region region = delivered_region(*api::find_handle<api::FrameObject>(frame)->get());
    api::require(width, "width") = uint32_t(region.width());
    api::require(height, "height") = uint32_t(region.height());
  });
}

GradusError gradus_frame_reconstruct(GradusFrame frame, uint32_t reconstruction, float alpha, uint32_t denoiser, float* rgba, size_t count,
                                     float* error) {
  return api::guard([&] {
    const auto object = api::find_handle<api::FrameObject>(frame);
    const std::shared_ptr<const Frame> content = object->get();
    api::check_count(count, delivered_region(*content), 4);
    api::check_array(rgba, count, "rgba");
    if (error != nullptr) api::check_array(error, count / 4, "error");
    check_alpha(alpha);
    api::reconstruct_into(object.get(), content, reconstruction, alpha, denoiser, rgba, error);
  });
}

GradusError gradus_frame_read_pass(GradusFrame frame, uint32_t pass, float* pixels, size_t count) {
  return api::guard([&] {
    const auto object = api::find_handle<api::FrameObject>(frame);
    const std::shared_ptr<const Frame> content = object->get();
    const Region region = delivered_region(*content);
    api::check_count(count, region, pass_info(pass).channels);
    api::check_array(pixels, count, "pixels");
    const GradusSettings& s = content->settings;
    if (pass == GRADUS_PASS_COMBINED) {
      return api::reconstruct_into(object.get(), content, s.reconstruction, s.reconstruction_alpha, s.denoiser, pixels, nullptr);
    }
    if (pass == GRADUS_PASS_ERROR) return static_cast<void>(std::ranges::copy(api::read_error(object.get(), *content), pixels));
    if (wants(light_passes(), pass) && has_pass(*content, pass)) return api::read_light(object.get(), content, pass, pixels);
    api::read_sampled(*object, *content, pass, pixels);
  });
}

GradusError gradus_frame_read_component(GradusFrame frame, const char* component, uint32_t pass, float* pixels, size_t count) {
  return api::guard([&] {
    const auto object = api::find_handle<api::FrameObject>(frame);
    const std::shared_ptr<const Frame> content = object->get();
    const std::string name = &api::require(component, "component");
    const Region region = delivered_region(*content);
    api::check_count(count, region, component_pass_info(pass).channels);
    api::check_array(pixels, count, "pixels");
    check_component(content->settings, name);
    const int place = find_component(*content, name);
    if (place < 0) return read_absent_component(pass, region, pixels);
    const std::vector<float> color = is_of_picture(pass) ? api::component_color(object.get(), content, place) : std::vector<float>();
    read_component_pass(*content, place, pass, region, color, pixels);
  });
}

GradusError gradus_frame_release(GradusFrame frame) {
  return api::guard([&] { api::remove_handle<api::FrameObject>(frame); });
}
