#include "camera/shutter.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"
#include "base/types.h"

namespace gradus::camera {

Shutter::Shutter(const GradusCamera& desc) {
  if (!is_finite(desc.shutter_open) || !is_finite(desc.shutter_close)) return;
  open_ = desc.shutter_open;
  close_ = std::max(desc.shutter_close, open_);
  if (desc.shutter_curve == nullptr || desc.shutter_curve_count < 2) return;
  for (uint32_t i = 0; i < desc.shutter_curve_count; ++i) {
    const float value = desc.shutter_curve[i];
    curve_.push_back(is_finite(value) ? std::max(value, 0.0f) : 0.0f);
  }
  // The curve's scale has no meaning. Normalisation prevents overflow of squares in sample().
  const float maximum = *std::max_element(curve_.begin(), curve_.end());
  for (float& value : curve_) value = maximum > 0.0f ? value / maximum : 0.0f;
  double sum = 0.0;
  std::vector<double> sums;
  for (size_t i = 1; i < curve_.size(); ++i) sums.push_back(sum += 0.5 * (double(curve_[i - 1]) + double(curve_[i])));
  if (!(sum > 0.0)) close_ = open_;
  for (const double part : sums) cumulative_.push_back(sum > 0.0 ? float(part / sum) : 1.0f);
}

float Shutter::time_of_frame() const {
  if (GRADUS_FAULT(frame_position_in_exposure_ignored)) return 0.5f;
  return opens() ? std::clamp(-open_ / (close_ - open_), 0.0f, 1.0f) : 0.0f;
}

float Shutter::sample(float u) const {
  if (cumulative_.empty() || GRADUS_FAULT(shutter_curve_ignored)) return u;
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u);
  const auto i = size_t(found - cumulative_.begin());
  const float before = i > 0 ? cumulative_[i - 1] : 0.0f;
  const float inside = std::clamp((u - before) / std::max(*found - before, 1e-30f), 0.0f, 1.0f);
  // Inverts the integral of the line from a to b, in a form that is valid for a = b and a = 0.
  const float a = curve_[i], b = curve_[i + 1];
  const float root = std::sqrt(a * a + (b * b - a * a) * inside);
  const float x = a + root > 0.0f ? (a + b) * inside / (a + root) : 0.0f;
  return std::min((float(i) + std::min(x, 1.0f)) / float(cumulative_.size()), 1.0f);
}

}  // namespace gradus::camera
