// Components of the picture, which are sets of light paths that light path expressions select (Zimmer et al. 2015,
// Path-space Motion Estimation and Decomposition, section 3).
//
// A path is read event by event while it grows: E for the camera, D, R or T for each scattering (non-specular, specular
// reflection, specular transmission), and L where it ends at light. A set of expressions is one deterministic automaton
// over the events after E. Each of its states knows the component of a path that finds light there.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bsdf/closures.h"

namespace gradus::lpe {

// Maximum number of components, Residual included.
inline constexpr int kMaxComponents = 16;
inline constexpr std::string_view kDefaultComponents =
    "Emission=EL;Diffuse=ED.*L;Reflection=ER(D.*)?L;Transmission=ETT(D.*)?L";
// Name of the component of all paths that no expression matches.
inline constexpr std::string_view kResidual = "Residual";

// Bits of all components.
inline constexpr uint32_t kEveryComponent = ~uint32_t{0};

// State of the automaton after the events of a path so far; 0 after E.
using LpeState = uint16_t;

struct Component {
  std::string name;
  std::string expression;  // empty for the component of all paths that no expression matches
};

class ComponentSet {
 public:
  // Makes a set with the whole picture as one component.
  ComponentSet();
  // Parses "Name=EXPRESSION;Name=EXPRESSION", or the default set if `text` is empty. Residual is added as the last
  // component. Expressions consist of events, `.` for any of D R T, `*` `+` `?` `|` and parentheses. Throws
  // invalid_argument with a message for users if an expression has a syntax error, matches no path, or matches a path
  // of another component.
  static ComponentSet parse(std::string_view text);
  // Returns the set without the components whose bit is set. Their paths belong to Residual, which is added if needed.
  ComponentSet merged(uint32_t small) const;
  // Returns the set with only the components of `kept`, as bits. No path may belong to the others.
  ComponentSet without_empty(uint32_t kept) const;

  int count() const { return int(components_.size()); }
  const Component& operator[](int i) const { return components_[size_t(i)]; }
  // Returns the index of a component, or -1.
  int find(std::string_view name) const;
  // Returns the bits of all components.
  uint32_t all() const { return (uint32_t{1} << count()) - 1; }
  // Returns the bit of Residual, or 0 if the set has none.
  uint32_t residual() const { return components_.back().name == kResidual ? uint32_t{1} << (count() - 1) : 0; }

  // Returns the state after one more scattering event.
  LpeState next(LpeState state, bsdf::ScatterClass event) const { return states_[state].next[size_t(event)]; }
  // Returns the component of a path that finds light in this state.
  int component(LpeState state) const { return states_[state].component; }
  // Returns the component that has the film's alpha: that of the empty path alone, so that components add up.
  int alpha_component() const { return component(LpeState{0}); }
  // Returns the bits of the components that a path can still reach, by light in this state or in a later one.
  uint32_t ahead(LpeState state) const { return states_[state].ahead; }
  // Returns the bits of the components of paths that scatter at least once, and only in the classes of `events`, as
  // bits.
  uint32_t reached(uint32_t events) const;

  // Returns the component of a path that is written as its events ("ETTDL"). Throws invalid_argument if it is no path.
  int classify(std::string_view path) const;
  // Returns the shortest paths of a component, at most `maximum`. It is empty if no path is left for Residual.
  std::vector<std::string> examples(int component, size_t maximum) const;

 private:
  struct State {
    std::array<LpeState, bsdf::kPathEvents> next{};
    uint8_t component = 0;
    uint32_t ahead = 1;
  };
  // Computes State::ahead of all states.
  void look_ahead();
  // Returns the set with the components of `kept`, as bits. Paths of others belong to the new component `remainder`.
  ComponentSet with(uint32_t kept, uint8_t remainder) const;

  std::vector<Component> components_;
  std::vector<State> states_;
};

}  // namespace gradus::lpe
