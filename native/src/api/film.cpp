// gradus_film_*
#include "film/film.h"

#include "api/guard.h"
#include "api/objects.h"
#include "api/structs.h"
#include "film/scene_channels.h"
#include "film_io/store.h"
#include "render/resume.h"
#include "schema/options.h"
#include "schema/pass_table.h"

using namespace gradus;

namespace gradus::api {
namespace {

void check_count(size_t count, const Region& region, uint32_t channels) {
  const size_t expected = size_t(region.area()) * channels;
  if (count != expected)
    throw invalid_argument("expected " + std::to_string(expected) + " floats, " + std::to_string(count) +
                           " were given");
}

}  // namespace

void FilmObject::merge(const film::Film& other) {
  const std::lock_guard merge_lock(merge_mutex_);
  auto merged = std::make_shared<film::Film>(*get());
  device->arena().execute([&] { render::merge_films(merged.get(), other); });
  std::shared_ptr<output::FilmReader> reader = make_reader(std::move(merged));
  const std::lock_guard lock(mutex_);
  reader_.swap(reader);  // the reader of before ends after the lock
}

}  // namespace gradus::api

GradusError gradus_film_save(GradusFilm film, const char* path) {
  return api::guard([&] {
    const auto object = api::find_handle<api::FilmObject>(film);
    const std::string file = &api::require(path, "path");
    object->device->arena().execute([&] { film_io::save_film(*object->get(), file); });
  });
}

GradusError gradus_film_load(GradusDevice device, const char* path, GradusFilm* film) {
  return api::guard([&] {
    api::require(film, "film") = 0;
    const auto shared_device = api::find_handle<scene::Device>(device);
    const std::string file = &api::require(path, "path");
    std::shared_ptr<const film::Film> loaded;
    shared_device->arena().execute([&] { loaded = film_io::load_film(file); });
    for (const std::string& warning : film_io::load_header(file).warnings)
      shared_device->warnings().add(file + ": " + warning);
    *film = api::add_handle(std::make_shared<api::FilmObject>(shared_device, std::move(loaded)));
  });
}

GradusError gradus_film_merge(GradusFilm film, GradusFilm other) {
  return api::guard([&] {
    const auto to = api::find_handle<api::FilmObject>(film);
    to->merge(*api::find_handle<api::FilmObject>(other)->get());
  });
}

GradusError gradus_film_size(GradusFilm film, uint32_t* width, uint32_t* height) {
  return api::guard([&] {
    const Region region = api::find_handle<api::FilmObject>(film)->reader()->region();
    api::require(width, "width") = uint32_t(region.width());
    api::require(height, "height") = uint32_t(region.height());
  });
}

GradusError gradus_film_reconstruct(GradusFilm film, uint32_t reconstruction, float alpha, uint32_t denoiser,
                                    float* rgba, size_t count, float* error) {
  return api::guard([&] {
    const auto reader = api::find_handle<api::FilmObject>(film)->reader();
    api::check_count(count, reader->region(), 4);
    api::check_array(rgba, count, "rgba");
    if (error != nullptr) api::check_array(error, count / 4, "error");
    schema::check_alpha(alpha);
    const output::DevelopedFilm developed = reader->develop({reconstruction, alpha, denoiser}, error != nullptr);
    developed.read_pass(GRADUS_PASS_COMBINED, rgba);
    if (error != nullptr) developed.read_pass(GRADUS_PASS_ERROR, error);
  });
}

GradusError gradus_film_read_pass(GradusFilm film, uint32_t pass, float* pixels, size_t count) {
  return api::guard([&] {
    const auto reader = api::find_handle<api::FilmObject>(film)->reader();
    api::check_count(count, reader->region(), schema::pass_info(pass).channels);
    api::check_array(pixels, count, "pixels");
    reader->read_pass(pass, pixels);
  });
}

GradusError gradus_film_read_component(GradusFilm film, const char* component, uint32_t pass, float* pixels,
                                       size_t count) {
  return api::guard([&] {
    const auto reader = api::find_handle<api::FilmObject>(film)->reader();
    const std::string name = &api::require(component, "component");
    api::check_count(count, reader->region(), schema::component_pass_info(pass).channels);
    api::check_array(pixels, count, "pixels");
    reader->read_component(name, pass, pixels);
  });
}

GradusError gradus_film_read_channel(GradusFilm film, uint32_t kind, const char* name, uint32_t layer, float* pixels,
                                     size_t count) {
  return api::guard([&] {
    const auto reader = api::find_handle<api::FilmObject>(film)->reader();
    api::check_count(count, reader->region(), film::values_of_layer(kind));
    api::check_array(pixels, count, "pixels");
    reader->read_channel(kind, &api::require(name, "name"), layer, pixels);
  });
}

GradusError gradus_film_release(GradusFilm film) {
  return api::guard([&] { api::remove_handle<api::FilmObject>(film); });
}
