// gradus_components_*
#include "lpe/components.h"

#include "api/guard.h"
#include "base/text_list.h"

using namespace gradus;

namespace {

constexpr size_t kExamples = 3;

int checked(const lpe::ComponentSet& set, uint32_t index) {
  if (index >= uint32_t(set.count())) throw invalid_argument("there is no component " + std::to_string(index));
  return int(index);
}

}  // namespace

GradusError gradus_components_check(const char* components, uint32_t* count) {
  return api::guard([&] {
    api::require(count, "count") = uint32_t(lpe::ComponentSet::parse(&api::require(components, "components")).count());
  });
}

GradusError gradus_components_item(const char* components, uint32_t index, const char** name, const char** expression,
                                   const char** examples) {
  return api::guard([&] {
    thread_local lpe::Component item;
    thread_local std::string paths;
    const lpe::ComponentSet set = lpe::ComponentSet::parse(&api::require(components, "components"));
    const int i = checked(set, index);
    item = set[i];
    paths.clear();
    for (const std::string& path : set.examples(i, kExamples)) add_item(&paths, path);
    if (name) *name = item.name.c_str();
    if (expression) *expression = item.expression.c_str();
    if (examples) *examples = paths.c_str();
  });
}

GradusError gradus_components_classify(const char* components, const char* path, uint32_t* index) {
  return api::guard([&] {
    const lpe::ComponentSet set = lpe::ComponentSet::parse(&api::require(components, "components"));
    api::require(index, "index") = uint32_t(set.classify(&api::require(path, "path")));
  });
}
