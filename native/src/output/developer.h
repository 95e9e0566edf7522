// Develops films: from samples to the passes that are delivered, for stills, previews, animations and stored films.
//
// The steps are reconstruct, denoise, split. Each replaces images of a DevelopedFilm and leaves those that others may
// still be reading.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <tbb/task_arena.h>

#include "base/cancel_check.h"
#include "film/film.h"
#include "output/developed_film.h"
#include "output/oidn_library.h"
#include "reconstruct/reconstruct_film.h"

namespace gradus::output {

// Returns the images that the settings of a film ask for beside its picture.
reconstruct::ReconstructionOutputs wanted_images(const GradusSettings& settings);

class Developer {
 public:
  // Returns reconstructed images of the whole film region. Those of an animation are made from several
  // frames.
  using Source = std::function<reconstruct::Reconstructed(reconstruct::SolveReport* report)>;

  // `denoiser` may be nullptr if no options name one. The steps run on `threads` threads and throw Error CANCELLED if
  // `cancel` returns true.
  explicit Developer(
      uint32_t threads, CancelCheck cancel = [] { return false; },
      std::shared_ptr<const OidnLibrary> denoiser = nullptr);

  // Reconstructs Combined, and what is wanted of its error and its components, with the options of `developed`, which
  // are not AUTO. The images come from `source`, or from the film alone if there is none. The colours of L2 may be
  // negative, those of the other reconstructions are at least 0; alpha lies within its bounds (output/alpha_bounds.h).
  // The error is the estimated squared error of each pixel, as the mean over RGB. Throws invalid_operation if the film
  // lacks the data that the reconstruction reads.
  void reconstruct(DevelopedFilm* developed, const reconstruct::ReconstructionOutputs& wanted = {},
                   const Source& source = nullptr);
  // Denoises Combined if the options say so. Components are adapted so that they still add up to it, and the error is
  // scaled. Returns false if the picture is as before; if the denoiser fails, the cause is added to `warnings`, and the
  // denoiser of `developed` becomes NONE. It must be called from outside of TBB arenas.
  bool denoise(DevelopedFilm* developed, std::vector<std::string>* warnings);
  // Splits Combined into the light passes that the film has, unless they are there. Nothing is done for the noisy
  // image, because the light passes of the film itself belong to it.
  void split(DevelopedFilm* developed);

  // Returns name and version of the denoiser. There must be one.
  std::string denoiser_name() const { return denoiser_->name(); }

 private:
  // Calls the function in the arena. All of its threads flush denormals.
  template <class Function>
  void run(const Function& function);

  const uint32_t threads_;
  const CancelCheck cancel_;
  const std::shared_ptr<const OidnLibrary> denoiser_;
  tbb::task_arena arena_;
};

}  // namespace gradus::output
