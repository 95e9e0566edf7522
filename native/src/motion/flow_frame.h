// A frame as input of optical flow: its grey levels, on a scale that both frames share, and what is known of the motion
// of its surfaces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motion/film_plane.h"
#include "motion/irradiance_motion.h"

namespace gradus::motion {

// Finds pixels that show an edge of an object: they show more than one surface, and the surfaces may move differently.
// Returns for each pixel of the film 1 if one of its eight neighbours shows another object, or if the depth has a step
// between it and a neighbour in its row or column; otherwise 0. `object` and `depth` hold one value for each pixel, row
// by row, or are empty if not known. A depth of 0, or one that is not finite, means that there is no surface.
std::vector<uint8_t> silhouettes(int width, int height, std::span<const int32_t> object, std::span<const float> depth);

class FlowFrame {
 public:
  // `image`, and the `tracked` values of `frame`, must outlive the object.
  FlowFrame(const GreyImage& image, const ComponentFrame& frame);

  const GreyImage& image() const { return image_; }
  int width() const { return image_.width; }
  int height() const { return image_.height; }
  size_t count() const { return surface_.size(); }

  FilmPlane<float> levels() const { return plane(image_.levels); }
  const std::vector<Vec2>& surface() const { return surface_; }  // motion of surfaces: finite, no longer than the film
  std::span<const float> tracked() const { return tracked_; }
  const std::vector<int32_t>& object() const { return object_; }  // all 0 if objects are not known
  bool shows_edge(size_t pixel) const { return edges_[pixel] != 0; }

  // Returns the position of a pixel's centre, as of film_plane.h.
  Vec2 place(size_t pixel) const {
    const size_t row = pixel / size_t(width());
    return Vec2(float(pixel - row * size_t(width())), float(row));
  }
  // Returns the pixel whose centre is nearest to a position.
  size_t nearest(const Vec2& place) const;
  // Returns whether a position lies on the film.
  bool holds(const Vec2& place) const;

  template <class T>
  FilmPlane<T> plane(const std::vector<T>& values) const {
    return {width(), height(), values};
  }

 private:
  const GreyImage& image_;
  std::vector<Vec2> surface_;
  std::span<const float> tracked_;
  std::vector<int32_t> object_;
  std::vector<uint8_t> edges_;
};

}  // namespace gradus::motion
