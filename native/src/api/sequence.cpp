// gradus_sequence_*
#include "animation/sequence.h"

#include "api/guard.h"
#include "api/objects.h"
#include "api/structs.h"
#include "schema/options.h"

using namespace gradus;

namespace gradus::api {
namespace {

animation::SequenceSettings settings_of(const GradusSequenceSettings& given) {
  animation::SequenceSettings settings{
      given.first, given.last, given.step, {}, given.folder != nullptr ? given.folder : ""};
  settings.with_flow = given.with_flow != 0;
  if (given.window_size > 0) settings.windows = {int(given.window_size), int(given.window_overlap)};
  return settings;
}

// Throws invalid_operation while a render of the sequence is running. The caller holds the sequence's mutex.
void require_idle(const SequenceObject& object) {
  const auto running = object.running.lock();
  if (running && !running->render.wait(0.0)) throw invalid_operation("a frame of the sequence is still being rendered");
}

GradusRender run(SequenceObject* object, std::unique_ptr<render::RenderTask> task) {
  auto render = std::make_shared<RenderObject>(object->device, std::move(task));
  object->running = render;
  return add_handle(std::move(render));
}

}  // namespace
}  // namespace gradus::api

GradusError gradus_sequence_applies(const GradusSettings* settings, uint32_t* applies, const char** why_not) {
  return api::guard([&] {
    thread_local std::string text;
    api::require(applies, "applies") =
        animation::sequence_applies(api::read_struct(settings, "settings", schema::default_settings()), &text) ? 1 : 0;
    api::require(why_not, "why_not") = text.c_str();
  });
}

GradusError gradus_sequence_create(GradusDevice device, const GradusSequenceSettings* settings,
                                   GradusSequence* sequence) {
  return api::guard([&] {
    api::require(sequence, "sequence") = 0;
    const GradusSequenceSettings copy = api::read_struct(settings, "settings");
    *sequence = api::add_handle(
        std::make_shared<api::SequenceObject>(api::find_handle<scene::Device>(device), api::settings_of(copy)));
  });
}

GradusError gradus_sequence_needs(GradusSequence sequence, const GradusSettings* settings, int32_t* first,
                                  int32_t* last) {
  return api::guard([&] {
    const GradusSettings copy = api::read_struct(settings, "settings", schema::default_settings());
    const auto object = api::find_handle<api::SequenceObject>(sequence);
    const std::lock_guard lock(object->mutex);
    const reconstruct::FrameRange needed = object->sequence->needs(copy);
    api::require(first, "first") = needed.first;
    api::require(last, "last") = needed.last;
  });
}

GradusError gradus_sequence_sample(GradusSequence sequence, GradusScene scene, const GradusSettings* settings,
                                   GradusRender* render) {
  return api::guard([&] {
    api::require(render, "render") = 0;
    const GradusSettings copy = api::read_struct(settings, "settings", schema::default_settings());
    const auto object = api::find_handle<api::SequenceObject>(sequence);
    const std::lock_guard lock(object->mutex);
    api::require_idle(*object);
    *render =
        api::run(object.get(), object->sequence->sample(api::find_handle<api::SceneObject>(scene)->snapshot(), copy));
  });
}

GradusError gradus_sequence_pass_by(GradusSequence sequence, GradusScene scene, const GradusSettings* settings) {
  return api::guard([&] {
    const GradusSettings copy = api::read_struct(settings, "settings", schema::default_settings());
    const auto object = api::find_handle<api::SequenceObject>(sequence);
    const std::lock_guard lock(object->mutex);
    api::require_idle(*object);
    object->sequence->pass_by(api::find_handle<api::SceneObject>(scene)->snapshot(), copy);
  });
}

GradusError gradus_sequence_end_at(GradusSequence sequence, int32_t last) {
  return api::guard([&] {
    const auto object = api::find_handle<api::SequenceObject>(sequence);
    const std::lock_guard lock(object->mutex);
    api::require_idle(*object);
    object->sequence->end_at(last);
  });
}

GradusError gradus_sequence_warning(GradusSequence sequence, const char** text) {
  return api::guard([&] {
    api::require(text, "text") = nullptr;
    const auto object = api::find_handle<api::SequenceObject>(sequence);
    const std::lock_guard lock(object->mutex);
    api::require_idle(*object);
    object->sequence->warn_of_stale_frames(&object->warnings);
    api::take_warning(&object->warnings, text);
  });
}

GradusError gradus_sequence_deliver(GradusSequence sequence, int32_t frame, const GradusSettings* settings,
                                    GradusRender* render) {
  return api::guard([&] {
    api::require(render, "render") = 0;
    GradusSettings copy{};
    if (settings != nullptr) {
      copy = api::read_struct(settings, "settings", schema::default_settings());
      schema::check_settings(copy);
    }
    const auto object = api::find_handle<api::SequenceObject>(sequence);
    const std::lock_guard lock(object->mutex);
    api::require_idle(*object);
    *render = api::run(object.get(), object->sequence->deliver(frame, settings != nullptr ? &copy : nullptr));
  });
}

GradusError gradus_sequence_release(GradusSequence sequence) {
  return api::guard([&] {
    const auto object = api::remove_handle<api::SequenceObject>(sequence);
    const std::lock_guard lock(object->mutex);
    if (const auto running = object->running.lock()) {
      running->render.cancel();
      running->render.wait(-1.0);
    }
  });
}
