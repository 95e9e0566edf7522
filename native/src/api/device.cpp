// gradus_device_*
#include "scene/device.h"

#include "api/guard.h"
#include "api/objects.h"
#include "api/structs.h"
#include "image/color.h"

using namespace gradus;

GradusError gradus_device_create(const GradusDeviceSettings* settings, GradusDevice* device) {
  return api::guard([&] {
    api::require(device, "device") = 0;
    const GradusDeviceSettings copy = settings ? api::read_struct(settings, "settings") : GradusDeviceSettings{};
    *device = api::add_handle(std::make_shared<scene::Device>(copy));
  });
}

GradusError gradus_device_release(GradusDevice device) {
  return api::guard([&] { api::remove_handle<scene::Device>(device); });
}

GradusError gradus_device_warning(GradusDevice device, const char** text) {
  return api::guard([&] {
    api::require(text, "text") = nullptr;
    api::take_warning(&api::find_handle<scene::Device>(device)->warnings(), text);
  });
}

GradusError gradus_device_set_color_space(GradusDevice device, const char* name, GradusConvertColors convert,
                                          void* context) {
  return api::guard([&] {
    const auto object = api::find_handle<scene::Device>(device);
    const char* space = api::checked_name(&api::require(name, "name"), "name");
    api::require(convert, "convert");
    object->color().set_conversion(space, [=](float* rgba, size_t count) { convert(context, rgba, count); });
  });
}
