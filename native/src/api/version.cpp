// Functions that need no handle: versions, gradus_error() and the layouts of structs.
#include <string_view>

#include "api/guard.h"
#include "schema/layout.h"

#ifndef GRADUS_COMMIT
#define GRADUS_COMMIT "unknown"
#endif
#define GRADUS_TEXT_OF(x) #x
#define GRADUS_TEXT(x) GRADUS_TEXT_OF(x)

using namespace gradus;

uint32_t gradus_version(void) {
  return GRADUS_VERSION_MAJOR * 10000 + GRADUS_VERSION_MINOR * 100 + GRADUS_VERSION_PATCH;
}

const char* gradus_version_text(void) {
  return GRADUS_TEXT(GRADUS_VERSION_MAJOR) "." GRADUS_TEXT(GRADUS_VERSION_MINOR) "." GRADUS_TEXT(
      GRADUS_VERSION_PATCH) " (commit " GRADUS_COMMIT ")";
}

uint64_t gradus_abi_hash(void) {
  uint64_t hash = 0;
  api::guard([&] { hash = schema::abi_hash(); });
  return hash;
}

GradusError gradus_error(const char** text) { return api::take_error(text); }

GradusError gradus_struct_layout(const char* name, size_t* size, size_t* offsets, size_t capacity,
                                 size_t* field_count) {
  return api::guard([&] {
    const schema::StructLayout* layout = schema::find_struct(std::string_view(&api::require(name, "name")));
    if (!layout) throw invalid_argument("no struct Gradus" + std::string(name));
    if (size) *size = layout->size;
    if (field_count) *field_count = layout->fields.size();
    if (capacity == 0) return;
    api::require(offsets, "offsets");
    for (size_t i = 0; i < layout->fields.size() && i < capacity; ++i) offsets[i] = layout->fields[i].offset;
  });
}
