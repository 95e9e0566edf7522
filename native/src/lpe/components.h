// Components of the picture, by path expressions (contract 3.1, 3.2; Zimmer et al. 2015, Path-space Motion Estimation
// and Decomposition, section 3): which part of the picture a path belongs to, told letter by letter while it grows.
//
// A path's word is E, a letter for each scattering (D rough, R sharp reflection, T sharp transmission), and L where it
// ends at light. A set of expressions is one deterministic automaton over the letters after E; each of its states knows
// the component of a path that finds light there.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bsdf/closures.h"

namespace gradus::lpe {

// Residual included.
inline constexpr int kMaxComponents = 16;
inline constexpr std::string_view kDefaultComponents =
    "Emission=EL;Diffuse=ED.*L;Reflection=ER(D.*)?L;Transmission=ETT(D.*)?L";
inline constexpr std::string_view kResidual = "Residual";

// Bits of components.
inline constexpr uint32_t kEveryComponent = ~uint32_t{0};

// Where a path's word has come to. 0 after E.
using LpeState = uint16_t;

struct Component {
  std::string name;
  std::string expression;  // empty: what no expression matches
};

class ComponentSet {
 public:
  // The picture as one component.
  ComponentSet();
  // "Name=EXPR;Name=EXPR", or "" for the default set; Residual, all that no expression matches, comes last.
  // Expressions: letters, `.` for one of D R T, `*` `+` `?` `|` and parentheses. Throws invalid_argument, saying to a
  // user what is wrong: an expression that is none, that matches no path, or that matches a path of another.
  static ComponentSet parse(std::string_view text);
  // Without those whose bit is set: their paths belong to Residual, which is there then.
  ComponentSet merged(uint32_t small) const;
  // Without those that no path comes to: there is nothing to keep for them. kept: bits of some that do.
  ComponentSet without_empty(uint32_t kept) const;

  int count() const { return int(components_.size()); }
  const Component& operator[](int i) const { return components_[size_t(i)]; }
  // -1: there is none of that name.
  int find(std::string_view name) const;
  // Bits of all, and of Residual: none where no path is left for it. It is the last.
  uint32_t all() const { return (uint32_t{1} << count()) - 1; }
  uint32_t residual() const { return components_.back().name == kResidual ? uint32_t{1} << (count() - 1) : 0; }

  LpeState next(LpeState word, bsdf::ScatterClass event) const { return states_[word].next[size_t(event)]; }
  // Of a path that finds light here.
  int component(LpeState word) const { return states_[word].component; }
  // Bits of the components to which a path may still come from here, by this word or a longer one.
  uint32_t ahead(LpeState word) const { return states_[word].ahead; }
  // Bits of the components of paths that scatter once or more, by these letters alone (a bit each).
  uint32_t reached(uint32_t events) const;

  // Of a whole word as a user writes it ("ETTDL"). Throws invalid_argument where it is none.
  int classify(std::string_view word) const;
  // Shortest words of a component, at most `maximum`; none where no path is left for Residual.
  std::vector<std::string> examples(int component, size_t maximum) const;

 private:
  struct State {
    std::array<LpeState, bsdf::kScatterClasses> next{};
    uint8_t component = 0;
    uint32_t ahead = 1;
  };
  void look_ahead();
  // Paths of others belong to the one at `rest`.
  ComponentSet with(uint32_t kept, uint8_t remainder) const;

  std::vector<Component> components_;
  std::vector<State> states_;
};

}  // namespace gradus::lpe
