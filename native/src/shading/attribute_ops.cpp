// Attribute, Color Attribute and Object Info nodes.
#include <algorithm>

#include "geometry/surface_values.h"
#include "shading/context_ops.h"

namespace gradus::shading {

Vec4 attribute_value(const ShadeContext& c, const std::string* name, bool uv, uint32_t* channels) {
  if (channels) *channels = 0;
  if (c.light && c.light->has_uv_map && (name ? *name == "uv" : uv)) {
    if (channels) *channels = 3;
    return Vec4(c.light->uv, 0.0f, 1.0f);
  }
  if (!c.instance) return Vec4(0.0f);
  const geometry::MeshData& mesh = *c.instance->mesh;
  const geometry::MeshAttribute* found = name ? geometry::find_attribute(mesh, *name) : nullptr;
  if (!found && !name && uv) found = geometry::default_uv_map(mesh);
  if (!found) return Vec4(0.0f);
  if (channels) *channels = found->channels;
  return geometry::attribute_at(*c.instance, *found, c.hit);
}

namespace {

// Returns the object at the point, also of a light whose nodes read nothing else of it. Null on the background.
const geometry::ObjectData* any_object_of(const ShadeContext& c) { return c.light ? c.light->object : c.instance; }

// Returns an attribute of the instance or light, or null if it has none of that name.
const Vec4* instance_attribute(const ShadeContext& c, const std::string* name) {
  const geometry::ObjectData* object = any_object_of(c);
  if (!object || !c.scene || !name) return nullptr;
  const std::vector<std::string>& names = c.scene->instance_attribute_names;
  const auto found = std::find(names.begin(), names.end(), *name);
  return found == names.end() ? nullptr : &object->attributes[size_t(found - names.begin())];
}

}  // namespace

void instance_attribute_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  const Vec4* found = instance_attribute(c, args.name);
  const Vec4 v = found ? *found : Vec4(0.0f, 0.0f, 0.0f, 1.0f);
  out[0] = out[1] = Vec4(Vec3(v), 1.0f);
  out[2] = splat(mean_component(Vec3(v)));
  out[3] = splat(v.w);
}

void attribute_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  uint32_t channels = 0;
  Vec4 v = attribute_value(c, args.name, false, &channels);
  // As in Cycles, a missing attribute is black and opaque, and a missing colour transparent.
  if (channels == 0) v.w = args.mode == 1 ? 0.0f : 1.0f;
  if (channels == 1) v = Vec4(v.x, v.x, v.x, 1.0f);
  out[0] = out[1] = Vec4(Vec3(v), 1.0f);
  out[2] = splat(channels <= 2 ? v.x : mean_component(Vec3(v)));  // of two components Cycles takes the first
  out[3] = splat(v.w);
}

void object_info_op(const ResourceArgs&, const ShadeContext& c, Vec4* out) {
  for (int i = 0; i < 5; i++) out[i] = Vec4(0.0f);
  if (const geometry::ObjectData* any = any_object_of(c))
    out[3] = splat(static_cast<float>(any->random_id) * (1.0f / 4294967296.0f));
  const geometry::ObjectData* object = object_of(c);
  if (!object) return;
  const Vec3 origin = c.scene ? c.scene->origin : Vec3(0.0f);
  geometry::Placement storage;
  out[0] = value(Vec3(placement_of(c, &storage).to_world[3]) + origin);
  out[1] = Vec4(Vec3(object->color), 1.0f);
  out[2] = splat(static_cast<float>(object->pass_index));
  out[4] = splat(object->color.w);
}

}  // namespace gradus::shading
