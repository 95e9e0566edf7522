// Finds the position on the film from which a specular chain leads to a target: Newton's method on the film, inside
// steps in time. Every chain is traced from the camera, so that it obeys reflection and refraction exactly, and there
// are two unknowns for any number of surfaces (Jakob and Marschner 2012, Manifold Exploration; Zimmer et al. 2015,
// section 4.1).
#pragma once

#include <array>

#include "motion/specular_chain.h"
#include "motion/target_miss.h"

namespace gradus::motion {

// How the miss of a target (Aim::miss()) changes along the film.
struct FilmJacobian {
  bool known = false;
  Vec3 axis = Vec3(0, 0, 1);      // axis of the aim for which it was computed
  std::array<Vec3, 2> columns{};  // change of the miss for one pixel in x, and for one pixel in y

  // Returns the Jacobian rotated to the axis of another aim, for which it is only an estimate.
  glm::mat2 about(const Aim& aim) const;
};

struct FilmPlace {
  Vec2 film = Vec2(0.0f);
  SpecularChain chain;    // chain from that position
  FilmJacobian jacobian;  // before a search, an estimate
};

struct SearchCounts {
  uint64_t traced = 0;  // chains that were traced
  uint64_t space = 0;   // steps of Newton's method
  uint64_t time = 0;    // steps in time
};

enum class SearchEnd : uint8_t {
  Found,
  Broken,  // no chain with the signature exists at the positions that were tried
  Ended,   // nor at the predicted position of the target: it lies beyond an edge
  Stuck,   // the iteration did not converge
  Turned,  // a position was found, but the image may fold between it and the start: it may be another image of the
           // same target
};

class FilmSearch {
 public:
  // A specular signature, and the targets that its chains show in two frames.
  struct Problem {
    const ChainTracer &before, &after;
    const SpecularSignature& signature;
    Target target_before, target_after;
    Vec2 moved;  // displacement of the first smooth vertex on the film, in pixels
  };
  // `problem` and `counts` must outlive the search.
  FilmSearch(const Problem& problem, SearchCounts* counts) : problem_(problem), counts_(*counts) {}

  // Searches the next frame in one step in time, from `from` to `guess`, an estimate of the position there.
  SearchEnd leap(const FilmPlace& from, const Vec2& guess, FilmPlace* place);
  // Searches the next frame in several steps in time, which are halved where the image changes much. Between the
  // frames, the last ray of a chain is interpolated between those of both frames through the same point of the first
  // smooth surface.
  SearchEnd march(const FilmPlace& from, FilmPlace* place);
  // Computes the Jacobian at a position that shows the target in the first frame, unless it is known. Returns false if
  // that fails.
  bool complete(FilmPlace* place);

  static constexpr float kFilmTolerance = 1e-3f;  // pixels: below this length a step is the last correction

 private:
  struct State;
  // Times lie between 0, the first frame, and 1, the second one.
  Target target(float time) const;
  bool look(float time, const Vec2& film, SpecularChain* chain);
  bool miss(float time, const Aim& aim, const Vec2& film, SpecularChain* chain, Vec2* by);
  bool differentiate(const Aim& aim, const State& state, glm::mat2* jacobian);
  bool converge(const Aim& aim, const Vec2& step, State* state);
  SearchEnd take(const Aim& aim, const Vec2& newton, State* state);
  SearchEnd solve(float time, FilmPlace* place);
  SearchEnd step(float time, const FilmPlace& from, const Vec2& guess, FilmPlace* place);

  const Problem& problem_;
  SearchCounts& counts_;
};

}  // namespace gradus::motion
