// gradus_frame_*
#include "film/film.h"

#include <algorithm>

#include "api/guard.h"
#include "api/objects.h"
#include "api/structs.h"
#include "base/fault.h"
#include "base/fpu.h"
#include "base/threads.h"
#include "film/features.h"
#include "film_io/store.h"
#include "output/combine.h"
#include "output/component_read.h"
#include "output/denoise_combined.h"
#include "output/pass_read.h"
#include "reconstruct/reconstruct_film.h"
#include "render/plan.h"
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

uint32_t resolve(uint32_t reconstruction, const film::Film& film) {
  switch (reconstruction) {
    case GRADUS_RECONSTRUCTION_AUTO:
      if (film::has_features(film)) return GRADUS_RECONSTRUCTION_REGULARIZED;
      return film.gradients ? GRADUS_RECONSTRUCTION_L1 : GRADUS_RECONSTRUCTION_NONE;
    case GRADUS_RECONSTRUCTION_NONE:
    case GRADUS_RECONSTRUCTION_L2:
    case GRADUS_RECONSTRUCTION_L1:
    case GRADUS_RECONSTRUCTION_REGULARIZED:
      return reconstruction;
    default:
      throw invalid_argument("there is no reconstruction " + std::to_string(reconstruction));
  }
}

uint32_t threads_for(const FilmObject& object, const film::Film& film) {
  return film.settings.threads > 0 ? film.settings.threads : object.device->threads();
}

// Reconstructs and denoises the film. Writes the estimated error to `error` unless it is nullptr. Uses as many threads
// as a render with the film's settings.
DevelopedPicture develop_picture(FilmObject* object, const film::Film& film, uint32_t reconstruction, float alpha,
                                 uint32_t denoiser, float* error) {
  const auto never = [] { return false; };
  reconstruction = resolve(reconstruction, film);
  const uint32_t threads = threads_for(*object, film);
  std::string why_not;
  if (denoiser == GRADUS_DENOISER_AUTO && !render::denoiser_pays(film::mean_samples(film)))
    denoiser = GRADUS_DENOISER_NONE;
  const auto library = output::choose_denoiser(denoiser, object->device.get(), &why_not);
  std::vector<float> image, estimate;
  std::vector<std::vector<float>> components;
  tbb::task_arena arena(arena_size(threads));
  arena.execute([&] {
    const FlushDenormals flush;
    reconstruct::SolveReport report;
    image = output::combine(film, reconstruction, alpha, film::delivered_region(film), never, &report,
                            error != nullptr ? &estimate : nullptr, film.components.size() > 1 ? &components : nullptr);
  });
  if (library) {
    if (!film::has_features(film)) object->device->warnings().add("the frame holds no features to guide the denoiser");
    std::string failure;
    std::vector<float> denoised = output::denoise_combined(*library, film, reconstruction, film::delivered_region(film),
                                                           threads, never, image, &failure);
    if (denoised.empty()) {
      object->device->warnings().add(failure);
    } else {
      arena.execute([&] { output::follow_picture(image, denoised, &components); });
      image = std::move(denoised);
      for (float& value : estimate) value *= output::denoised_error(reconstruction);
    }
  }
  std::copy(estimate.begin(), estimate.end(), error);
  return {std::move(image), std::move(components), reconstruction == GRADUS_RECONSTRUCTION_NONE && !library, {}};
}

// Stores the picture, so that light passes and components that are read later belong to it.
std::shared_ptr<DevelopedPicture> store_developed(FilmObject* object, const std::shared_ptr<const film::Film>& film,
                                                  DevelopedPicture developed) {
  auto kept = std::make_shared<DevelopedPicture>(std::move(developed));
  const std::lock_guard lock(object->mutex);
  const bool is_done = GRADUS_FAULT(light_passes_keep_first_reconstruction) && object->developed;
  if (object->film == film && !is_done && (output::has_light_passes(*film) || film->components.size() > 1))
    object->developed = kept;
  return kept;
}

void reconstruct_into(FilmObject* object, const std::shared_ptr<const film::Film>& film, uint32_t reconstruction,
                      float alpha, uint32_t denoiser, float* rgba, float* error) {
  DevelopedPicture developed = develop_picture(object, *film, reconstruction, alpha, denoiser, error);
  std::copy(developed.rgba.begin(), developed.rgba.end(), rgba);
  store_developed(object, film, std::move(developed));
}

std::vector<float> read_error(FilmObject* object, const film::Film& film) {
  const GradusSettings& s = film.settings;
  std::vector<float> error(size_t(film::delivered_region(film).area()));
  develop_picture(object, film, s.reconstruction, s.reconstruction_alpha, GRADUS_DENOISER_NONE, error.data());
  return error;
}

// Returns the picture that was stored last. If there is none, develops the film with its own settings.
std::shared_ptr<DevelopedPicture> developed_picture_of(FilmObject* object,
                                                       const std::shared_ptr<const film::Film>& film) {
  {
    const std::lock_guard lock(object->mutex);
    if (object->film == film && object->developed) return object->developed;
  }
  const GradusSettings& s = film->settings;
  return store_developed(object, film,
                         develop_picture(object, *film, s.reconstruction, s.reconstruction_alpha, s.denoiser, nullptr));
}

// Reads a pass directly from the samples, with as many threads as a render with the film's settings.
void read_sampled(const FilmObject& object, const film::Film& film, uint32_t pass, float* pixels) {
  tbb::task_arena arena(arena_size(threads_for(object, film)));
  arena.execute([&] { output::read_film_pass(film, pass, film::delivered_region(film), pixels); });
}

