// gradus_option*, gradus_settings_*, gradus_pass_info, gradus_component_pass_info
#include "schema/options.h"

#include <map>

#include "api/guard.h"
#include "api/structs.h"
#include "schema/pass_table.h"

using namespace gradus;

namespace gradus::api {
namespace {

GradusOptionInfo describe(const schema::Option& option) {
  GradusOptionInfo info{};
  info.type = option.type;
  info.name = option.name;
  info.doc = option.doc;
  info.default_value = option.default_value;
  info.minimum = option.minimum;
  info.maximum = option.maximum;
  // Static, because the text stays valid for as long as the library is loaded.
  static const std::map<std::string_view, std::string> names = [] {
    std::map<std::string_view, std::string> made;
    for (const schema::Option& item : schema::options()) made[item.name] = schema::choice_names(item);
    return made;
  }();
  info.choices = names.at(option.name).c_str();
  return info;
}

}  // namespace
}  // namespace gradus::api

uint32_t gradus_option_count(void) { return static_cast<uint32_t>(schema::options().size()); }

GradusError gradus_option(uint32_t index, GradusOptionInfo* info) {
  return api::guard([&] {
    if (index >= schema::options().size()) throw invalid_argument("there is no option " + std::to_string(index));
    api::write_struct(info, api::describe(schema::options()[index]), "info");
  });
}

GradusError gradus_settings_default(GradusSettings* settings) {
  return api::guard([&] { api::write_struct(settings, schema::default_settings(), "settings"); });
}

GradusError gradus_settings_parse(GradusSettings* settings, const char* name, const char* value) {
  return api::guard([&] {
    const schema::Option* option = schema::find_option(&api::require(name, "name"));
    if (!option) throw invalid_argument("there is no option " + std::string(name));
    GradusSettings copy = api::read_struct(settings, "settings", schema::default_settings());
    schema::parse_option(*option, &api::require(value, "value"), &copy);
    if (option->offset + schema::size_of(*option) > api::struct_size_of<GradusSettings>(settings, "settings")) {
      throw invalid_argument("option " + std::string(option->name) + " is newer than the caller's GradusSettings");
    }
    api::write_struct(settings, copy, "settings");
  });
}

GradusError gradus_pass_info(uint32_t pass, const char** name, uint32_t* channels) {
  return api::guard([&] {
    const schema::PassInfo& info = schema::pass_info(pass);
    if (name) *name = info.name;
    if (channels) *channels = info.channels;
  });
}

GradusError gradus_component_pass_info(uint32_t pass, const char** name, uint32_t* channels) {
  return api::guard([&] {
    const schema::ComponentPassInfo& info = schema::component_pass_info(pass);
    if (name) *name = info.name;
    if (channels) *channels = info.channels;
  });
}
