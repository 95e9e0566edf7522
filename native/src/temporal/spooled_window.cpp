#include "temporal/spooled_window.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <iterator>
#include <vector>

#include "base/error.h"
#include "temporal/frame_window.h"

namespace gradus {

namespace {

bool is_of_pixels(RowKind kind) { return kind == RowKind::kPrimal || kind == RowKind::kDt; }

}  // namespace

SpooledWindow::SpooledWindow(int frames, const LoadPart& base, const LoadPart& replay) {
  size_.frames = frames;
  int t = 0;
  for_temporal_frames(frames, base, replay,
                      [&](std::shared_ptr<const TemporalFrame> frame, const std::shared_ptr<const TemporalFrame>& next) {
                        gradients_ = !frame->base.values.dx.empty();
                        std::vector<std::shared_ptr<const TemporalFrame>> pair{std::move(frame)};
                        if (next) pair.push_back(next);
                        write(FrameWindow(std::move(pair)), t++);
                      });
}

void SpooledWindow::write(const HalvedWindowSource& rows, int t) {
  const WindowSize of_rows = rows.size();
  size_ = {of_rows.width, of_rows.height, of_rows.channels, size_.frames};
  const bool is_last = of_rows.frames == 1;
  tbb::parallel_for(0, size_.height, [&](int y) {
    std::vector<float> row(size_t(size_.width) * size_t(size_.channels));
    for (const RowKind kind : kRowKinds) {
      if ((is_last && is_temporal(kind)) || (!gradients_ && !is_of_pixels(kind))) continue;
      rows.read_row(kind, 0, y, row.data());
      file_.write(place_of(kind, t, y, kValues), row.data(), row_bytes());
      rows.read_half_differences(kind, 0, y, row.data());
      file_.write(place_of(kind, t, y, kHalfDifferences), row.data(), row_bytes());
    }
    if (is_last) return;
    std::vector<int32_t> links(size_t(size_.width));
    rows.read_links(0, y, links.data());
    file_.write(place_of_links(t, y), links.data(), links.size() * sizeof(int32_t));
  });
}

size_t SpooledWindow::row_bytes() const { return size_t(size_.width) * size_t(size_.channels) * sizeof(float); }

uint64_t SpooledWindow::place_of(RowKind kind, int t, int y, Part part) const {
  const uint64_t plane = (uint64_t(t) * std::size(kRowKinds) + uint64_t(kind)) * kParts + part;
  return (plane * uint64_t(size_.height) + uint64_t(y)) * row_bytes();
}

uint64_t SpooledWindow::place_of_links(int t, int y) const {
  const uint64_t planes = place_of(RowKind::kPrimal, size_.frames, 0, kValues);
  return planes + (uint64_t(t) * uint64_t(size_.height) + uint64_t(y)) * uint64_t(size_.width) * sizeof(int32_t);
}

void SpooledWindow::read(RowKind kind, int t, int y, Part part, float* out) const {
  if (!gradients_ && !is_of_pixels(kind)) throw invalid_operation("the stored frames hold no gradients");
  file_.read(place_of(kind, t, y, part), out, row_bytes());
}

void SpooledWindow::read_row(RowKind kind, int t, int y, float* out) const { read(kind, t, y, kValues, out); }

void SpooledWindow::read_half_differences(RowKind kind, int t, int y, float* out) const { read(kind, t, y, kHalfDifferences, out); }

void SpooledWindow::read_links(int t, int y, int32_t* out) const {
  file_.read(place_of_links(t, y), out, size_t(size_.width) * sizeof(int32_t));
}

}  // namespace gradus
