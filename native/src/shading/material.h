// A compiled material: node programs, and properties that the renderer can read without running them.
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

// Name of surfaces without a material in Cryptomattes, as in Cycles.
inline constexpr const char* kDefaultMaterialName = "default_surface";

// An immutable compiled material. The flags are conservative: false is certain, true means "possibly".
struct MaterialData {
  std::string name;
  float cryptomatte = 0.0f;  // identifier of the name
  Program surface;           // program of all closures
  Program emission;          // program of the emission alone, for light sampling and the world
  Program transparency;      // program of the transparent closures alone, for shadow rays
  Program aovs;              // program of the outputs to AOVs alone
  Program displacement;      // program of the displacement of vertices in world space; without blocks: there is none
  Program bump;              // program of the displacement that bends the shading normal in the same way

  bool emits = false;
  bool may_be_transparent = false;  // some light passes straight through, or through a portal
  bool has_portal = false;
  bool has_holdout = false;
  bool has_bsdf = false;
  bool has_glossy = false;         // some lobe is that of a glossy, metallic or refracting surface, rough or not
  bool may_transmit = false;       // some lobe scatters light to the other side
  bool transparent_shadow = true;  // false if shadow rays treat the material as opaque
  bool sample_as_light = true;
  bool uses_fallback = false;              // some node was replaced, or the material did not compile
  bool is_diffuse_behind_diffuse = false;  // its subsurface scattering is diffuse behind a diffuse bounce
  bool bumps_subsurface = false;           // light that leaves the material from below has a normal from its nodes
  bool displaces = false;                  // `displacement` moves vertices
  bool bumps = false;                      // `bump` bends the shading normal
  bool bumps_emission = false;             // `emission` reads the normal that `bump` bends
  bool bumps_transparency = false;         // `transparency` reads it
  bool bumps_aovs = false;                 // `aovs` reads it
  bool bumps_moved_faces = false;          // the bump of a flat face starts from its displaced normal
  float bump_filter_width = 1.0f;          // step of the finite differences of that bump, in pixels
  uint32_t shading_normals = GRADUS_SHADING_NORMALS_SINCE_4_5;
  bool values_depend_on_ray = false;  // some value of `surface` depends on the ray; closures themselves do not count
  bool draws_random = false;          // some value of `surface` depends on random numbers of the path
  bool depends_on_kind =
      false;               // emission or transparency read the ray's depth, or its kind other than camera or shadow
  float min_alpha = 1.0f;  // smallest alpha of all lobes; 0 if a texture decides
  float min_refracting_alpha = kInfinity;  // smallest alpha of the lobes that refract; infinite if there is none
  bool emission_is_constant = false;       // the emission is constant_emission at all points and directions
  Rgb constant_emission = Rgb(0.0f);
  bool transparency_is_constant = false;  // the transparency is constant_transparency at all points and directions
  Rgb constant_transparency = Rgb(0.0f);
  float emission_estimate = 0.0f;  // luminance for light selection: exact if constant, else with textures at their mean
  bool is_lambert = false;         // the surface is the single lobe `lambert` with the surface's normal
  bsdf::Lobe lambert;              // the Lambert lobe of constant colour, without its normal
  int32_t pass_index = 0;
  std::vector<SunDisc> suns;              // sun discs of the material's Sky Textures
  float smallest_hidden_sun = 0.0f;       // half angle of the smallest sun at an unknown position; 0 if there is none
  std::vector<std::string> tangent_maps;  // UV maps whose tangents the surface or an AOV reads; "" is the default map
  std::vector<uint32_t> averaged_images;  // in the store: those of which a look-up may average texels
};

// Compiles a node program: evaluates constant nodes, omits nodes without effect, and allocates registers. Throws Error
// INVALID_ARGUMENT, with the material's name, if the program is invalid (check_program()) or needs too many closures,
// Bump nodes or registers. Images that the store does not contain are magenta.
std::shared_ptr<const MaterialData> compile_material(const GradusMaterial& desc, const image::ImageStore& images);
// Returns the replacement of a material that does not compile: the default material with the material's name.
std::shared_ptr<const MaterialData> fallback_material(const GradusMaterial& desc);
// Returns the material of surfaces without one: diffuse with an albedo of 0.8.
std::shared_ptr<const MaterialData> default_material();

}  // namespace gradus::shading