void read_light(FilmObject* object, const std::shared_ptr<const film::Film>& film, uint32_t pass, float* pixels) {
  const std::shared_ptr<DevelopedPicture> developed = developed_picture_of(object, film);
  const Region region = film::delivered_region(*film);
  if (developed->is_noisy) return read_sampled(*object, *film, pass, pixels);
  const std::lock_guard lock(object->mutex);
  if (!developed->light) {
    tbb::task_arena(arena_size(threads_for(*object, *film))).execute([&] {
      const FlushDenormals flush;
      developed->light = output::LightPasses(*film, region, developed->rgba, [] { return false; });
    });
  }
  developed->light->read(pass, pixels);
}

std::vector<float> rgb_of(const std::vector<float>& rgba) {
  std::vector<float> rgb;
  for (size_t i = 0; i < rgba.size(); i += 4) rgb.insert(rgb.end(), {rgba[i], rgba[i + 1], rgba[i + 2]});
  return rgb;
}

std::vector<float> component_color(FilmObject* object, const std::shared_ptr<const film::Film>& film, int component) {
  const std::shared_ptr<DevelopedPicture> developed = developed_picture_of(object, film);
  return film->components.size() > 1 ? developed->components[size_t(component)] : rgb_of(developed->rgba);
}

}  // namespace
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
    api::require(film, "frame") = 0;
    auto object = std::make_shared<api::FilmObject>(api::find_handle<scene::Device>(device));
    const std::string file = &api::require(path, "path");
    object->device->arena().execute([&] { object->film = film_io::load_film(file); });
    for (const std::string& warning : film_io::load_header(file).warnings)
      object->device->warnings().add(file + ": " + warning);
    *film = api::add_handle(std::move(object));
  });
}

GradusError gradus_film_merge(GradusFilm film, GradusFilm other) {
  return api::guard([&] {
    const auto to = api::find_handle<api::FilmObject>(film);
    const std::shared_ptr<const film::Film> from = api::find_handle<api::FilmObject>(other)->get();
    const std::lock_guard lock(to->mutex);
    auto merged = std::make_shared<film::Film>(*to->film);
    render::merge_films(merged.get(), *from);
    to->film = std::move(merged);
    to->developed = nullptr;
  });
}

GradusError gradus_film_size(GradusFilm film, uint32_t* width, uint32_t* height) {
  return api::guard([&] {
    const Region region = film::delivered_region(*api::find_handle<api::FilmObject>(film)->get());
    api::require(width, "width") = uint32_t(region.width());
    api::require(height, "height") = uint32_t(region.height());
  });
}

GradusError gradus_film_reconstruct(GradusFilm film, uint32_t reconstruction, float alpha, uint32_t denoiser,
                                    float* rgba, size_t count, float* error) {
  return api::guard([&] {
    const auto object = api::find_handle<api::FilmObject>(film);
    const std::shared_ptr<const film::Film> content = object->get();
    api::check_count(count, film::delivered_region(*content), 4);
    api::check_array(rgba, count, "rgba");
    if (error != nullptr) api::check_array(error, count / 4, "error");
    schema::check_alpha(alpha);
    api::reconstruct_into(object.get(), content, reconstruction, alpha, denoiser, rgba, error);
  });
}

GradusError gradus_film_read_pass(GradusFilm film, uint32_t pass, float* pixels, size_t count) {
  return api::guard([&] {
    const auto object = api::find_handle<api::FilmObject>(film);
    const std::shared_ptr<const film::Film> content = object->get();
    const Region region = film::delivered_region(*content);
    api::check_count(count, region, schema::pass_info(pass).channels);
    api::check_array(pixels, count, "pixels");
    const GradusSettings& s = content->settings;
    if (pass == GRADUS_PASS_COMBINED) {
      return api::reconstruct_into(object.get(), content, s.reconstruction, s.reconstruction_alpha, s.denoiser, pixels,
                                   nullptr);
    }
    if (pass == GRADUS_PASS_ERROR)
      return static_cast<void>(std::ranges::copy(api::read_error(object.get(), *content), pixels));
    if (schema::has_bit(schema::light_passes(), pass) && output::has_pass(*content, pass))
      return api::read_light(object.get(), content, pass, pixels);
    api::read_sampled(*object, *content, pass, pixels);
  });
}

GradusError gradus_film_read_component(GradusFilm film, const char* component, uint32_t pass, float* pixels,
                                       size_t count) {
  return api::guard([&] {
    const auto object = api::find_handle<api::FilmObject>(film);
    const std::shared_ptr<const film::Film> content = object->get();
    const std::string name = &api::require(component, "component");
    const Region region = film::delivered_region(*content);
    api::check_count(count, region, schema::component_pass_info(pass).channels);
    api::check_array(pixels, count, "pixels");
    output::check_component(content->settings, name);
    const int place = film::find_component(*content, name);
    if (place < 0) return output::read_absent_component(pass, region, pixels);
    const std::vector<float> color =
        schema::is_of_picture(pass) ? api::component_color(object.get(), content, place) : std::vector<float>();
    output::read_component_pass(*content, place, pass, region, color, pixels);
  });
}

GradusError gradus_film_release(GradusFilm film) {
  return api::guard([&] { api::remove_handle<api::FilmObject>(film); });
}
