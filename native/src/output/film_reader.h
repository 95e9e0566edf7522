// A film that is developed when its passes are read.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "output/developer.h"

namespace gradus::scene {
class Device;
}  // namespace gradus::scene

namespace gradus::output {

// Thread-safe. Light passes and components belong to the picture that was developed last. Until there is one, the film
// is developed with its own options.
class FilmReader {
 public:
  FilmReader(std::shared_ptr<const film::Film> film, std::shared_ptr<scene::Device> device);

  const std::shared_ptr<const film::Film>& film() const { return film_; }
  const Region& region() const { return region_; }

  // Develops the film. The options may be AUTO. Warnings go to the device.
  DevelopedFilm develop(const Options& options, bool with_error);
  // Write the pixels of the region, as DevelopedFilm does. Combined is developed with the film's own options, and Error
  // is that of this reconstruction before the denoiser.
  void read_pass(uint32_t pass, float* pixels);
  void read_component(const std::string& name, uint32_t pass, float* pixels);

 private:
  DevelopedFilm make_picture(const Options& options, bool with_error);
  // Returns the picture that was developed last, or develops one.
  DevelopedFilm last_picture();
  DevelopedFilm last_picture_with_light();

  const std::shared_ptr<const film::Film> film_;
  const std::shared_ptr<scene::Device> device_;
  const Region region_;
  const uint32_t threads_;
  std::mutex mutex_;
  DevelopedFilm last_;  // has no film until a picture is kept; only pictures with light passes or components are
};

}  // namespace gradus::output
