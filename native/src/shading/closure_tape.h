// The closures of one run of a node program, with what went into them. Where the program's values look at the point
// alone, this is enough to see the point from another direction, without running textures again: so shifted paths see a
// vertex of their base.
#pragma once

#include <algorithm>
#include <array>

#include "shading/closure_ops.h"
#include "shading/program.h"

namespace gradus::shading {

class ClosureTape {
 public:
  void clear() {
    count_ = 0;
    complete_ = false;
  }
  void finish() { complete_ = count_ <= kRoom; }
  // inputs: that have to be kept; 0: they are the program's constants.
  void add(const ClosureArgs& args, int inputs) {
    if (count_ < kRoom) {
      Entry& entry = entries_[static_cast<size_t>(count_)];
      entry.args = args;
      if (inputs > 0) {
        std::copy_n(args.in, inputs, entry.in);
        entry.args.in = entry.in;
      }
    }
    ++count_;
  }
  // False: nothing was recorded, or more closures than there is room for.
  bool replay(const ShadeContext& context, ShadeResult* result) const {
    if (!complete_) return false;
    for (int i = 0; i < count_; i++) add_closure(entries_[static_cast<size_t>(i)].args, context, result);
    return true;
  }

 private:
  static constexpr int kRoom = 8;
  struct Entry {
    ClosureArgs args;
    Vec4 in[kMaxInputs];
  };
  std::array<Entry, kRoom> entries_;
  int count_ = 0;
  bool complete_ = false;
};

}  // namespace gradus::shading
