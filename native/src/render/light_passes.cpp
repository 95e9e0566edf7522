#include "render/light_passes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/stop_if.h"
#include "base/types.h"
#include "frame/pass_planes.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/feature_filter.h"
#include "reconstruct/field_values.h"
#include "reconstruct/partition.h"
#include "reconstruct/solver_planes.h"
#include "settings/pass_table.h"

namespace gradus {
namespace {

constexpr float kMaxFloat = std::numeric_limits<float>::max();
// What a colour must be for light to be found again in the quotient by it.
constexpr float kLeastColor = 1e-6f;

using Sums = std::array<Radiance, kHalves>;

// From sums of both halves: sums_at(pixel).
template <class SumsAt>
HalvedImage read_halves(const Frame& frame, const SumsAt& sums_at) {
  const int w = frame.region.width(), h = frame.region.height();
  HalvedImage image{Field(w, h, 3), Field(w, h, 3)};
  for_rows(h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const size_t i = size_t(y) * size_t(w) + size_t(x);
      const Sums sums = sums_at(i);
      const auto a = float(frame.count[0][i]), b = float(frame.count[1][i]);
      for (int c = 0; c < 3; ++c) {
        const float mean = (sums[0][c] + sums[1][c]) / (a + b), half = 0.5f * (sums[0][c] / a - sums[1][c] / b);
        image.mean.row(y, c)[x] = is_finite(mean) ? mean : 0.0f;
        image.half_difference.row(y, c)[x] = half;  // not finite where a half has no samples
      }
    }
  });
  return image;
}

// Where a half has no samples what differs from the pixels around stands for the noise.
void guess_noise(const Frame& frame, HalvedImage* image) {
  const auto is_missing = [](uint32_t count) { return count == 0; };
  const auto is_in = [&](const std::vector<uint32_t>& counts) { return std::any_of(counts.begin(), counts.end(), is_missing); };
  if (!is_in(frame.count[0]) && !is_in(frame.count[1])) return;
  const Field around = box_mean(image->mean, 1);
  for_values(&image->half_difference, [&](float& value, int x, int y, int c) {
    if (!is_finite(value)) value = image->mean.row(y, c)[x] - around.row(y, c)[x];
  });
}

Sums sums_of(const PassPlane& plane, size_t pixel) {
  Sums sums;
  for (int half = 0; half < kHalves; ++half) {
    const float* v = plane.values[half].data() + 3 * pixel;
    sums[half] = Radiance(v[0], v[1], v[2], 0.0f);
  }
  return sums;
}

std::vector<const PassPlane*> light_planes(const Frame& frame) {
  std::vector<const PassPlane*> planes;
  for (const PassPlane& plane : frame.passes) {
    if (wants(light_passes(), plane.pass)) planes.push_back(&plane);
  }
  return planes;
}

bool are_all(const std::vector<const PassPlane*>& planes) {
  uint64_t passes = 0;
  for (const PassPlane* plane : planes) passes |= uint64_t{1} << plane->pass;
  return passes == light_passes();
}

// What of the light is in none of the planes.
Sums rest_of(const Frame& frame, const std::vector<const PassPlane*>& planes, size_t pixel) {
  Sums rest{Radiance(0.0f), Radiance(0.0f)};
  for (int half = 0; half < kHalves; ++half) {
    for (const ComponentPlanes& component : frame.components) rest[half] += component.primal[half][pixel];
  }
  for (const PassPlane* plane : planes) {
    const Sums sums = sums_of(*plane, pixel);
    for (int half = 0; half < kHalves; ++half) rest[half] -= sums[half];
  }
  return rest;
}

Field crop(const Field& field, const Frame& frame, const Region& region) {
  Field part(region.width(), region.height(), field.channels());
  const int x0 = region.x0 - frame.region.x0, y0 = region.y0 - frame.region.y0;
  for_values(&part, [&](float& value, int x, int y, int c) { value = field.row(y + y0, c)[x + x0]; });
  return part;
}

Field rgb_of(const std::vector<float>& rgba, const Region& region) {
  Field field(region.width(), region.height(), 3);
  const size_t w = size_t(region.width());
  for_values(&field, [&](float& value, int x, int y, int c) { value = rgba[4 * (size_t(y) * w + size_t(x)) + size_t(c)]; });
  return field;
}

// Means of a colour pass.
Field color_of(const Frame& frame, const PassPlane& plane, const Region& region) {
  Field color(region.width(), region.height(), 3);
  for_values(&color, [&](float& value, int x, int y, int c) {
    const size_t i = frame.index(region.x0 + x, region.y0 + y);
    const uint32_t n = samples_at(frame, i);
    value = n > 0 ? plane.values[0][3 * i + size_t(c)] / float(n) : 0.0f;
  });
  return color;
}

// At its silhouette a surface has little of a pixel, and light that lacks there would be a great quotient.
Field room_of(const Field& color) {
  Field room = box_mean(color, 1);
  for_values(&room, [&](float& value, int x, int y, int c) {
    const float own = color.row(y, c)[x];
    value = own >= kLeastColor ? std::min(own / value, 1.0f) : 0.0f;
  });
  return room;
}

