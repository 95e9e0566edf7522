#include "output/component_read.h"

#include <algorithm>

#include "base/error.h"
#include "film/region_pixels.h"
#include "lpe/components.h"
#include "motion/tracking.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::output {
namespace {

// Smallest reflectance by which colour is divided. Darker surfaces carry no information about their irradiance.
constexpr float kMinReflectance = 1e-3f;

// Returns the mean over the samples that reached a non-specular vertex, or 0 if there are none.
film::NonSpecularVertices mean_at(const film::ComponentPlanes& planes, size_t i) {
  const film::NonSpecularVertices &a = planes.non_specular[0][i], &b = planes.non_specular[1][i];
  const float samples = a.samples + b.samples, factor = samples > 0.0f ? 1.0f / samples : 0.0f;
  return {factor * (a.reflectance + b.reflectance), factor * (a.normal + b.normal),
          factor * (a.inverse_depth + b.inverse_depth), samples};
}

Vec3 value_of(uint32_t pass, const film::NonSpecularVertices& mean, const Vec3& color) {
  if (pass == GRADUS_COMPONENT_DEPTH) return Vec3(1.0f / std::max(mean.inverse_depth, 1.0f / schema::kFarDepth));
  if (pass == GRADUS_COMPONENT_REFLECTANCE) return mean.reflectance;
  if (pass == GRADUS_COMPONENT_NORMAL) return mean.normal;
  Vec3 irradiance = color;
  for (int c = 0; c < 3; ++c) irradiance[c] /= mean.reflectance[c] >= kMinReflectance ? mean.reflectance[c] : 1.0f;
  return irradiance;
}

Vec3 value_of(uint32_t pass, const film::NonSpecularDetails& details, float exposure) {
  if (pass == GRADUS_COMPONENT_OBJECT_INDEX) return Vec3(details.object);
  if (pass == GRADUS_COMPONENT_FACE_INDEX) return Vec3(details.face);
  const float factor = details.segments > 0.0f ? 1.0f / details.segments : 0.0f;
  return pass == GRADUS_COMPONENT_UV ? factor * details.uv : exposure * (factor * details.emission);
}

// Returns the value of a pass where the component has no paths.
float nothing_of(const schema::ComponentPassInfo& info) {
  if (info.pass == GRADUS_COMPONENT_DEPTH) return schema::kFarDepth;
  if (info.pass == GRADUS_COMPONENT_FACE_INDEX) return schema::kNoFace;
  return schema::is_motion(info.pass) && info.channels == 1 ? film::kNothingToTrack : 0.0f;
}

Error not_asked_for(const schema::ComponentPassInfo& info) {
  return invalid_operation("pass " + std::string(info.name) + " of components was not asked for");
}

// Returns the tracking state of a pixel when only one frame exists: optical flow needs two frames, so a tracked pixel
// is reported as having no neighbour.
float tracked_in_one_frame(float tracked, bool by_flow) {
  return by_flow && tracked == motion::kTracked ? motion::kNoNeighbour : tracked;
}

void read_motion(const film::Film& film, const film::ComponentPlanes& planes, const schema::ComponentPassInfo& info,
                 const Region& region, float* pixels) {
  const bool by_flow = is_by_flow(planes.name, info.pass);
  if (planes.motion.empty()) throw not_asked_for(info);
  for_pixels(film, region, [&](size_t i, size_t out) {
    if (info.channels == 1) pixels[out] = tracked_in_one_frame(planes.tracked[i], by_flow);
    if (info.channels == 4) std::copy_n(&planes.motion[i][0], 4, pixels + 4 * out);
  });
}

void read_details(const film::Film& film, const film::ComponentPlanes& planes, const schema::ComponentPassInfo& info,
                  const Region& region, float* pixels) {
  if (planes.details.empty()) throw not_asked_for(info);
  for_pixels(film, region, [&](size_t i, size_t out) {
    const Vec3 value = value_of(info.pass, planes.details[i], film.settings.film_exposure);
    std::copy_n(&value.x, info.channels, pixels + out * info.channels);
  });
}

}  // namespace

bool is_by_flow(const std::string& component, uint32_t pass) {
  return schema::is_irradiance_motion(pass) || (schema::is_motion(pass) && component == lpe::kResidual);
}

void read_absent_component(uint32_t pass, const Region& region, float* pixels) {
  const schema::ComponentPassInfo& info = schema::component_pass_info(pass);
  std::fill_n(pixels, size_t(region.area()) * info.channels, nothing_of(info));
}

void check_component(const GradusSettings& settings, const std::string& name) {
  if (settings.use_decomposition == 0)
    throw invalid_argument("the picture was not taken apart into components: set use_decomposition");
  const lpe::ComponentSet set =
      lpe::ComponentSet::parse(schema::get_text(settings, *schema::find_option("components")));
  if (set.find(name) < 0) throw invalid_argument("there is no component " + name);
}

void read_component_pass(const film::Film& film, int component, uint32_t pass, const Region& region,
                         const std::vector<float>& color, float* pixels) {
  const schema::ComponentPassInfo& info = schema::component_pass_info(pass);
  if (pass == GRADUS_COMPONENT_COLOR) return static_cast<void>(std::copy(color.begin(), color.end(), pixels));
  const film::ComponentPlanes& planes = film.components[size_t(component)];
  if (schema::is_motion(pass)) return read_motion(film, planes, info, region, pixels);
  if (schema::is_of_non_specular_details(pass)) return read_details(film, planes, info, region, pixels);
  if (planes.non_specular[0].empty()) throw not_asked_for(info);
  for_pixels(film, region, [&](size_t i, size_t out) {
    const Vec3 light =
        schema::is_of_picture(pass) ? Vec3(color[3 * out], color[3 * out + 1], color[3 * out + 2]) : Vec3(0.0f);
    const Vec3 value = value_of(pass, mean_at(planes, i), light);
    std::copy_n(&value.x, info.channels, pixels + out * info.channels);
  });
}

}  // namespace gradus::output
