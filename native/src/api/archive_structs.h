// The records of a scene file: those of the public structs, which are generated, and the list of lights.
#pragma once

#include "api/archive_records.h"

namespace gradus::api {

// The lights that one call sets.
struct LightList {
  const GradusLight* lights = nullptr;
  size_t count = 0;
};

template <class Archive>
void visit(Archive& a, LightList& list) {
  a.value(list.count);
  a.structs(list.lights, list.count);
}

}  // namespace gradus::api