// A frame without features is guided by what it has become, of which the parts have the edges.
Features guides_by(const Field& picture, const Frame& frame, const Region& region) {
  const int w = frame.region.width(), h = frame.region.height();
  const float scale = robust_scale(picture);
  Features guides{w, h, {3, {}, {}}, {3, {}, {}}, {1, {}, {}}};
  guides.normal.values.resize(3 * size_t(w) * size_t(h));
  guides.albedo.values.resize(guides.normal.values.size());
  guides.depth.values.resize(size_t(w) * size_t(h));
  for_rows(h, [&](int y) {
    const int from_y = std::clamp(y + frame.region.y0 - region.y0, 0, region.height() - 1);
    for (int x = 0; x < w; ++x) {
      const int from_x = std::clamp(x + frame.region.x0 - region.x0, 0, region.width() - 1);
      for (int c = 0; c < 3; ++c) {
        const float value = picture.row(from_y, c)[from_x];
        guides.normal.values[3 * (size_t(y) * size_t(w) + size_t(x)) + size_t(c)] = value / (std::fabs(value) + scale);
      }
    }
  });
  return guides;
}

FeatureImage read_color(const Frame& frame, const PassPlane& plane) {
  FeatureImage color{3, std::vector<float>(3 * size_t(frame.region.area())), {}};
  for (size_t i = 0; i < color.values.size(); ++i) {
    const uint32_t n = samples_at(frame, i / 3);
    color.values[i] = n > 0 ? plane.values[0][i] / float(n) : 0.0f;
  }
  return color;
}

// Diffuse light has the texture of its own colour. That of reflections and of what is behind glass is their surfaces' as the mirror or the
// glass shows them: the albedo of the features has it, where there are any.
Features guides_of(const Features& guides, bool has_albedo, const Frame& frame, const PassInfo& info) {
  const bool by_own = info.kind == PassKind::Light && (!has_albedo || info.color == GRADUS_PASS_DIFFUSE_COLOR);
  Features own = guides;
  if (by_own) own.albedo = read_color(frame, *find_plane(frame, info.color));
  return own;
}

}  // namespace

bool has_light_passes(const Frame& frame) { return (kept_passes(frame) & light_passes()) != 0; }

LightPasses::LightPasses(const Frame& frame, const Region& region, const std::vector<float>& rgba, const CancelTest& cancel) {
  const std::vector<const PassPlane*> planes = light_planes(frame);
  const Field whole = rgb_of(rgba, region);
  const bool has_albedo = has_features(frame);
  const Features guides = has_albedo ? filter_features(read_features(frame)) : guides_by(whole, frame, region);
  const float exposure = frame.settings.film_exposure;
  std::vector<PartPicture> parts;
  const auto add_part = [&](const Features& own, const auto& sums_at) {
    stop_if(cancel);
    HalvedImage sampled = read_halves(frame, sums_at);
    guess_noise(frame, &sampled);
    PartPicture part = regress_part(own, std::move(sampled), cancel);
    part.image = crop(part.image, frame, region);
    part.error = crop(part.error, frame, region);
    for_values(&part.image, [exposure](float& value, int, int, int) { value *= exposure; });
    for_values(&part.error, [exposure](float& value, int, int, int) { value *= exposure * exposure; });
    parts.push_back(std::move(part));
  };
  std::vector<Field> colors;
  for (const PassPlane* plane : planes) {
    const PassInfo& info = pass_info(plane->pass);
    add_part(guides_of(guides, has_albedo, frame, info), [plane](size_t i) { return sums_of(*plane, i); });
    colors.push_back(info.kind == PassKind::Light ? color_of(frame, *find_plane(frame, info.color), region) : Field());
    if (info.kind != PassKind::Light) continue;
    parts.back().room = room_of(colors.back());
  }
  if (!are_all(planes)) add_part(guides, [&](size_t i) { return rest_of(frame, planes, i); });
  stop_if(cancel);
  add_up(whole, &parts);
  for (size_t k = 0; k < planes.size(); ++k) {
    std::vector<float>& pixels = passes_[planes[k]->pass];
    pixels.resize(3 * size_t(region.area()));
    if (colors[k].width() > 0) {
      for_values(&parts[k].image, [&](float& value, int x, int y, int c) {
        const float color = colors[k].row(y, c)[x];
        value = color >= kLeastColor ? std::clamp(value / color, -kMaxFloat, kMaxFloat) : 0.0f;
      });
    }
    for (int c = 0; c < 3; ++c) store_channel(parts[k].image, c, 3, pixels.data() + c);
  }
}

bool LightPasses::read(uint32_t pass, float* pixels) const {
  const auto known = passes_.find(pass);
  if (known == passes_.end()) return false;
  std::copy(known->second.begin(), known->second.end(), pixels);
  return true;
}

size_t LightPasses::memory_bytes() const {
  size_t values = 0;
  for (const auto& [pass, pixels] : passes_) values += pixels.size();
  return values * sizeof(float);
}

}  // namespace gradus
