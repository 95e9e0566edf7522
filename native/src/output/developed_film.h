// A film with the pictures that were developed of it (output/developer.h). It is the only reader of passes.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "film/film.h"
#include "output/options.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/solve_report.h"

namespace gradus::output {

using Image = std::shared_ptr<const std::vector<float>>;

inline Image make_image(std::vector<float> pixels) {
  return std::make_shared<const std::vector<float>>(std::move(pixels));
}

// Copies are cheap: images never change and are shared between the copies. Each image has the pixels of `region`, with
// the channels of its pass.
struct DevelopedFilm {
  std::shared_ptr<const film::Film> film;  // nullptr: nobody may read it, because it is still being sampled
  Region region;                           // delivered pixels
  uint32_t threads = 1;                    // threads that read passes of the film
  Options options{};                       // options with which the picture was made
  reconstruct::SolveReport solve{};        // how its reconstruction converged
  // What other frames have sampled of the picture, too, until it is denoised; null if no frames are joined.
  std::shared_ptr<const reconstruct::SampledPicture> sampled{};
  // Light passes as all joined frames have sampled them, until they are split; null if no frames are joined.
  std::shared_ptr<const reconstruct::SampledTerms> sampled_terms{};
  // Passes that are computed from the film: Combined, Error, light passes, and those that need several frames.
  std::map<uint32_t, Image> passes{};
  // Light groups, by the names of their channels.
  std::map<std::string, Image> light_groups{};
  // Passes of components, by index in film::Film::components and GradusComponentPass: Color, unless there is one
  // component only, which Combined shows; and motion by optical flow.
  std::map<std::pair<int, uint32_t>, Image> component_passes{};

  // Returns an image of `passes`, or nullptr if there is none.
  Image find(uint32_t pass) const;
  // Returns whether Combined is the noisy image, to which the light passes of the film itself belong.
  bool is_noisy() const {
    return options.reconstruction == GRADUS_RECONSTRUCTION_NONE && options.denoiser == GRADUS_DENOISER_NONE;
  }
  size_t memory_bytes() const;  // of the images

  // Writes the pixels of the region; row 0 is the bottom row. A pass that is not among the images is read from the
  // film; the noisy image and its error then serve as Combined and Error. Without a film the pixels are 0. Throws
  // invalid_operation if the film was sampled without the pass.
  void read_pass(uint32_t pass, float* pixels) const;
  // Writes a layer of a channel of GradusChannelKind `kind` in the same way. Throws invalid_argument if the film has no
  // such channel.
  void read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) const;
  // Writes a pass of a component in the same way. A component without any path has a background value. Throws
  // invalid_argument for a component that the film's settings do not have, invalid_operation if the film was sampled
  // without the data of the pass. A film of one frame holds the motion of the visible surfaces where optical flow would
  // need another frame, and marks these pixels as not tracked.
  void read_component(const std::string& name, uint32_t pass, float* pixels) const;

 private:
  // Returns RGB of a component.
  Image component_color(int component) const;
};

// Throws invalid_argument if the settings have no component of that name or do not use components at all.
void check_component(const GradusSettings& settings, const std::string& name);
// Fills the pixels of `region` with the background value of the pass, for a component without any path in the film.
void read_absent_component(uint32_t pass, const Region& region, float* pixels);

}  // namespace gradus::output
