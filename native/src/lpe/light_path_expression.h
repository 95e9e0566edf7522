// A path expression as a nondeterministic automaton (Thompson's construction).
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace gradus::lpe {

// Letters of path words.
enum class LpeEvent : uint8_t { D, R, T, E, L };

class LightPathExpression {
 public:
  using States = std::vector<uint32_t>;  // in ascending order

  // Throws invalid_argument with the place of what is no expression. Blanks are passed over.
  explicit LightPathExpression(std::string_view text);

  States start() const { return closure({0}); }
  States step(const States& from, LpeEvent event) const;
  bool accepts(const States& states) const;

 private:
  friend class ExpressionParser;
  static constexpr uint32_t kNone = UINT32_MAX;
  // Goes on to both `next` by no letter, or to the first by one of `letters`.
  struct State {
    uint8_t events = 0;  // bits of LpeEvent
    uint32_t next[2] = {kNone, kNone};
  };
  States closure(States states) const;

  std::vector<State> states_;
  uint32_t end_ = 0;
};

}  // namespace gradus::lpe
