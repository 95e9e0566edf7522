// gradus_render_*
#include "render/render.h"

#include "api/guard.h"
#include "api/objects.h"
#include "api/structs.h"
#include "schema/options.h"

using namespace gradus;

namespace gradus::api {
namespace {

std::shared_ptr<RenderObject> start(GradusScene scene, const GradusSettings* settings,
                                    std::shared_ptr<const film::Film> resumed) {
  const GradusSettings copy = read_struct(settings, "settings", schema::default_settings());
  const auto object = find_handle<SceneObject>(scene);
  return std::make_shared<RenderObject>(object->scene.device(), object->snapshot(), copy, std::move(resumed));
}

}  // namespace
}  // namespace gradus::api

GradusError gradus_render_start(GradusScene scene, const GradusSettings* settings, GradusRender* render) {
  return api::guard([&] {
    api::require(render, "render") = 0;
    *render = api::add_handle(api::start(scene, settings, nullptr));
  });
}

GradusError gradus_render_resume(GradusScene scene, const GradusSettings* settings, GradusFilm film,
                                 GradusRender* render) {
  return api::guard([&] {
    api::require(render, "render") = 0;
    *render = api::add_handle(api::start(scene, settings, api::find_handle<api::FilmObject>(film)->get()));
  });
}

GradusError gradus_render_poll(GradusRender render, GradusProgress* progress) {
  return api::guard(
      [&] { api::write_struct(progress, api::find_handle<api::RenderObject>(render)->render.progress(), "progress"); });
}

GradusError gradus_render_cancel(GradusRender render) {
  return api::guard([&] { api::find_handle<api::RenderObject>(render)->render.cancel(); });
}

GradusError gradus_render_wait(GradusRender render, double seconds) {
  return api::guard([&]() -> GradusError {
    const auto object = api::find_handle<api::RenderObject>(render);
    // Callers poll: an exception for each call would cost more than the call.
    if (!object->render.wait(seconds)) return GRADUS_TIMEOUT;
    std::string text;
    const GradusError code = object->render.outcome(&text);
    if (code != GRADUS_OK) throw Error(code, text);
    return GRADUS_OK;
  });
}

GradusError gradus_render_release(GradusRender render) {
  return api::guard([&] {
    const auto object = api::remove_handle<api::RenderObject>(render);
    // Another thread may wait in gradus_render_wait and hold the object: it gets CANCELLED, and nothing is sampled from
    // here on.
    object->render.cancel();
    object->render.wait(-1.0);
  });
}

GradusError gradus_render_read_pass(GradusRender render, uint32_t pass, float* pixels, size_t count) {
  return api::guard([&] {
    const auto object = api::find_handle<api::RenderObject>(render);
    api::check_array(pixels, count, "pixels");
    object->render.read_pass(pass, pixels, count);
  });
}

GradusError gradus_render_read_component(GradusRender render, const char* component, uint32_t pass, float* pixels,
                                         size_t count) {
  return api::guard([&] {
    const auto object = api::find_handle<api::RenderObject>(render);
    const std::string name = &api::require(component, "component");
    api::check_array(pixels, count, "pixels");
    object->render.read_component(name, pass, pixels, count);
  });
}

GradusError gradus_render_read_channel(GradusRender render, uint32_t kind, const char* name, uint32_t layer,
                                       float* pixels, size_t count) {
  return api::guard([&] {
    const auto object = api::find_handle<api::RenderObject>(render);
    api::check_array(pixels, count, "pixels");
    object->render.read_channel(kind, &api::require(name, "name"), layer, pixels, count);
  });
}

GradusError gradus_render_stats(GradusRender render, const char** json) {
  return api::guard([&] {
    api::require(json, "json") = nullptr;
    const auto object = api::find_handle<api::RenderObject>(render);
    const std::lock_guard lock(object->mutex);
    if (object->stats.empty()) object->stats = object->render.stats_json();
    *json = object->stats.c_str();
  });
}

GradusError gradus_render_film(GradusRender render, GradusFilm* film) {
  return api::guard([&] {
    api::require(film, "film") = 0;
    const auto from = api::find_handle<api::RenderObject>(render);
    *film = api::add_handle(std::make_shared<api::FilmObject>(from->device, from->render.film()));
  });
}
