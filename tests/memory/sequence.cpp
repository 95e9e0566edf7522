#include "memory/sequence.h"

namespace gradus::memory {

namespace {

// Fills the scene and commits it.
GradusError prepare(GradusScene scene) {
  for (const auto step : {test::set_quad, test::set_instance, test::set_light, test::set_camera}) {
    if (const GradusError code = step(scene); code != GRADUS_OK) return code;
  }
  return gradus_scene_commit(scene, nullptr, nullptr);
}

// Waits for the render, reconstructs its film and reads Combined.
GradusError finish(GradusRender render, std::vector<float>* image) {
  if (const GradusError code = gradus_render_wait(render, -1.0); code != GRADUS_OK) return code;
  GradusFilm film = 0;
  if (const GradusError code = gradus_render_film(render, &film); code != GRADUS_OK) return code;
  const GradusError code = gradus_film_reconstruct(film, GRADUS_RECONSTRUCTION_NONE, 0.0f, GRADUS_DENOISER_NONE,
                                                   image->data(), image->size(), nullptr);
  gradus_film_release(film);
  return code != GRADUS_OK ? code : gradus_render_read_pass(render, GRADUS_PASS_COMBINED, image->data(), image->size());
}

}  // namespace

GradusError render_once(GradusDevice device, uint32_t integrator, std::vector<float>* image) {
  GradusSettings settings = test::small_render(8, 8, 2);
  settings.integrator = integrator;
  settings.passes |= uint64_t{1} << GRADUS_PASS_NORMAL;
  GradusScene scene = 0;
  GradusError code = gradus_scene_create(device, &scene);
  if (code == GRADUS_OK) code = prepare(scene);
  GradusRender render = 0;
  if (code == GRADUS_OK) code = gradus_render_start(scene, &settings, &render);
  if (code == GRADUS_OK) code = finish(render, image);
  // A handle of 0 was never created and needs no release.
  const bool released = (render == 0 || gradus_render_release(render) == GRADUS_OK) &&
                        (scene == 0 || gradus_scene_release(scene) == GRADUS_OK);
  EXPECT_TRUE(released);
  return code;
}

}  // namespace gradus::memory
