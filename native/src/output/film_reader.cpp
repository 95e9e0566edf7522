#include "output/film_reader.h"

#include <utility>

#include "base/fault.h"
#include "output/denoise_combined.h"
#include "output/light_passes.h"
#include "output/pass_read.h"
#include "scene/device.h"
#include "schema/pass_table.h"

namespace gradus::output {
namespace {

// Returns whether the film has been developed with these options, which are not AUTO.
bool shows(const DevelopedFilm& developed, const Options& options, bool with_error) {
  return developed.film && developed.options == options && (!with_error || developed.find(GRADUS_PASS_ERROR));
}

}  // namespace

FilmReader::FilmReader(std::shared_ptr<const film::Film> film, std::shared_ptr<scene::Device> device)
    : film_(std::move(film)),
      device_(std::move(device)),
      region_(film::delivered_region(*film_)),
      threads_(threads_of(film_->settings, device_.get())) {}

Options FilmReader::own_options() const {
  Options own = options_of(film_->settings);
  own.denoiser = GRADUS_DENOISER_NONE;
  return resolve_auto(own, facts_of(*film_, false));
}

Options FilmReader::picture_options() {
  Options own = options_of(film_->settings);
  std::string why_not;
  if (own.denoiser == GRADUS_DENOISER_OIDN && !choose_denoiser(GRADUS_DENOISER_AUTO, device_.get(), &why_not)) {
    own.denoiser = GRADUS_DENOISER_NONE;
    if (!lacks_denoiser_.exchange(true))
      device_->warnings().add("the picture is not denoised, as its render was: " + why_not);
  }
  return own;
}

DevelopedFilm FilmReader::reconstruct(const Options& options, bool with_error) {
  Options without_denoiser = options;
  without_denoiser.denoiser = GRADUS_DENOISER_NONE;
  if (shows(reconstructed_, without_denoiser, with_error)) return reconstructed_;
  const bool reads_error_later = without_denoiser == own_options() && wanted_images(film_->settings).error;
  DevelopedFilm developed{film_, region_, threads_, without_denoiser};
  Developer(threads_).reconstruct(&developed, {.error = with_error || reads_error_later, .components = true});
  return reconstructed_ = developed;
}

DevelopedFilm FilmReader::make_picture(const Options& options, bool with_error) {
  std::string why_not;
  const auto library = choose_denoiser(options.denoiser, device_.get(), &why_not);
  const Options resolved = resolve_auto(options, facts_of(*film_, library != nullptr));
  if (shows(last_, resolved, with_error)) return last_;
  DevelopedFilm developed = reconstruct(resolved, with_error);
  developed.options = resolved;
  const auto never = [] { return false; };
  std::vector<std::string> warnings;
  Developer(threads_, never, library).denoise(&developed, &warnings);
  for (const std::string& warning : warnings) device_->warnings().add(warning);
  return developed;
}

DevelopedFilm FilmReader::develop(const Options& options, bool with_error) {
  const std::lock_guard lock(mutex_);
  const DevelopedFilm developed = make_picture(options, with_error);
  if (GRADUS_FAULT(light_passes_keep_first_reconstruction) && last_.film) return developed;
  return last_ = developed;
}

Image FilmReader::error() {
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = reconstruct(own_options(), true).find(GRADUS_PASS_ERROR);
  return error_;
}

const DevelopedFilm& FilmReader::last_picture() {
  if (!last_.film) last_ = make_picture(picture_options(), false);
  return last_;
}

DevelopedFilm FilmReader::copy_last_picture() {
  const std::lock_guard lock(mutex_);
  return last_picture();
}

DevelopedFilm FilmReader::copy_last_picture_with_light() {
  const std::lock_guard lock(mutex_);
  last_picture();
  Developer(threads_).split(&last_);
  return last_;
}

void FilmReader::read_pass(uint32_t pass, float* pixels) {
  if (pass == GRADUS_PASS_COMBINED) return develop(picture_options(), false).read_pass(pass, pixels);
  DevelopedFilm developed{film_, region_, threads_};
  if (pass == GRADUS_PASS_ERROR) developed.passes[pass] = error();
  if (schema::has_bit(schema::light_passes(), pass) && has_pass(*film_, pass))
    developed = copy_last_picture_with_light();
  developed.read_pass(pass, pixels);
}

void FilmReader::read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) {
  const DevelopedFilm developed =
      kind == GRADUS_CHANNEL_LIGHT_GROUP ? copy_last_picture_with_light() : DevelopedFilm{film_, region_, threads_};
  developed.read_channel(kind, name, layer, pixels);
}

void FilmReader::read_component(const std::string& name, uint32_t pass, float* pixels) {
  const bool is_of_picture = schema::is_of_picture(pass) && film::find_component(*film_, name) >= 0;
  if (is_of_picture) check_component(film_->settings, name);
  const DevelopedFilm developed = is_of_picture ? copy_last_picture() : DevelopedFilm{film_, region_, threads_};
  developed.read_component(name, pass, pixels);
}

}  // namespace gradus::output
