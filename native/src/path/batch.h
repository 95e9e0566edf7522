// Paths that take their steps in turn.
//
// The code of a path does not fit into the first-level instruction cache, so that a path that is traced alone fetches
// it anew at every vertex. In a batch all paths take the same step one after the other. What a step has prefetched for
// one path arrives while the others take it.
#pragma once

#include <array>
#include <cstddef>

namespace gradus::path {

// Extends `count` paths, which have been started, until all have ended. `path_of(i)` returns the tracer of path i. Each
// path has the result that it has alone.
template <size_t kMaxPaths, class PathOf>
void extend_together(size_t count, const PathOf& path_of) {
  std::array<size_t, kMaxPaths> alive;
  for (size_t i = 0; i < count; ++i) alive[i] = i;
  const auto each = [&](const auto& step) {
    for (size_t i = 0; i < count; ++i) step(path_of(alive[i]));
  };
  const auto keep = [&](const auto& goes_on) {
    size_t kept = 0;
    for (size_t i = 0; i < count; ++i)
      if (goes_on(path_of(alive[i]))) alive[kept++] = alive[i];
    count = kept;
  };
  while (count > 0) {
    each([](auto& path) { path.place(); });
    keep([](auto& path) { return path.arrive(); });
    keep([](auto& path) { return path.shade(); });
    each([](auto& path) { path.scatter(); });
    each([](auto& path) { path.intersect(); });
    each([](auto& path) { path.light(); });
    keep([](auto& path) { return path.leave(); });
  }
}

}  // namespace gradus::path
