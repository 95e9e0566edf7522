#include "path/path_expression.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace gradus {

namespace {

constexpr size_t kDeepest = 64;  // parentheses in parentheses

constexpr uint8_t bit(PathLetter letter) { return uint8_t(1u << unsigned(letter)); }

// 0: no letter.
uint8_t letters_of(char c) {
  switch (c) {
    case 'D':
      return bit(PathLetter::D);
    case 'R':
      return bit(PathLetter::R);
    case 'T':
      return bit(PathLetter::T);
    case 'E':
      return bit(PathLetter::E);
    case 'L':
      return bit(PathLetter::L);
    case '.':
      return bit(PathLetter::D) | bit(PathLetter::R) | bit(PathLetter::T);
    default:
      return 0;
  }
}

}  // namespace

// expression = sequence { "|" sequence };  sequence = { factor };  factor = ( letter | "." | "(" expression ")" ) { "*" | "+" | "?" }
class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, PathExpression* to) : text_(text), to_(*to) {}

  void parse() {
    const uint32_t first = state();  // number 0 is where it starts
    const Part all = expression();
    if (at_ < text_.size()) fail("there is no '(' for this ')'");
    to_.states_[first].next[0] = all.begin;
    to_.end_ = all.end;
  }

 private:
  struct Part {
    uint32_t begin, end;
  };

  uint32_t state() {
    to_.states_.emplace_back();
    return uint32_t(to_.states_.size() - 1);
  }
  void link(uint32_t from, uint32_t to) {
    uint32_t* next = to_.states_[from].next;
    next[next[0] == PathExpression::kNone ? 0 : 1] = to;
  }
  char peek() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw invalid_argument("path expression \"" + std::string(text_) + "\", character " + std::to_string(at_ + 1) + ": " + what);
  }

  Part expression() {
    Part all = sequence();
    while (peek() == '|') {
      ++at_;
      const Part other = sequence();
      const Part either{state(), state()};
      link(either.begin, all.begin);
      link(either.begin, other.begin);
      link(all.end, either.end);
      link(other.end, either.end);
      all = either;
    }
    return all;
  }

  Part sequence() {
    const uint32_t begin = state();
    Part all{begin, begin};
    for (char c = peek(); c != '\0' && c != '|' && c != ')'; c = peek()) {
      const Part next = factor();
      link(all.end, next.begin);
      all.end = next.end;
    }
    return all;
  }

  Part factor() {
    Part part = atom();
    for (char c = peek(); c == '*' || c == '+' || c == '?'; c = peek()) {
      ++at_;
      const Part repeated{state(), state()};
      link(repeated.begin, part.begin);
      if (c != '+') link(repeated.begin, repeated.end);
      if (c != '?') link(part.end, part.begin);
      link(part.end, repeated.end);
      part = repeated;
    }
    return part;
  }

  Part atom() {
    const char c = peek();
    if (c == '(') return group();
    const uint8_t letters = letters_of(c);
    if (letters == 0)
      fail(std::string("'") + c + "' is none of E D R T L . * + ? | ( )" +
           (c == '*' || c == '+' || c == '?' ? " that can stand here" : ""));
    ++at_;
    const Part part{state(), state()};
    to_.states_[part.begin].letters = letters;
    link(part.begin, part.end);
    return part;
  }

  Part group() {
    if (++depth_ > kDeepest) fail("parentheses are too deep");
    ++at_;
    const Part part = expression();
    if (peek() != ')') fail("a ')' is missing");
    ++at_;
    --depth_;
    return part;
  }

  const std::string_view text_;
  PathExpression& to_;
  size_t at_ = 0, depth_ = 0;
};

PathExpression::PathExpression(std::string_view text) { ExpressionParser(text, this).parse(); }

PathExpression::States PathExpression::closure(States states) const {
  std::vector<bool> is_in(states_.size(), false);
  States todo = std::move(states), all;
  while (!todo.empty()) {
    const uint32_t s = todo.back();
    todo.pop_back();
    if (is_in[s]) continue;
    is_in[s] = true;
    all.push_back(s);
    if (states_[s].letters != 0) continue;
    for (const uint32_t next : states_[s].next) {
      if (next != kNone) todo.push_back(next);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

PathExpression::States PathExpression::step(const States& from, PathLetter letter) const {
  States to;
  for (const uint32_t s : from) {
    if ((states_[s].letters & bit(letter)) != 0) to.push_back(states_[s].next[0]);
  }
  return closure(std::move(to));
}

bool PathExpression::accepts(const States& states) const { return std::binary_search(states.begin(), states.end(), end_); }

}  // namespace gradus
