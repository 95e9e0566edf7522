// A material as the snapshot keeps it: compiled programs, and what the rest of the renderer may know without running
// them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "bsdf/closures.h"
#include "gradus/gradus.h"
#include "shading/program.h"
#include "shading/sky/sky.h"

namespace gradus::image {
class ImageStore;
}  // namespace gradus::image

namespace gradus::shading {

// Immutable. All flags are conservative: false means "surely not".
struct MaterialData {
  std::string name;
  Program surface;       // all closures
  Program emission;      // emission alone: what light sampling and the world need
  Program transparency;  // transparent closures alone: what shadow rays need

  bool emits = false;
  bool may_be_transparent = false;  // some light goes straight through
  bool has_holdout = false;
  bool has_bsdf = false;
  bool may_transmit = false;       // some lobe sends light to the other side
  bool transparent_shadow = true;  // 0: shadow rays take it for opaque
  bool sample_as_light = true;
  bool uses_fallback = false;
  bool depends_on_ray = false;      // uses Light Path, or the direction it is seen from, in emission
  bool values_look_at_ray = false;  // some value of `surface` does; closures aside
  bool depends_on_kind =
      false;               // emission or transparency look at the kind of ray beyond camera or not, or at its depth
  float min_alpha = 1.0f;  // of all lobes, where known; 0 where a texture decides
  float min_refracting_alpha = kInfinity;  // likewise, of lobes that refract; infinite where there is none
  bool emission_is_constant = false;       // over points and directions; then:
  Rgb constant_emission = Rgb(0.0f);
  bool transparency_is_constant = false;
  Rgb constant_transparency = Rgb(0.0f);
  float emission_estimate =
      0.0f;                 // luminance for the choice of lights: exact where constant, else textures at their mean
  bool is_lambert = false;  // the surface is one Lambert lobe of constant colour with the surface's normal; then:
  bsdf::Lobe lambert;       // all but its normal
  int32_t pass_index = 0;
  std::vector<SunDisc> suns;              // of its Sky Textures, if it is the world
  float smallest_hidden_sun = 0.0f;       // half angle of one whose place is unknown; 0: there is none
  std::vector<std::string> tangent_maps;  // names of UV maps ("": the default) whose tangents it asks for
};

// Compiles a node program: folds constants, drops what nothing needs, allots registers. Throws Error INVALID_ARGUMENT,
// with the material's name, for what is not a program (check_program()) or needs more closures, Bump nodes or registers
// than there are. Image keys that the store does not know look magenta.
std::shared_ptr<const MaterialData> compile_material(const GradusMaterial& desc, const image::ImageStore& images);
// What stands for a material that does not compile: the default one under its name.
std::shared_ptr<const MaterialData> fallback_material(const GradusMaterial& desc);
// Diffuse 0.8: surfaces without a material.
std::shared_ptr<const MaterialData> default_material();

}  // namespace gradus::shading
