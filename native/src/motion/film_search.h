// The place on the film from which a way through smooth surfaces leads to a target: Newton's method on the film inside
// steps in time. Every way is traced from the camera, so that reflections and refractions hold exactly, and there are
// two unknowns for any number of surfaces (Jakob and Marschner 2012, Manifold Exploration; Zimmer et al. 2015,
// section 4.1).
#pragma once

#include <array>

#include "motion/specular_chain.h"
#include "motion/target_miss.h"

namespace gradus::motion {

// How a miss changes along the film.
struct FilmJacobian {
  bool known = false;
  Vec3 axis = Vec3(0, 0, 1);      // of the aim
  std::array<Vec3, 2> columns{};  // miss for one pixel to the right, and up

  // Turned to the axis of another aim, where it is a guess.
  glm::mat2 about(const Aim& aim) const;
};

struct FilmPlace {
  Vec2 film = Vec2(0.0f);
  SpecularChain chain;    // from there
  FilmJacobian jacobian;  // before a search, a guess
};

struct SearchCounts {
  uint64_t traced = 0;  // ways that were followed
  uint64_t space = 0;   // steps of Newton's
  uint64_t time = 0;    // steps in time
};

enum class SearchEnd : uint8_t {
  Found,
  Broken,  // the way does not exist where it was looked for
  Ended,   // nor does it where, by all that is known, the target would be seen: beyond an edge
  Stuck,
  Turned,  // a place was found, but between it and the start the picture may fold: it may be another image of the same
           // thing
};

class FilmSearch {
 public:
  // What one way shows in two frames, and where.
  struct Problem {
    const ChainTracer &before, &after;
    const SpecularSignature& signature;
    Target target_before, target_after;
    Vec2 moved;  // of the first smooth vertex on the film
  };
  // All that is given lives as long as it.
  FilmSearch(const Problem& problem, SearchCounts* counts) : problem_(problem), counts_(*counts) {}

  // One step in time, from `from` to a guess of the place in the frame after.
  SearchEnd leap(const FilmPlace& from, const Vec2& guess, FilmPlace* place);
  // From `from` to the frame after in steps that are halved where the picture changes much. What lies between the
  // frames is taken to be between the rays that the same points of the first smooth surface send on.
  SearchEnd march(const FilmPlace& from, FilmPlace* place);
  // At a place that is known to show the target before: its Jacobian.
  bool complete(FilmPlace* place);

  static constexpr float kFilmTolerance = 1e-3f;  // pixels: of a step before the last correction

 private:
  struct State;
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
