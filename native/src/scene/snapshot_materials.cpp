// Loading of images and compilation of materials in a commit. Unchanged ones are reused from the previous commit.
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "base/error.h"
#include "image/coarser_tile.h"
#include "scene/device.h"
#include "scene/scene_state.h"
#include "shading/material.h"

namespace gradus::scene {

namespace {

// New images whose pixels are equal.
using EqualImages = std::vector<LoadedImage*>;

// Decodes images. All share the same pixels, unless warnings name the images that they come from.
void load_equal(const EqualImages& images, const image::ColorManager& color) {
  std::shared_ptr<const image::Image> shared;
  for (LoadedImage* image : images) {
    image->image = shared ? shared : image::load_image(image->source, color);
    if (image->image->warnings.empty()) shared = image->image;
  }
}

// Decodes new images in parallel. They share no pixels with those that are there, whose files may have changed since.
void load_new_images(Device& device, Scene::State* state, const CommitMonitor& monitor) {
  using Content = decltype(std::declval<const image::ImageSource>().content());
  std::map<Content, EqualImages> by_content;
  for (auto& [key, image] : state->images)
    if (!image.image) by_content[image.source.content()].push_back(&image);
  std::vector<const EqualImages*> pending;
  for (const auto& [content, images] : by_content) pending.push_back(&images);
  tbb::parallel_for(size_t(0), pending.size(), [&](size_t i) {
    if (monitor.is_running()) load_equal(*pending[i], device.color());
  });
  monitor.check();
}

// Largest light of a constant emission, so that sums over samples stay below those that the film accepts.
constexpr float kStrongestEmission = 1e30f;

// Makes a constant emission black if it is not finite, as Cycles does, and limits it if it is too strong. Returns a
// warning, or "" if the emission stays as it is.
std::string limit_emission(std::shared_ptr<const shading::MaterialData>* data) {
  const Rgb emission = (*data)->constant_emission;
  const Rgb limited = is_finite(emission) ? glm::clamp(emission, -kStrongestEmission, kStrongestEmission) : Rgb(0.0f);
  if (!(*data)->emission_is_constant || limited == emission) return "";
  auto changed = std::make_shared<shading::MaterialData>(**data);
  changed->constant_emission = limited;
  changed->emission_estimate = luminance(limited);
  *data = std::move(changed);
  return "the emission of '" + (*data)->name + "' " +
         (is_finite(emission) ? "is too strong and was limited" : "was left out: it is not finite");
}

// Compiles a material. If that fails, a fallback replaces it. `warning` says so, or how its emission was changed.
CompiledMaterial compile(const std::shared_ptr<const MaterialSource>& source, const image::ImageStore& images) {
  const GradusMaterial desc = source->view();
  try {
    CompiledMaterial material{source, shading::compile_material(desc, images), ""};
    material.warning = limit_emission(&material.data);
    return material;
  } catch (const Error& error) {
    if (error.code() != GRADUS_ERROR_INVALID_ARGUMENT) throw;
    return {source, shading::fallback_material(desc), std::string(error.what()) + "; it is rendered grey"};
  }
}

StoredImages loaded_images(const Scene::State& state) {
  StoredImages images;
  for (const auto& [key, image] : state.images) images.emplace_hint(images.end(), key, image.image);
  return images;
}

}  // namespace

void load_images(Device& device, const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot) {
  load_new_images(device, state, monitor);
  StoredImages images = loaded_images(*state);
  // They are compared with the last complete commit, because a commit that was cancelled may have loaded images, too.
  if (!state->image_store || images != state->stored_images) {
    auto store = std::make_shared<image::ImageStore>();
    for (const auto& [key, image] : images) store->add(key, image);
    state->image_store = std::move(store);
    state->stored_images = std::move(images);
    // Programs that use images are compiled again, because constants from an image may be folded into them. Others are
    // reused, because the table of a sky takes a third of a second.
    std::erase_if(state->compiled, [](const auto& entry) { return entry.second.source->depends_on_images(); });
  }
  snapshot->images = state->image_store;
  const std::vector<std::string> warnings = state->image_store->warnings();
  snapshot->warnings.insert(snapshot->warnings.end(), warnings.begin(), warnings.end());
}

MaterialIndex compile_materials(const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot) {
  MaterialIndex index;
  snapshot->materials.push_back(shading::default_material());
  std::map<uint64_t, CompiledMaterial> kept;
  for (const auto& [key, source] : state->materials) {
    monitor.check();
    const auto old = state->compiled.find(key);
    CompiledMaterial& material = kept[key];
    if (old != state->compiled.end() && old->second.source == source)
      material = old->second;
    else
      material = compile(source, *state->image_store);
    if (!material.warning.empty()) snapshot->warnings.push_back(material.warning);
    index[key] = uint32_t(snapshot->materials.size());
    snapshot->materials.push_back(material.data);
  }
  state->compiled = std::move(kept);
  return index;
}

void add_coarser_images(const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot) {
  std::set<uint32_t> averaged;
  for (const auto& material : snapshot->materials)
    averaged.insert(material->averaged_images.begin(), material->averaged_images.end());
  CoarserImages coarser;
  for (const uint32_t index : averaged) {
    const std::shared_ptr<const image::Image>& image = state->image_store->image(index);
    const auto known = state->coarser_images.find(image);
    coarser[image] = known == state->coarser_images.end() ? nullptr : known->second;
  }
  std::vector<CoarserImages::value_type*> pending;
  for (auto& entry : coarser)
    if (!entry.second) pending.push_back(&entry);
  tbb::parallel_for(size_t(0), pending.size(), [&](size_t i) {
    if (monitor.is_running()) pending[i]->second = image::with_coarser_tiles(*pending[i]->first);
  });
  monitor.check();
  state->coarser_images = std::move(coarser);
  if (averaged.empty()) return;
  auto store = std::make_shared<image::ImageStore>(*state->image_store);
  for (const uint32_t index : averaged) store->set(index, state->coarser_images.at(state->image_store->image(index)));
  snapshot->images = std::move(store);
}

}  // namespace gradus::scene
