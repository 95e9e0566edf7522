#include "lpe/components.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "base/error.h"
#include "lpe/light_path_expression.h"

namespace gradus::lpe {

namespace {

constexpr size_t kMaxNameLength = 24;
constexpr size_t kMaxStates = 4096;
constexpr char kEventNames[] = {'D', 'R', 'T'};

// States of all expressions after the events of one path.
using Sets = std::vector<LightPathExpression::States>;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> split(std::string_view text, char by) {
  std::vector<std::string_view> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(by, begin), text.size());
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = char(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

// Checks the name of a component. Passes are named after it, so it consists of ASCII letters, digits and '_'.
void check_name(std::string_view name, const std::vector<Component>& before) {
  const auto fits = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  const bool starts = !name.empty() && fits(name[0]) && name[0] != '_' && !(name[0] >= '0' && name[0] <= '9');
  if (!starts || name.size() > kMaxNameLength || !std::all_of(name.begin(), name.end(), fits)) {
    throw invalid_argument("component \"" + std::string(name) +
                           "\": a name is a letter and then up to 23 letters, digits or '_'");
  }
  if (lower(name) == lower(kResidual))
    throw invalid_argument("component Residual is what no expression matches: it needs none");
  for (const Component& other : before) {
    if (lower(other.name) == lower(name)) throw invalid_argument("two components are called " + std::string(name));
  }
}

std::vector<Component> read_list(std::string_view text) {
  std::vector<Component> components;
  for (const std::string_view entry : split(text, ';')) {
    if (entry.empty()) continue;
    const size_t equals = entry.find('=');
    if (equals == std::string_view::npos) {
      throw invalid_argument("component \"" + std::string(entry) +
                             "\": expected Name=EXPRESSION, as in Reflection=ER(D.*)?L");
    }
    const std::string_view name = trimmed(entry.substr(0, equals)), expression = trimmed(entry.substr(equals + 1));
    check_name(name, components);
    if (expression.empty()) throw invalid_argument("component " + std::string(name) + " has no expression");
    components.push_back({std::string(name), std::string(expression)});
  }
  if (components.empty())
    throw invalid_argument("the set of components is empty: expected Name=EXPRESSION;Name=EXPRESSION");
  if (int(components.size()) >= kMaxComponents)
    throw invalid_argument("more than " + std::to_string(kMaxComponents - 1) + " components");
  return components;
}

Sets step(const std::vector<LightPathExpression>& expressions, const Sets& from, LpeEvent event) {
  Sets to;
  for (size_t i = 0; i < expressions.size(); ++i) to.push_back(expressions[i].step(from[i], event));
  return to;
}

// Returns the bits of the expressions that match a path if it finds light in these states.
uint32_t matches(const std::vector<LightPathExpression>& expressions, const Sets& sets) {
  const Sets lit = step(expressions, sets, LpeEvent::L);
  uint32_t bits = 0;
  for (size_t i = 0; i < expressions.size(); ++i) bits |= expressions[i].accepts(lit[i]) ? 1u << i : 0u;
  return bits;
}

// Throws the error of an expression that matches no path. Zimmer et al. leave out the final L, so the message says how
// to add it.
[[noreturn]] void refuse_unmatched(const Component& c) {
  std::string text = "component " + c.name + ": " + c.expression +
                     " matches no path, which is E, then D, R or T for each scattering, then L";
  if (c.expression.find('L') == std::string::npos) text += ": write (" + c.expression + ")L";
  throw invalid_argument(text);
}

}  // namespace

ComponentSet::ComponentSet() : components_{{"Combined", ""}}, states_(1) {}

ComponentSet ComponentSet::parse(std::string_view text) {
  ComponentSet set;
  set.components_ = read_list(text.empty() ? kDefaultComponents : text);
  std::vector<LightPathExpression> expressions;
  for (const Component& c : set.components_) expressions.emplace_back(c.expression);
  const size_t residual = expressions.size();
  set.components_.push_back({std::string(kResidual), ""});

  // Breadth-first search over the states of the deterministic automaton, so that `paths` has a shortest path for each
  // state.
  Sets start;
  for (const LightPathExpression& e : expressions) start.push_back(e.step(e.start(), LpeEvent::E));
  std::map<Sets, LpeState> known{{start, 0}};
  std::vector<Sets> sets{start};
  std::vector<std::string> paths{"E"};
  uint32_t matched = 0;
  set.states_.clear();
  for (size_t s = 0; s < sets.size(); ++s) {
    const uint32_t bits = matches(expressions, sets[s]);
    if ((bits & (bits - 1)) != 0) {
      const int first = __builtin_ctz(bits), second = __builtin_ctz(bits & (bits - 1));
      throw invalid_argument("components " + set[first].name + " and " + set[second].name + " overlap: both match " +
                             paths[s] + "L");
    }
    matched |= bits;
    State state;
    state.component = uint8_t(bits != 0 ? size_t(__builtin_ctz(bits)) : residual);
    for (int k = 0; k < bsdf::kPathEvents; ++k) {
      Sets next = step(expressions, sets[s], static_cast<LpeEvent>(k));
      const auto [found, is_new] = known.emplace(next, LpeState(sets.size()));
      state.next[size_t(k)] = found->second;
      if (!is_new) continue;
      if (sets.size() >= kMaxStates)
        throw invalid_argument("the path expressions are too complex: an automaton of more than 4096 states");
      sets.push_back(std::move(next));
      paths.push_back(paths[s] + kEventNames[k]);
    }
    set.states_.push_back(state);
  }
  for (size_t i = 0; i < residual; ++i) {
    if ((matched >> i & 1) == 0) refuse_unmatched(set.components_[i]);
  }
  set.look_ahead();
  return set;
}

void ComponentSet::look_ahead() {
  for (State& s : states_) s.ahead = 1u << s.component;
  for (bool changes = true; changes;) {
    changes = false;
    for (State& s : states_) {
      uint32_t ahead = s.ahead;
      for (const LpeState next : s.next) ahead |= states_[next].ahead;
      changes |= ahead != s.ahead;
      s.ahead = ahead;
    }
  }
}

ComponentSet ComponentSet::with(uint32_t kept, uint8_t remainder) const {
  ComponentSet set = *this;
  set.components_.clear();
  std::vector<uint8_t> place(components_.size(), remainder);
  for (int i = 0; i < count(); ++i) {
    if ((kept >> i & 1) == 0) continue;
    place[size_t(i)] = uint8_t(set.components_.size());
    set.components_.push_back((*this)[i]);
  }
  for (State& s : set.states_) s.component = place[s.component];
  set.look_ahead();
  return set;
}

ComponentSet ComponentSet::merged(uint32_t small) const {
  if (small == 0) return *this;
  ComponentSet set = *this;
  if (residual() == 0) set.components_.push_back({std::string(kResidual), ""});
  const uint32_t kept = (set.all() & ~small) | set.residual();
  return set.with(kept, uint8_t(__builtin_popcount(kept) - 1));
}

ComponentSet ComponentSet::without_empty(uint32_t kept) const {
  return with(kept != 0 ? kept : 1u << (count() - 1), 0);
}

uint32_t ComponentSet::reached(uint32_t events) const {
  std::vector<LpeState> states{0};
  std::vector<bool> known(states_.size());
  known[0] = true;
  uint32_t bits = 0;
  for (size_t i = 0; i < states.size(); ++i) {
    for (int k = 0; k < bsdf::kPathEvents; ++k) {
      if ((events >> k & 1) == 0) continue;
      const LpeState to = next(states[i], static_cast<bsdf::ScatterClass>(k));
      bits |= 1u << component(to);
      if (!known[to]) states.push_back(to);
      known[to] = true;
    }
  }
  return bits;
}

int ComponentSet::find(std::string_view name) const {
  const auto found =
      std::find_if(components_.begin(), components_.end(), [&](const Component& c) { return c.name == name; });
  return found != components_.end() ? int(found - components_.begin()) : -1;
}

int ComponentSet::classify(std::string_view path) const {
  const std::string_view events = trimmed(path);
  if (events.size() < 2 || events.front() != 'E' || events.back() != 'L') {
    throw invalid_argument("\"" + std::string(events) + "\" is no path: E, then D, R or T for each scattering, then L");
  }
  LpeState at = 0;
  for (const char c : events.substr(1, events.size() - 2)) {
    const auto* const event = std::find(std::begin(kEventNames), std::end(kEventNames), c);
    if (event == std::end(kEventNames))
      throw invalid_argument("\"" + std::string(events) + "\": '" + c + "' is none of D R T");
    at = next(at, static_cast<bsdf::ScatterClass>(event - std::begin(kEventNames)));
  }
  return component(at);
}

std::vector<std::string> ComponentSet::examples(int component, size_t maximum) const {
  std::vector<std::string> found;
  std::vector<std::pair<LpeState, std::string>> paths{{LpeState{0}, "E"}};
  // A shortest path to any state has fewer events than there are states. A few more events give further examples.
  const size_t maximum_length = states_.size() + 3;
  for (size_t length = 0; length <= maximum_length && found.size() < maximum && !paths.empty(); ++length) {
    std::vector<std::pair<LpeState, std::string>> longer;
    for (const auto& [at, path] : paths) {
      if (this->component(at) == component && found.size() < maximum) found.push_back(path + "L");
      for (int k = 0; k < bsdf::kPathEvents; ++k) {
        const LpeState to = next(at, static_cast<bsdf::ScatterClass>(k));
        if ((ahead(to) >> component & 1) != 0 && longer.size() < 4096) longer.emplace_back(to, path + kEventNames[k]);
      }
    }
    paths = std::move(longer);
  }
  return found;
}

}  // namespace gradus::lpe
