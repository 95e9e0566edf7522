#include "lpe/light_path_expression.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace gradus::lpe {

namespace {

constexpr size_t kMaxDepth = 64;  // of nested parentheses

constexpr uint8_t bit(LpeEvent event) { return uint8_t(1u << unsigned(event)); }

// Returns the bits of the events that a character stands for, or 0.
uint8_t events_of(char c) {
  switch (c) {
    case 'D':
      return bit(LpeEvent::D);
    case 'R':
      return bit(LpeEvent::R);
    case 'T':
      return bit(LpeEvent::T);
    case 'E':
      return bit(LpeEvent::E);
    case 'L':
      return bit(LpeEvent::L);
    case '.':
      return bit(LpeEvent::D) | bit(LpeEvent::R) | bit(LpeEvent::T);
    default:
      return 0;
  }
}

}  // namespace

// Builds the automaton of an expression by recursive descent. The grammar is
//   expression = sequence { "|" sequence }
//   sequence = { factor }
//   factor = ( event | "." | "(" expression ")" ) { "*" | "+" | "?" }
class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, LightPathExpression* to) : text_(text), to_(*to) {}

  void parse() {
    const uint32_t first = add_state();  // state 0, the start
    const Fragment all = expression();
    if (at_ < text_.size()) fail("there is no '(' for this ')'");
    to_.states_[first].next[0] = all.begin;
    to_.end_ = all.end;
  }

 private:
  // A part of the automaton, entered at `begin` and left at `end`.
  struct Fragment {
    uint32_t begin, end;
  };

  uint32_t add_state() {
    to_.states_.emplace_back();
    return uint32_t(to_.states_.size() - 1);
  }
  // Adds a transition without an event, or the one by the events of `from`.
  void link(uint32_t from, uint32_t to) {
    uint32_t* next = to_.states_[from].next;
    next[next[0] == LightPathExpression::kNone ? 0 : 1] = to;
  }
  // Returns the next character that is not blank, or '\0' at the end.
  char peek() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw invalid_argument("path expression \"" + std::string(text_) + "\", character " + std::to_string(at_ + 1) +
                           ": " + what);
  }

  Fragment expression() {
    Fragment all = sequence();
    while (peek() == '|') {
      ++at_;
      const Fragment other = sequence();
      const Fragment either{add_state(), add_state()};
      link(either.begin, all.begin);
      link(either.begin, other.begin);
      link(all.end, either.end);
      link(other.end, either.end);
      all = either;
    }
    return all;
  }

  Fragment sequence() {
    const uint32_t begin = add_state();
    Fragment all{begin, begin};
    for (char c = peek(); c != '\0' && c != '|' && c != ')'; c = peek()) {
      const Fragment next = factor();
      link(all.end, next.begin);
      all.end = next.end;
    }
    return all;
  }

  Fragment factor() {
    Fragment fragment = atom();
    for (char c = peek(); c == '*' || c == '+' || c == '?'; c = peek()) {
      ++at_;
      const Fragment repeated{add_state(), add_state()};
      link(repeated.begin, fragment.begin);
      if (c != '+') link(repeated.begin, repeated.end);
      if (c != '?') link(fragment.end, fragment.begin);
      link(fragment.end, repeated.end);
      fragment = repeated;
    }
    return fragment;
  }

  Fragment atom() {
    const char c = peek();
    if (c == '(') return group();
    const uint8_t events = events_of(c);
    if (events == 0)
      fail(std::string("'") + c + "' is none of E D R T L . * + ? | ( )" +
           (c == '*' || c == '+' || c == '?' ? " that can stand here" : ""));
    ++at_;
    const Fragment fragment{add_state(), add_state()};
    to_.states_[fragment.begin].events = events;
    link(fragment.begin, fragment.end);
    return fragment;
  }

  Fragment group() {
    if (++depth_ > kMaxDepth) fail("parentheses are too deep");
    ++at_;
    const Fragment fragment = expression();
    if (peek() != ')') fail("a ')' is missing");
    ++at_;
    --depth_;
    return fragment;
  }

  const std::string_view text_;
  LightPathExpression& to_;
  size_t at_ = 0, depth_ = 0;
};

LightPathExpression::LightPathExpression(std::string_view text) { ExpressionParser(text, this).parse(); }

LightPathExpression::States LightPathExpression::closure(States states) const {
  std::vector<bool> is_in(states_.size(), false);
  States todo = std::move(states), all;
  while (!todo.empty()) {
    const uint32_t s = todo.back();
    todo.pop_back();
    if (is_in[s]) continue;
    is_in[s] = true;
    all.push_back(s);
    if (states_[s].events != 0) continue;
    for (const uint32_t next : states_[s].next) {
      if (next != kNone) todo.push_back(next);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

LightPathExpression::States LightPathExpression::step(const States& from, LpeEvent event) const {
  States to;
  for (const uint32_t s : from) {
    if ((states_[s].events & bit(event)) != 0) to.push_back(states_[s].next[0]);
  }
  return closure(std::move(to));
}

bool LightPathExpression::accepts(const States& states) const {
  return std::binary_search(states.begin(), states.end(), end_);
}

}  // namespace gradus::lpe
