#include "schema/pass_table.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace gradus::schema {
namespace {

constexpr uint32_t kNone = GRADUS_PASS_COUNT;

uint64_t passes_that(bool (*are_such)(PassKind)) {
  uint64_t passes = 0;
  for (const PassInfo& info : all_passes()) {
    if (are_such(info.kind)) passes |= uint64_t{1} << info.pass;
  }
  return passes;
}

bool is_stored(PassKind kind) {
  return kind != PassKind::Image && kind != PassKind::Derived && kind != PassKind::Solved && kind != PassKind::Sequence;
}

}  // namespace

const PassInfo& pass_info(uint32_t pass) {
  if (pass >= GRADUS_PASS_COUNT) throw invalid_argument("there is no pass " + std::to_string(pass));
  return all_passes()[pass];
}

const ComponentPassInfo& component_pass_info(uint32_t pass) {
  if (pass >= GRADUS_COMPONENT_PASS_COUNT) throw invalid_argument("components have no pass " + std::to_string(pass));
  return all_component_passes()[pass];
}

bool any_wanted(uint32_t component_passes, bool (*is_of_kind)(uint32_t component_pass)) {
  return std::ranges::any_of(all_component_passes(), [&](const ComponentPassInfo& info) {
    return has_bit(component_passes, info.pass) && is_of_kind(info.pass);
  });
}

uint64_t needed_passes(uint64_t passes) {
  for (const PassInfo& info : all_passes()) {
    if (has_bit(passes, info.pass) && info.color != kNone) passes |= uint64_t{1} << info.color;
  }
  return passes;
}

std::vector<PassInfo> stored_passes(uint64_t passes) {
  std::vector<PassInfo> stored;
  const uint64_t needed = needed_passes(passes);
  for (const PassInfo& info : all_passes()) {
    if (has_bit(needed, info.pass) && is_stored(info.kind)) stored.push_back(info);
  }
  return stored;
}

uint64_t feature_passes() {
  return passes_that([](PassKind kind) { return kind == PassKind::Feature; });
}

uint64_t light_passes() { return passes_that(is_of_light); }

}  // namespace gradus::schema
