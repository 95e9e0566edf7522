#include "output/film_reader.h"

#include "base/fault.h"
#include "output/denoise_combined.h"
#include "output/light_passes.h"
#include "output/pass_read.h"
#include "scene/device.h"
#include "schema/pass_table.h"

namespace gradus::output {

FilmReader::FilmReader(std::shared_ptr<const film::Film> film, std::shared_ptr<scene::Device> device)
    : film_(std::move(film)),
      device_(std::move(device)),
      region_(film::delivered_region(*film_)),
      threads_(threads_of(film_->settings, device_.get())) {}

DevelopedFilm FilmReader::make_picture(const Options& options, bool with_error) {
  std::string why_not;
  const auto library = choose_denoiser(options.denoiser, device_.get(), &why_not);
  const Options resolved = resolve_auto(options, facts_of(*film_, library != nullptr));
  Developer developer(
      threads_, [] { return false; }, library);
  DevelopedFilm developed{film_, region_, threads_, resolved};
  developer.reconstruct(&developed, {.error = with_error, .components = true});
  std::vector<std::string> warnings;
  developer.denoise(&developed, &warnings);
  for (const std::string& warning : warnings) device_->warnings().add(warning);
  return developed;
}

DevelopedFilm FilmReader::develop(const Options& options, bool with_error) {
  const DevelopedFilm developed = make_picture(options, with_error);
  if (!has_light_passes(*film_) && film_->components.size() == 1) return developed;
  const std::lock_guard lock(mutex_);
  if (GRADUS_FAULT(light_passes_keep_first_reconstruction) && last_.film) return developed;
  last_ = developed;
  last_.passes.erase(GRADUS_PASS_ERROR);
  return developed;
}

DevelopedFilm FilmReader::last_picture() {
  {
    const std::lock_guard lock(mutex_);
    if (last_.film) return last_;
  }
  return develop(options_of(film_->settings), false);
}

DevelopedFilm FilmReader::last_picture_with_light() {
  last_picture();
  const std::lock_guard lock(mutex_);
  Developer(threads_).split(&last_);
  return last_;
}

void FilmReader::read_pass(uint32_t pass, float* pixels) {
  Options own = options_of(film_->settings);
  if (pass == GRADUS_PASS_COMBINED) return develop(own, false).read_pass(pass, pixels);
  if (pass == GRADUS_PASS_ERROR) {
    own.denoiser = GRADUS_DENOISER_NONE;
    return make_picture(own, true).read_pass(pass, pixels);
  }
  if (schema::has_bit(schema::light_passes(), pass) && has_pass(*film_, pass))
    return last_picture_with_light().read_pass(pass, pixels);
  DevelopedFilm{film_, region_, threads_}.read_pass(pass, pixels);
}

void FilmReader::read_component(const std::string& name, uint32_t pass, float* pixels) {
  const bool is_of_picture = schema::is_of_picture(pass) && film::find_component(*film_, name) >= 0;
  if (is_of_picture) check_component(film_->settings, name);
  const DevelopedFilm developed = is_of_picture ? last_picture() : DevelopedFilm{film_, region_, threads_};
  developed.read_component(name, pass, pixels);
}

}  // namespace gradus::output
