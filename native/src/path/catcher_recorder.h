// Records what shadow catchers show. The picture has a hole where a camera path ends at a catcher. From there two plain
// paths go on: one in the whole scene, and one in a scene of catchers alone. The quotient of their light is the shadow
// that other objects cast; output/shadow_catcher.h darkens the background by it. This is Cycles' method, which splits
// the path at a catcher.
#pragma once

#include <memory>

#include "film/film.h"
#include "path/sampler.h"
#include "path/scatter.h"

namespace gradus::path {

class CatcherRecorder {
 public:
  // Finds the channels in the film, which must outlive the recorder.
  CatcherRecorder(const PathContext& context, film::Film* film, film::Counters* counters);
  ~CatcherRecorder();
  CatcherRecorder(const CatcherRecorder&) = delete;
  CatcherRecorder& operator=(const CatcherRecorder&) = delete;

  // Returns whether the film has the channels.
  bool active() const { return tracers_ != nullptr; }
  // Prepares for a sample. If `is_recorded` is true, the sample was recorded before.
  void begin_sample(size_t pixel, int half, bool is_recorded);
  // Returns whether a vertex lies on a catcher that the recorder records.
  bool catches(const Vertex& vertex) const;
  // Records the catcher at the end of a camera path. The state's throughput has the weight of the segment.
  void catcher(const Sampler& sampler, const PathState& state, const Vertex& vertex);
  // Records the background that a camera path has found.
  void background(const Rgb& value);

 private:
  struct Tracers;
  void add(const Vec4& value, film::Channel* channel);

  const PathContext& context_;
  film::Counters* counters_;
  film::Channel *shaded_ = nullptr, *alone_ = nullptr, *background_ = nullptr;
  std::unique_ptr<Tracers> tracers_;
  size_t pixel_ = 0;
  int half_ = 0;
  bool is_recorded_ = false;
};

}  // namespace gradus::path
