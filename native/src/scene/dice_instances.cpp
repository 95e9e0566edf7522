#include "scene/dice_instances.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <tbb/parallel_for.h>

#include "base/hash.h"
#include "geometry/diced_mesh.h"
#include "geometry/mesh.h"
#include "scene/dicing_measure.h"

namespace gradus::scene {

namespace {

// Ratio of the longest edge to the shortest one of those that are divided at once. Triangles are cut in half about
// evenly by it, as by the bisection of their longest edge.
const float kEdgeRange = std::sqrt(2.0f);

// A mesh that is being diced, and the result.
struct Job {
  DicedMesh result;
  std::vector<const geometry::InstanceData*> instances;
  std::unique_ptr<EdgeMeasure> measure;
  std::unique_ptr<geometry::Dicing> dicing;  // nullptr: the result is known
  float longest = 0.0f;                      // excess of the longest edge; 0: a limit is reached
  uint64_t next_count = 0;                   // number of triangles after the next division

  void finish(bool by_scene) {
    if (!(longest > 0.0f)) return;
    result.coarseness = std::max(1.0f, longest);
    result.by_scene = by_scene;
    longest = 0.0f;
  }
};

template <class Visit>
void for_each_job(std::vector<Job>* jobs, const Visit& visit) {
  tbb::parallel_for(size_t{0}, jobs->size(), [&](size_t i) {
    if ((*jobs)[i].dicing) visit(&(*jobs)[i]);
  });
}

// Returns the meshes to be diced, in the order of their first instances.
std::vector<Job> collect_jobs(const Snapshot& snapshot) {
  std::vector<Job> jobs;
  std::map<const geometry::MeshData*, size_t> index;
  for (const geometry::InstanceData& instance : snapshot.instances) {
    if (instance.mesh->dicing_levels == 0) continue;
    const auto [found, is_new] = index.try_emplace(instance.mesh.get(), jobs.size());
    if (is_new) jobs.emplace_back().result.from = instance.mesh;
    jobs[found->second].instances.push_back(&instance);
  }
  return jobs;
}

// Returns a hash of what the lengths of the mesh's edges depend on besides the mesh.
uint64_t view_of(const GradusCamera& camera, const Job& job) {
  ContentHash hash;
  if (!(job.result.from->dicing_rate > 0.0f)) return hash.result();
  hash.value(uint32_t(camera.type));
  hash.value(camera.clip_start);
  for (const float v : camera.window) hash.value(v);
  for (const float v : camera.matrix) hash.value(v);
  for (const geometry::InstanceData* instance : job.instances)
    hash.bytes(&instance->to_world[0][0], 16 * sizeof(float));
  return hash.result();
}

// Returns the excess of the longest edge of a diced mesh, of tens of thousands that are spread over it.
float longest_edge(const geometry::MeshData& mesh, const EdgeMeasure& measure) {
  const uint32_t step = std::max(mesh.triangle_count >> 16, 1u);
  float longest = 0.0f;
  for (uint32_t t = 0; t < mesh.triangle_count; t += step) {
    const std::array<Vec3, 3> p = geometry::triangle_positions(mesh, t);
    for (size_t k = 0; k < 3; ++k) longest = std::max(longest, measure.excess(p[k], p[(k + 1) % 3]));
  }
  return longest;
}

// Divides the longest edges of all meshes until none is too long, or a limit is reached.
void divide_longest_edges(const CommitMonitor& monitor, const DicingLimits& limits, std::vector<Job>* jobs) {
  for (;;) {
    monitor.check();
    float longest = 1.0f;
    for (const Job& job : *jobs) longest = std::max(longest, job.longest);
    if (longest <= 1.0f) return;
    const float limit = std::max(1.0f, longest / kEdgeRange);
    for_each_job(jobs, [&](Job* job) {
      job->next_count = job->longest > limit ? job->dicing->count_after(limit) : job->dicing->triangles().size();
      if (job->longest <= limit || job->next_count <= limits.mesh) return;
      job->finish(false);
      job->next_count = job->dicing->triangles().size();
    });
    uint64_t total = 0;
    for (const Job& job : *jobs) total += job.next_count;
    if (total > limits.scene) {
      for (Job& job : *jobs) job.finish(true);
      return;
    }
    for_each_job(jobs, [&](Job* job) {
      if (job->longest <= limit) return;
      job->dicing->divide(limit, monitor);
      job->longest = job->dicing->largest_excess();
    });
  }
}

void dice(const CommitMonitor& monitor, const DicingLimits& limits, const PictureScale& scale, std::vector<Job>* jobs) {
  tbb::parallel_for(size_t{0}, jobs->size(), [&](size_t i) {
    Job& job = (*jobs)[i];
    job.measure = std::make_unique<EdgeMeasure>(scale, *job.result.from, job.instances);
    job.dicing = std::make_unique<geometry::Dicing>(
        job.result.from, [&](const Vec3& a, const Vec3& b) { return job.measure->excess(a, b); }, monitor);
    job.longest = job.dicing->largest_excess();
  });
  divide_longest_edges(monitor, limits, jobs);
  for_each_job(jobs, [&](Job* job) {
    job->result.mesh = geometry::diced_mesh(*job->dicing, monitor);
    if (job->result.from->dicing_tolerance > 1.0f) job->result.longest = longest_edge(*job->result.mesh, *job->measure);
    job->dicing = nullptr;
  });
}

// Returns whether the triangles of another view are neither too long nor too short for this one.
bool tolerates(const DicedMesh& known, const PictureScale& scale, const Job& job) {
  const float tolerance = known.from->dicing_tolerance;
  if (!(tolerance > 1.0f)) return false;
  const float longest = longest_edge(*known.mesh, EdgeMeasure(scale, *known.from, job.instances));
  return longest <= tolerance * known.longest && known.longest <= tolerance * longest;
}

// Takes the results of the last commit if all of them still hold. They depend on each other by the limits.
bool reuse(const std::vector<DicedMesh>& known, const PictureScale& scale, std::vector<Job>* jobs) {
  if (known.size() != jobs->size()) return false;
  for (size_t i = 0; i < known.size(); ++i) {
    const Job& job = (*jobs)[i];
    if (known[i].from != job.result.from) return false;
    if (known[i].view != job.result.view && !tolerates(known[i], scale, job)) return false;
  }
  for (size_t i = 0; i < known.size(); ++i) (*jobs)[i].result = known[i];
  return true;
}

}  // namespace

std::vector<CoarseInstance> dice_instances(const CommitMonitor& monitor, const DicingLimits& limits,
                                           const GradusCamera& camera, std::vector<DicedMesh>* known,
                                           Snapshot* snapshot) {
  std::vector<Job> jobs = collect_jobs(*snapshot);
  for (Job& job : jobs) job.result.view = view_of(camera, job);
  const PictureScale scale(camera);
  if (!reuse(*known, scale, &jobs)) dice(monitor, limits, scale, &jobs);
  std::map<const geometry::MeshData*, const DicedMesh*> results;
  for (const Job& job : jobs) results[job.result.from.get()] = &job.result;
  std::vector<CoarseInstance> coarse;
  for (size_t k = 0; k < snapshot->instances.size(); ++k) {
    geometry::InstanceData& instance = snapshot->instances[k];
    if (instance.mesh->dicing_levels == 0) continue;
    const DicedMesh& result = *results.at(instance.mesh.get());
    instance.mesh = result.mesh;
    if (result.coarseness > 1.0f) coarse.push_back({k, result.coarseness, result.by_scene});
  }
  known->clear();
  for (Job& job : jobs) known->push_back(std::move(job.result));
  return coarse;
}

}  // namespace gradus::scene
