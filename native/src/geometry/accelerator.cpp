#include "geometry/accelerator.h"

#include <unordered_map>

namespace gradus::geometry {

namespace {

// Maximum number of triangles in all copies of one mesh. Up to this number the copies go into the top level of the
// acceleration structure, because triangles there are cheaper to trace than instances.
constexpr uint64_t kMaxCopiedTriangles = 1u << 14;
// Minimum number of static triangles for which a group of their own pays. Below it, building them again together with
// the moving ones takes less time than the rays need to query two groups.
constexpr uint64_t kMinKeptTriangles = 1u << 18;

using UserCounts = std::unordered_map<const MeshData*, uint64_t>;

// Returns whether the triangles of an instance are copied into the top level instead of being referenced.
bool is_in_top_level(const InstanceData& instance, const UserCounts& users) {
  if (instance.moves()) return false;
  const uint64_t count = users.at(instance.mesh.get());
  return count == 1 || count * instance.mesh->triangle_count <= kMaxCopiedTriangles;
}

// Returns whether an instance is the same in the previous, the current and the next frame. Only the data of the current
// frame count, because a picture must not depend on which frames were rendered before it.
bool is_static(const InstanceData& instance) {
  return !instance.moves() && (instance.visibility & GRADUS_MAY_MOVE) == 0 &&
         instance.to_world_previous == instance.to_world && instance.to_world_next == instance.to_world &&
         instance.was_there && instance.will_be_there && instance.mesh->key_times.size() < 2;
}

// Returns whether static and moving instances get separate groups. With motion blur the separation is free for rays:
// Embree traverses triangles and blurred instances one after the other anyway. Without it, enough static triangles must
// be kept.
bool pays_to_split(const std::vector<InstanceData>& instances, const std::vector<bool>& flat) {
  uint64_t kept = 0;
  bool all_static = true, blurred = false;
  for (size_t i = 0; i < instances.size(); ++i) {
    blurred |= instances[i].moves();
    all_static &= is_static(instances[i]);
    if (flat[i] && is_static(instances[i])) kept += instances[i].mesh->triangle_count;
  }
  return !all_static && (blurred || kept >= kMinKeptTriangles);
}

// Members of the static and of the moving group.
struct Split {
  GroupInput static_part, moving;
};

// Distributes the instances over the two groups. If there is only one group, it is the static one.
Split split_instances(const AcceleratorInput& input) {
  const std::vector<InstanceData>& instances = *input.instances;
  UserCounts users;
  for (const InstanceData& instance : instances) ++users[instance.mesh.get()];
  std::vector<bool> flat(instances.size());
  for (size_t i = 0; i < instances.size(); ++i) flat[i] = is_in_top_level(instances[i], users);
  const bool splits = pays_to_split(instances, flat);
  const GroupInput none{&instances, &input.to_internal, {}};
  Split split{none, none};
  for (size_t i = 0; i < instances.size(); ++i)
    (splits && !is_static(instances[i]) ? split.moving : split.static_part)
        .members.push_back({uint32_t(i), (*input.masks)[i], flat[i]});
  if (split.static_part.members.empty()) std::swap(split.static_part, split.moving);
  return split;
}

// Builds the groups of an accelerator. Groups and mesh scenes of the previous accelerator are reused where their input
// is unchanged.
class Builder {
 public:
  Builder(const EmbreeDevice& device, const Accelerator* before) : device_(device) {
    if (!before) return;
    for (const Accelerator::Part* part : {&before->static_part, &before->moving}) {
      if (!part->group) continue;
      groups_.push_back(part->group);
      for (const auto& scene : part->group->mesh_scenes) mesh_scenes_.emplace(scene->mesh.get(), scene);
    }
  }

  Accelerator::Part part(const GroupInput& input, const BuildProgress& progress) {
    Accelerator::Part part;
    for (const GroupInput::Member& member : input.members) part.instances.push_back(member.instance);
    part.group = group(input, progress);
    return part;
  }

 private:
  std::shared_ptr<const GeometryGroup> group(const GroupInput& input, const BuildProgress& progress) {
    const uint64_t key = input.key();
    for (const auto& group : groups_)
      if (group->key == key) return group;
    return build_group(device_, input, key, progress, &mesh_scenes_);
  }

  const EmbreeDevice& device_;
  std::vector<std::shared_ptr<const GeometryGroup>> groups_;
  MeshScenes mesh_scenes_;
};

bool same(const Accelerator::Part& a, const Accelerator::Part& b) {
  return a.group == b.group && a.instances == b.instances;
}

}  // namespace

std::shared_ptr<const Accelerator> build_accelerator(const EmbreeDevice& device, const AcceleratorInput& input,
                                                     const BuildProgress& progress,
                                                     const std::shared_ptr<const Accelerator>& before) {
  constexpr float kStaticShare = 0.5f;  // share of the static group in the progress
  const Split split = split_instances(input);
  Builder builder(device, before.get());
  auto built = std::make_shared<Accelerator>();
  const bool splits = !split.moving.members.empty();
  const float share = splits ? kStaticShare : 1.0f;
  built->static_part = builder.part(split.static_part, [&](float done) { return progress(share * done); });
  if (splits)
    built->moving = builder.part(split.moving, [&](float done) { return progress(share + (1.0f - share) * done); });
  if (before && same(before->static_part, built->static_part) && same(before->moving, built->moving)) return before;
  return built;
}

}  // namespace gradus::geometry
