#include "reconstruct/space_time/reconstruct_window.h"

#include <optional>
#include <utility>

#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {
namespace {

// Half the differences of the halves in the place of the values.
class HalfDifferences final : public WindowSource {
 public:
  explicit HalfDifferences(const HalvedWindowSource& source) : source_(source) {}
  WindowSize size() const override { return source_.size(); }
  void read_row(RowKind kind, int t, int y, float* out) const override {
    source_.read_half_differences(kind, t, y, out);
  }
  void read_correspondence(int t, int y, int32_t* out) const override { source_.read_correspondence(t, y, out); }

 private:
  const HalvedWindowSource& source_;
};

// Of the first three channels, by frames.
class WindowErrors {
 public:
  WindowErrors(const HalvedWindowSource& source, uint32_t reconstruction, float alpha, const CancelCheck& cancel,
               SolveReport* report)
      : noise_(l2(HalfDifferences(source), alpha, cancel, report)) {
    if (reconstruction != GRADUS_RECONSTRUCTION_L2) l2_ = l2(source, alpha, cancel, report);
  }

  // Once.
  ErrorTerms take(int t, const Field& picture) {
    ErrorTerms terms{interleave(std::exchange(noise_[size_t(t)], {})), {}};
    if (l2_) {
      terms.l2_difference = interleave(picture);
      const std::vector<float> other = interleave(std::exchange((*l2_)[size_t(t)], {}));
      for (size_t i = 0; i < other.size(); ++i) terms.l2_difference[i] -= other[i];
    }
    return terms;
  }

 private:
  static Frames l2(const WindowSource& source, float alpha, const CancelCheck& cancel, SolveReport* report) {
    return WindowSolver(source, GRADUS_RECONSTRUCTION_L2, alpha, cancel, report).take_solution();
  }

  Frames noise_;
  std::optional<Frames> l2_;
};

}  // namespace

void reconstruct_window(const HalvedWindowSource& source, uint32_t reconstruction, float alpha, bool with_error,
                        const CancelCheck& cancel, SolveReport* report,
                        const std::function<void(int t, Reconstructed picture)>& take) {
  const WindowSize size = source.size();
  WindowSolver solver(source, reconstruction, alpha, cancel, report);
  std::vector<Frames> parts;
  parts.push_back(solver.take_solution());
  for (int c = parts.front().front().channels(); c < size.channels; ++c)
    parts.push_back(solver.apply(source, c, 1, cancel, report));
  std::optional<WindowErrors> errors;
  if (with_error && !cancel()) errors.emplace(source, reconstruction, alpha, cancel, report);
  if (cancel()) return;
  for (int t = 0; t < size.frames; ++t) {
    Reconstructed picture{std::vector<float>(size_t(size.width) * size_t(size.height) * size_t(size.channels)), {}};
    if (errors) picture.terms = errors->take(t, parts.front()[size_t(t)]);
    int channel = 0;
    for (Frames& part : parts) {
      const Field field = std::move(part[size_t(t)]);
      for (int c = 0; c < field.channels(); ++c)
        store_channel(field, c, size_t(size.channels), picture.image.data() + channel++);
    }
    take(t, std::move(picture));
  }
}

}  // namespace gradus::reconstruct
