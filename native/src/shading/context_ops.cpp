#include "shading/context_ops.h"

namespace gradus::shading {
namespace {

bool evaluate_ray_op(uint32_t op, const ResourceArgs& args, const ShadeContext& context, Vec4* out) {
  switch (op) {
    case GRADUS_OP_LIGHT_PATH:
      out[0] = splat(light_path(args.mode, context));
      return true;
    case GRADUS_OP_LAYER_WEIGHT:
      layer_weight(args, context, out);
      return true;
    case GRADUS_OP_FRESNEL:
      out[0] = splat(fresnel(args, context));
      return true;
    case GRADUS_OP_LIGHT_FALLOFF:
      out[0] = splat(light_falloff(args, context));
      return true;
    default:
      return false;
  }
}

}  // namespace

bool evaluate_context_op(uint32_t op, const ResourceArgs& args, const ShadeContext& context, Vec4* out) {
  switch (op) {
    case GRADUS_OP_IMAGE:
      image(args, context, out);
      return true;
    case GRADUS_OP_ENVIRONMENT:
      out[0] = environment(args, context);
      return true;
    case GRADUS_OP_GEOMETRY:
      out[0] = value(geometry(args.mode, context));
      return true;
    case GRADUS_OP_TEX_COORD:
      out[0] = value(texture_coordinate(args, context));
      return true;
    case GRADUS_OP_TANGENT:
      out[0] = value(tangent(args, context));
      return true;
    case GRADUS_OP_ATTRIBUTE:
      attribute(args, context, out);
      return true;
    case GRADUS_OP_OBJECT_INFO:
      object_info(context, out);
      return true;
    case GRADUS_OP_CAMERA_DATA:
      camera_data(context, out);
      return true;
    case GRADUS_OP_NORMAL_MAP:
      out[0] = value(normal_map(args, context));
      return true;
    case GRADUS_OP_VECTOR_TRANSFORM:
      out[0] = value(vector_transform(args, context));
      return true;
    default:
      return evaluate_ray_op(op, args, context, out);
  }
}

}  // namespace gradus::shading
