// What a camera ray meets first, where more than one path may begin with it.
#pragma once

#include "path/segment.h"
#include "path/vertex.h"

namespace gradus::path {

struct CameraVertex {
  geometry::Hit hit;    // the nearest
  bool shared = false;  // no random decision lay on the way: what follows is the same for every path
  PathRay ray;          // as it arrived
  Segment segment;
  bool looked = false;             // an offset has asked what the segment shows:
  Radiance seen = Radiance(0.0f);  // alpha as in PathResult, less 1
  Vertex vertex;                   // closures may still be missing
};

}  // namespace gradus::path
