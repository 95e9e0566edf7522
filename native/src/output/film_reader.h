// A film that is developed when its passes are read.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "output/developer.h"

namespace gradus::scene {
class Device;
}  // namespace gradus::scene

namespace gradus::output {

// Thread-safe; a reader that needs a picture waits for the one that is being developed. The picture that was developed
// last is kept, so that readers of its passes do not develop it again. Light passes and components belong to it. Until
// there is one, the film is developed with its own options. The last reconstruction is kept as it was before the
// denoiser, too: it serves readers with another denoiser, and readers of the error.
class FilmReader {
 public:
  FilmReader(std::shared_ptr<const film::Film> film, std::shared_ptr<scene::Device> device);

  const std::shared_ptr<const film::Film>& film() const { return film_; }
  const Region& region() const { return region_; }

  // Develops the film, unless the last picture has these options. The options may be AUTO. Warnings go to the device. A
  // picture that the denoiser has failed to denoise counts as one without a denoiser.
  DevelopedFilm develop(const Options& options, bool with_error);
  // Returns the error that the picture with the film's own options has before the denoiser.
  Image error();
  // Write the pixels of the region, as DevelopedFilm does. Light groups belong to the last picture. Combined is
  // developed with the film's own options, and Error is error().
  void read_pass(uint32_t pass, float* pixels);
  void read_component(const std::string& name, uint32_t pass, float* pixels);
  void read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels);

 private:
  // Returns the film's own options, without a denoiser, and with a warning, where this machine lacks it.
  Options picture_options();
  // Returns the film's own options without a denoiser. They are not AUTO.
  Options own_options() const;

  // The caller of these three functions has locked mutex_. The options of reconstruct() are not AUTO, and their
  // denoiser is ignored. The error comes with the film's own reconstruction if the film has that pass, because it is
  // read later.
  DevelopedFilm reconstruct(const Options& options, bool with_error);
  DevelopedFilm make_picture(const Options& options, bool with_error);
  const DevelopedFilm& last_picture();

  DevelopedFilm copy_last_picture();
  DevelopedFilm copy_last_picture_with_light();

  const std::shared_ptr<const film::Film> film_;
  const std::shared_ptr<scene::Device> device_;
  const Region region_;
  const uint32_t threads_;
  std::atomic<bool> lacks_denoiser_{false};  // whether a warning has said that the denoiser is missing
  std::mutex mutex_;
  DevelopedFilm reconstructed_;  // last reconstruction; has no film until there is one
  DevelopedFilm last_;           // last picture; has no film until there is one
  Image error_;                  // nullptr until it is read
};

}  // namespace gradus::output
