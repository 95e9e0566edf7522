#include "motion/film_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/minimal_rotation.h"

namespace gradus::motion {

namespace {

constexpr int kMaxSteps = 24;
constexpr int kMaxHalvings = 6;
constexpr float kLongestStep = 64.0f;     // pixels
constexpr float kDifference = 0.125f;     // pixels: width of finite differences, below a pixel but far above rounding
constexpr float kMinDeterminant = 1e-4f;  // of normalised columns: below it the image folds
constexpr float kFirstAdvance = 0.25f, kSmallestAdvance = 1.0f / 64.0f;  // steps in time, in frames
// Maximum relative change of the Jacobian over a step in time. As long as it changes by less than 1 there is no fold in
// between.
constexpr float kLargestChange = 0.5f;
constexpr float kRounding = 2e-6f;   // error of a miss by rounding, relative to the distance of the target
constexpr float kRoughness = 2e-5f;  // the same error where normals are finite differences, as those of bump maps
// Pixels: a position found within this distance of the expected one is accepted as the same image.
constexpr float kNear = 0.25f;
// Pixels: over longer displacements the Jacobian is computed anew rather than carried along.
constexpr float kFar = 1.0f;
// Pixels: two steps that lead to positions this close are taken to lead to the target.
constexpr float kSame = 0.01f;

// Computes the Newton step for a miss. Returns false if the Jacobian is singular.
bool newton_step(const glm::mat2& jacobian, const Vec2& miss, Vec2* step) {
  const float lengths = glm::length(jacobian[0]) * glm::length(jacobian[1]);
  if (!(std::fabs(glm::determinant(jacobian)) > kMinDeterminant * lengths)) return false;
  *step = -glm::inverse(jacobian) * miss;
  return is_finite(step->x) && is_finite(step->y);
}

Vec2 limited(const Vec2& step) {
  const float length = glm::length(step);
  return length > kLongestStep ? step * (kLongestStep / length) : step;
}

// Whether the image neither folds nor changes much from one position to another.
bool is_same_image(const FilmJacobian& from, const FilmJacobian& to, const Aim& aim, bool near) {
  const glm::mat2 change = glm::inverse(from.about(aim)) * to.about(aim), difference = change - glm::mat2(1.0f);
  const float square = glm::dot(difference[0], difference[0]) + glm::dot(difference[1], difference[1]);
  return square < kLargestChange * kLargestChange || (near && glm::determinant(change) > 0.0f);
}

}  // namespace

glm::mat2 FilmJacobian::about(const Aim& aim) const {
  return {aim.flat(turned(columns[0], axis, aim.axis())), aim.flat(turned(columns[1], axis, aim.axis()))};
}

// State of the Newton iteration.
struct FilmSearch::State {
  float time;
  Vec2 film;
  SpecularChain chain;
  Vec2 miss;
  glm::mat2 jacobian;
  bool fresh = false;             // whether the Jacobian was computed at exactly this position
  Vec2 beyond = Vec2(kInfinity);  // end of the last full step at which there was no chain
};

Target FilmSearch::target(float time) const {
  const Target &before = problem_.target_before, &after = problem_.target_after;
  const Vec3 place = time < 1.0f ? glm::mix(before.place, after.place, time) : after.place;
  return {after.in_sky ? glm::normalize(place) : place, after.in_sky};
}

// Traces the chain at a position and time. Between the frames its last ray is interpolated between two chains through
// the same point of the first smooth surface.
bool FilmSearch::look(float time, const Vec2& film, SpecularChain* chain) {
  const Problem& p = problem_;
  SpecularChain before;
  ++counts_.traced;
  if (time >= 1.0f) return p.after.follow(film, p.signature, chain);
  if (!p.before.follow(film - time * p.moved, p.signature, time > 0.0f ? &before : chain)) return false;
  if (time <= 0.0f) return true;
  ++counts_.traced;
  if (!p.after.follow(film + (1.0f - time) * p.moved, p.signature, chain)) return false;
  Ray& ray = chain->ray.ray;
  ray.origin = glm::mix(before.ray.ray.origin, ray.origin, time);
  ray.direction = glm::normalize(glm::mix(before.ray.ray.direction, ray.direction, time));
  return true;
}

bool FilmSearch::miss(float time, const Aim& aim, const Vec2& film, SpecularChain* chain, Vec2* by) {
  Vec3 miss;
  if (!look(time, film, chain) || !aim.miss(chain->ray.ray, &miss)) return false;
  *by = aim.flat(miss);
  return true;
}

// Computes the Jacobian by one-sided differences, on a side where a chain exists.
bool FilmSearch::differentiate(const Aim& aim, const State& state, glm::mat2* jacobian) {
  for (int axis = 0; axis < 2; ++axis) {
    bool found = false;
    for (const float by : {kDifference, -kDifference}) {
      Vec2 film = state.film, there;
      film[axis] += by;
      SpecularChain chain;
      if (found || !miss(state.time, aim, film, &chain, &there)) continue;
      (*jacobian)[axis] = (there - state.miss) / (film[axis] - state.film[axis]);
      found = true;
    }
    if (!found) return false;
  }
  return true;
}

// Takes a step that reduces the estimated distance to the target, halving the step until it does.
SearchEnd FilmSearch::take(const Aim& aim, const Vec2& newton, State* state) {
  const Vec2 step = limited(newton);
  const float before = glm::length(newton), length = glm::length(step);
  SearchEnd end = SearchEnd::Broken;
  float share = 1.0f;
  // With an estimated Jacobian, halving the step may not help.
  for (int i = 0; i < (state->fresh ? kMaxHalvings : 1); ++i, share *= 0.5f) {
    const Vec2 film = state->film + share * step;
    SpecularChain chain;
    Vec2 by, left;
    if (!miss(state->time, aim, film, &chain, &by)) {
      if (i == 0 && state->fresh && glm::length(film - std::exchange(state->beyond, film)) < kSame)
        return SearchEnd::Ended;
      continue;
    }
    end = SearchEnd::Stuck;
    if (!newton_step(state->jacobian, by, &left) || !(glm::length(left) < before - 0.25f * share * length)) continue;
    // Broyden's update of the Jacobian.
    const Vec2 moved = film - state->film;
    const Vec2 residual = (by - state->miss - state->jacobian * moved) / glm::dot(moved, moved);
    state->jacobian += glm::outerProduct(residual, moved);
    state->film = film;
    state->chain = chain;
    state->miss = by;
    state->fresh = false;
    return SearchEnd::Found;
  }
  return end;
}

// Applies the last correction and checks that it reduces the miss. This rejects an estimated Jacobian that is far too
// large, as at the edge of a facet, where any step would seem short enough. A position whose miss is mere rounding, as
// that of a static target, is not changed.
bool FilmSearch::converge(const Aim& aim, const Vec2& step, State* state) {
  const float before = glm::length(state->miss);
  if (before < kRounding * aim.distance()) return true;
  SpecularChain chain;
  Vec2 by;
  const bool is_there = miss(state->time, aim, state->film + step, &chain, &by);
  const bool nearer = is_there && glm::length(by) < 0.5f * before;
  if (!nearer) return state->fresh && before < kRoughness * aim.distance();
  state->film += step;
  state->chain = chain;
  state->miss = by;
  return true;
}

SearchEnd FilmSearch::solve(float time, FilmPlace* place) {
  State state{time, place->film, {}, {}, {}};
  if (!look(time, state.film, &state.chain)) return SearchEnd::Broken;
  const Aim aim(target(time), state.chain.ray.ray.origin);
  Vec3 by;
  if (!aim.miss(state.chain.ray.ray, &by)) return SearchEnd::Stuck;
  state.miss = aim.flat(by);
  const auto refresh = [&] { return state.fresh = differentiate(aim, state, &state.jacobian); };
  if (place->jacobian.known) {
    state.jacobian = place->jacobian.about(aim);
  } else if (!refresh()) {
    return SearchEnd::Broken;
  }
  for (int i = 0; i < kMaxSteps; ++i) {
    Vec2 step;
    if (!newton_step(state.jacobian, state.miss, &step)) {
      if (state.fresh || !refresh()) return SearchEnd::Stuck;
      continue;
    }
    if (glm::length(step) < kFilmTolerance) {
      if (!converge(aim, step, &state)) {
        if (state.fresh || !refresh()) return SearchEnd::Broken;
        continue;
      }
      if (!state.fresh && glm::length(state.film - place->film) > kFar && !refresh()) return SearchEnd::Broken;
      const Mat3 frame = aim.axes();
      *place = {state.film,
                state.chain,
                {true, aim.axis(), {frame * Vec3(state.jacobian[0], 0.0f), frame * Vec3(state.jacobian[1], 0.0f)}}};
      return SearchEnd::Found;
    }
    ++counts_.space;
    const SearchEnd end = take(aim, step, &state);
    if (end != SearchEnd::Found && (state.fresh || !refresh())) return end;
  }
  return SearchEnd::Stuck;
}

bool FilmSearch::complete(FilmPlace* place) { return place->jacobian.known || solve(0.0f, place) == SearchEnd::Found; }

SearchEnd FilmSearch::step(float time, const FilmPlace& from, const Vec2& guess, FilmPlace* place) {
  ++counts_.time;
  *place = from;
  place->film = guess;
  const SearchEnd end = solve(time, place);
  if (end != SearchEnd::Found) return end;
  const Aim aim(target(time), place->chain.ray.ray.origin);
  const bool near = glm::length(place->film - guess) < kNear;
  return is_same_image(from.jacobian, place->jacobian, aim, near) ? SearchEnd::Found : SearchEnd::Turned;
}

SearchEnd FilmSearch::leap(const FilmPlace& from, const Vec2& guess, FilmPlace* place) {
  return step(1.0f, from, guess, place);
}

SearchEnd FilmSearch::march(const FilmPlace& from, FilmPlace* place) {
  FilmPlace at = from;
  SearchEnd end = SearchEnd::Stuck;
  Vec2 speed = problem_.moved;
  float done = 0.0f, advance = kFirstAdvance;
  while (done < 1.0f && advance >= kSmallestAdvance) {
    const float next = std::min(1.0f, done + advance);
    end = step(next, at, at.film + speed * (next - done), place);
    if (end == SearchEnd::Found) {
      speed = (place->film - at.film) / (next - done);
      at = *place;
      done = next;
    }
    advance *= end == SearchEnd::Found ? 2.0f : 0.5f;
  }
  return end;
}

}  // namespace gradus::motion
