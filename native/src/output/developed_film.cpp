#include "output/developed_film.h"

#include <algorithm>

#include "base/error.h"
#include "base/threads.h"
#include "film/region_pixels.h"
#include "film/scene_channels.h"
#include "lpe/components.h"
#include "motion/tracking.h"
#include "output/developer.h"
#include "output/pass_read.h"
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

// Returns whether a pass of a component is computed from two frames by optical flow (animation/component_flows.h).
bool is_by_flow(const std::string& component, uint32_t pass) {
  return schema::is_irradiance_motion(pass) || (schema::is_motion(pass) && component == lpe::kResidual);
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

// `color` is RGB of the component, for passes that derive from it; otherwise it may be nullptr.
void read_vertices(const film::Film& film, const film::ComponentPlanes& planes, const schema::ComponentPassInfo& info,
                   const Region& region, const Image& color, float* pixels) {
  if (planes.non_specular[0].empty()) throw not_asked_for(info);
  for_pixels(film, region, [&](size_t i, size_t out) {
    const float* const rgb = color ? color->data() + 3 * out : nullptr;
    const Vec3 light = rgb != nullptr ? Vec3(rgb[0], rgb[1], rgb[2]) : Vec3(0.0f);
    const Vec3 value = value_of(info.pass, mean_at(planes, i), light);
    std::copy_n(&value.x, info.channels, pixels + out * info.channels);
  });
}

Image rgb_of(const std::vector<float>& rgba) {
  std::vector<float> rgb(rgba.size() / 4 * 3);
  for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = rgba[i / 3 * 4 + i % 3];
  return make_image(std::move(rgb));
}

void copy(const std::vector<float>& image, float* pixels) { std::copy(image.begin(), image.end(), pixels); }

size_t bytes_of(const auto& images) {
  size_t values = 0;
  for (const auto& [key, image] : images) values += image->size();
  return values * sizeof(float);
}

}  // namespace

void check_component(const GradusSettings& settings, const std::string& name) {
  if (settings.use_decomposition == 0)
    throw invalid_argument("the picture was not taken apart into components: set use_decomposition");
  const lpe::ComponentSet set =
      lpe::ComponentSet::parse(schema::get_text(settings, *schema::find_option("components")));
  if (set.find(name) < 0) throw invalid_argument("there is no component " + name);
}

void read_absent_component(uint32_t pass, const Region& region, float* pixels) {
  const schema::ComponentPassInfo& info = schema::component_pass_info(pass);
  std::fill_n(pixels, size_t(region.area()) * info.channels, nothing_of(info));
}

Image DevelopedFilm::find(uint32_t pass) const {
  const auto found = passes.find(pass);
  return found != passes.end() ? found->second : nullptr;
}

size_t DevelopedFilm::memory_bytes() const {
  return bytes_of(passes) + bytes_of(light_groups) + bytes_of(component_passes);
}

void DevelopedFilm::read_pass(uint32_t pass, float* pixels) const {
  if (const Image image = find(pass)) return copy(*image, pixels);
  if (!film) {
    std::fill_n(pixels, size_t(region.area()) * schema::pass_info(pass).channels, 0.0f);
  } else if (pass == GRADUS_PASS_ERROR && schema::has_bit(film->settings.passes, pass)) {
    DevelopedFilm noisy{film, region, threads};
    Developer(threads).reconstruct(&noisy, {.error = true});
    copy(*noisy.find(pass), pixels);
  } else {
    tbb::task_arena(arena_size(threads)).execute([&] { read_film_pass(*film, pass, region, pixels); });
  }
}

void DevelopedFilm::read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) const {
  const std::string channel_name = film::channel_name(kind, name);
  if (const auto found = light_groups.find(channel_name); found != light_groups.end())
    return copy(*found->second, pixels);
  if (!film) return static_cast<void>(std::fill_n(pixels, size_t(region.area()) * film::values_of_layer(kind), 0.0f));
  const film::Channel* const channel = film->channels.find(channel_name);
  if (channel == nullptr) throw invalid_argument("the film has no channel " + channel_name);
  tbb::task_arena(arena_size(threads)).execute([&] { read_film_channel(*film, *channel, layer, region, pixels); });
}

void DevelopedFilm::read_component(const std::string& name, uint32_t pass, float* pixels) const {
  if (film) check_component(film->settings, name);
  const int component = film ? film::find_component(*film, name) : -1;
  if (component < 0) return read_absent_component(pass, region, pixels);
  const auto found = component_passes.find({component, pass});
  if (found != component_passes.end()) return copy(*found->second, pixels);
  const schema::ComponentPassInfo& info = schema::component_pass_info(pass);
  const film::ComponentPlanes& planes = film->components[size_t(component)];
  if (pass == GRADUS_COMPONENT_COLOR) return copy(*component_color(component), pixels);
  if (schema::is_motion(pass)) return read_motion(*film, planes, info, region, pixels);
  if (schema::is_of_non_specular_details(pass)) return read_details(*film, planes, info, region, pixels);
  const Image color = schema::is_of_picture(pass) ? component_color(component) : nullptr;
  read_vertices(*film, planes, info, region, color, pixels);
}

Image DevelopedFilm::component_color(int component) const {
  const auto found = component_passes.find({component, GRADUS_COMPONENT_COLOR});
  if (found != component_passes.end()) return found->second;
  const Image combined = find(GRADUS_PASS_COMBINED);
  if (combined && film->components.size() == 1) return rgb_of(*combined);
  if (!schema::needs_pictures(film->settings)) throw not_asked_for(schema::component_pass_info(GRADUS_COMPONENT_COLOR));
  // The render was cancelled before there was a picture, so what it delivers is the noisy image.
  DevelopedFilm noisy{film, region, threads};
  Developer(threads).reconstruct(&noisy, {.components = true});
  return noisy.component_color(component);
}

}  // namespace gradus::output
