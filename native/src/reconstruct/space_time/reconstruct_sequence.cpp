#include "reconstruct/space_time/reconstruct_sequence.h"

#include "reconstruct/solver_planes.h"

namespace gradus {

void reconstruct_window(const WindowSource& source, uint32_t reconstruction, float alpha, const CancelTest& cancel, SolveReport* report,
                        const std::function<void(int t, std::vector<float> image)>& take) {
  const WindowSize size = source.size();
  WindowSolver solver(source, reconstruction, alpha, cancel, report);
  std::vector<Frames> parts;
  parts.push_back(solver.take_solution());
  for (int c = parts.front().front().channels(); c < size.channels; ++c) parts.push_back(solver.apply(source, c, 1, cancel, report));
  if (cancel()) return;
  for (int t = 0; t < size.frames; ++t) {
    std::vector<float> image(size_t(size.width) * size_t(size.height) * size_t(size.channels));
    int channel = 0;
    for (Frames& part : parts) {
      const Field field = std::move(part[size_t(t)]);
      for (int c = 0; c < field.channels(); ++c) store_channel(field, c, size_t(size.channels), image.data() + channel++);
    }
    take(t, std::move(image));
  }
}

void reconstruct_sequence(const FrameRange& range, const OpenWindow& open, uint32_t reconstruction, float alpha, const CancelTest& cancel,
                          SolveReport* report, const WindowBlend::Take& take) {
  const WindowGrid grid(range);
  WindowBlend blend(grid, take);
  for (int window = grid.first(); window <= grid.last() && !cancel(); ++window) {
    const FrameRange frames = grid.frames(window);
    const std::unique_ptr<WindowSource> source = open(frames);
    reconstruct_window(*source, reconstruction, alpha, cancel, report,
                       [&](int t, std::vector<float> image) { blend.add(window, frames.first + t, std::move(image)); });
  }
}

}  // namespace gradus
