#include "component_layers.h"

#include "common.h"
#include "lpe/components.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::tool {
namespace {

PassNames component_pass_names() {
  return {GRADUS_COMPONENT_PASS_COUNT, [](uint32_t pass) { return canonical(schema::component_pass_info(pass).name); },
          "components have no pass ", "; they have "};
}

bool is_available(const film::FilmHeader& film, uint32_t pass) {
  if (film.settings.use_decomposition == 0) return false;
  const film::ComponentContent& held = film.of_components;
  return (held.non_specular || !schema::is_of_non_specular_vertices(pass)) &&
         (held.details || !schema::is_of_non_specular_details(pass)) && (held.motion || !schema::is_motion(pass));
}

std::string layer_name(const std::string& component, uint32_t pass) {
  const std::string name = "Path " + component;
  return pass == GRADUS_COMPONENT_COLOR ? name : name + " " + schema::component_pass_info(pass).name;
}

}  // namespace

uint32_t parse_component_passes(const std::string& text) { return uint32_t(parse_names(component_pass_names(), text)); }

std::string bad_component_passes(const std::string& text) {
  return refusal([&] { parse_component_passes(text); });
}

uint32_t available_component_passes(const film::FilmHeader& film, uint32_t requested) {
  const AvailablePasses held =
      find_available(component_pass_names(), requested, [&](uint32_t pass) { return is_available(film, pass); });
  if (held.mask == 0 && requested != 0) {
    throw client::Error(GRADUS_ERROR_INVALID_OPERATION,
                        "the film was sampled without components: --use-decomposition 1 samples them");
  }
  if (requested == kAllComponentPasses || held.missing.empty()) return requested & uint32_t(held.mask);
  throw client::Error(GRADUS_ERROR_INVALID_OPERATION,
                      "the film's components were rendered without " + held.missing + "; there are " + held.names);
}

bool need_two_frames(uint32_t passes) { return schema::any_wanted(passes, schema::is_motion); }

ReadComponent reader_of(const client::Film& film) {
  return [id = film.id()](const char* component, uint32_t pass, std::vector<float>* pixels) {
    client::check(gradus_film_read_component(id, component, pass, pixels->data(), pixels->size()));
  };
}

void add_component_layers(const GradusSettings& settings, uint32_t passes, size_t pixels, const ReadComponent& read,
                          std::vector<film_io::ImageLayer>* layers) {
  if (passes == 0) return;
  const lpe::ComponentSet set =
      lpe::ComponentSet::parse(schema::get_text(settings, *schema::find_option("components")));
  for (int c = 0; c < set.count(); ++c) {
    for (uint32_t pass = 0; pass < GRADUS_COMPONENT_PASS_COUNT; ++pass) {
      if (!schema::has_bit(passes, pass)) continue;
      const schema::ComponentPassInfo& info = schema::component_pass_info(pass);
      layers->push_back(
          {layer_name(set[c].name, pass), info.letters, std::vector<float>(pixels * size_t(info.channels))});
      read(set[c].name.c_str(), pass, &layers->back().pixels);
    }
  }
}

}  // namespace gradus::tool
