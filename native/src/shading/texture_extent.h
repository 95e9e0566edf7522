// The part of an image that one look-up of an Image Texture may average, so that it needs no higher resolution.
//
// A path adds one look-up to its pixel, and many paths make the mean of the texels that the pixel covers. Texels much
// smaller than a pixel thus add noise, and each look-up waits for memory. The extent is half a pixel at surfaces that
// the camera sees, less than the pixel filter blurs anyway, and eight pixels behind diffuse bounces, which blur much
// more. Behind glossy bounces alone, behind portals and in shadows, images have their full resolution: a lens may
// magnify them, and portals change distances.
//
// The extent depends on the point, the kind of the ray and the camera, and not on the path to the point, because a path
// that is shifted onto a point must find there what any other path finds. A shifted path has the kind of ray of its
// base, so that this holds unless a surface is both diffuse and glossy.
#pragma once

#include <string>

#include "base/types.h"

namespace gradus::shading {

struct Graph;
struct GraphValue;
struct ShadeContext;

// How the coordinates of an Image Texture arise from coordinates on the surface.
struct TextureMap {
  enum class Source : uint8_t { Unknown, UvMap, Generated, Object };
  Source source = Source::Unknown;
  std::string uv_map;  // name of the UV map; empty for the default one
  float scale = 1.0f;  // lower bound on the length of the coordinates for one unit of the source
};

// Finds the map of a node's vector input. It is known where nodes move, turn and scale coordinates by constants.
TextureMap texture_map(const Graph& graph, const GraphValue& vector);

// Returns the extent of a look-up at a point, in units of the texture's coordinates; 0 for full resolution.
float texture_extent(const TextureMap& map, const ShadeContext& context);

}  // namespace gradus::shading
