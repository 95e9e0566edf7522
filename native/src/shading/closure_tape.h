// A record of the closure operations of one run of a node program. If the program's values depend on the point alone,
// the record suffices to shade the point for another direction without evaluating textures again. Shifted paths use it
// at the vertices of their base path.
#pragma once

#include <algorithm>
#include <array>

#include "shading/closure_ops.h"
#include "shading/program.h"

namespace gradus::shading {

// Records closure operations with their inputs, at most kCapacity of them. Usage: clear(), add()…, finish(), replay().
class ClosureTape {
 public:
  void clear() {
    count_ = 0;
    complete_ = false;
  }
  void finish() { complete_ = count_ <= kCapacity; }
  // Records an operation. `inputs` is the number of inputs to copy; 0 means that args.in points to the program's
  // constants, which outlive the record.
  void add(const ClosureArgs& args, int inputs) {
    if (count_ < kCapacity) {
      Entry& entry = entries_[static_cast<size_t>(count_)];
      entry.args = args;
      if (inputs > 0) {
        std::copy_n(args.in, inputs, entry.in);
        entry.args.in = entry.in;
      }
    }
    ++count_;
  }
  // Runs the recorded operations for another context. Returns false if nothing was recorded or kCapacity was exceeded.
  bool replay(const ShadeContext& context, ShadeResult* result) const {
    if (!complete_) return false;
    for (int i = 0; i < count_; i++) add_closure(entries_[static_cast<size_t>(i)].args, context, result);
    return true;
  }

 private:
  static constexpr int kCapacity = 8;
  struct Entry {
    ClosureArgs args;
    Vec4 in[kMaxInputs];
  };
  std::array<Entry, kCapacity> entries_;
  int count_ = 0;
  bool complete_ = false;
};

}  // namespace gradus::shading
