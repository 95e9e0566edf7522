// A light path expression as a nondeterministic automaton (Thompson's construction).
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace gradus::lpe {

// Events of a path: scattering in class D, R or T, the camera (E) and light (L).
enum class LpeEvent : uint8_t { D, R, T, E, L };

class LightPathExpression {
 public:
  using States = std::vector<uint32_t>;  // set of states in ascending order

  // Parses an expression; blanks are ignored. Throws invalid_argument with the place of a syntax error.
  explicit LightPathExpression(std::string_view text);

  // Returns the states before the first event.
  States start() const { return closure({0}); }
  // Returns the states after one more event.
  States step(const States& from, LpeEvent event) const;
  // Returns whether the expression matches the events that have led to these states.
  bool accepts(const States& states) const;

 private:
  friend class ExpressionParser;
  static constexpr uint32_t kNone = UINT32_MAX;
  // With `events`, one of them leads to next[0]. Without, both elements of `next` are reached without an event.
  struct State {
    uint8_t events = 0;  // bits of LpeEvent
    uint32_t next[2] = {kNone, kNone};
  };
  // Adds the states that are reached without an event.
  States closure(States states) const;

  std::vector<State> states_;
  uint32_t end_ = 0;
};

}  // namespace gradus::lpe
