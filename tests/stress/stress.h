// The stress suite: scenes that are hard to render in floats, each with bounds on the number of dropped samples and
// failed shifts.
// Every case renders with gradients and all passes, reconstructs by L2 and L1, and renders in double. All results must
// be finite; a table of the counts of all cases is printed at the end. A tenth of the cases and samples runs with every
// change, all of them with GRADUS_TEST_FULL=1 (make stress).
#pragma once

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "film/film.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::stress {

using test::full_run;
using test::PathScene;
using test::Surface;

// Causes of failed shifts, in the order of Bounds::failed.
enum Cause { kMissed, kOccluded, kClass, kTotalReflection, kSide, kDensity, kJacobian, kCauses };

// Maximum counts of a case. Failures are counted per base path and offset; one offset path may fail at several light
// samples.
// The rate of failed shifts depends on the geometry, not on scale or position: shifts miss at silhouettes, are occluded
// at the edges of shadows, and lack a class where materials meet. In the corners of rooms, an offset path often lies in
// the plane of the shared vertex: then the Jacobian is 0 or, by rounding, the density is, or the connection is
// occluded. Total reflection and the wrong side occur at glass. The bounds are about twice the actual counts; wrong
// arithmetic exceeds them by far.
struct Bounds {
  std::array<double, kCauses> failed = {0.06, 0.15, 0.45, 0.05, 0.03, 0.1, 0.1};
  // Number of radiance values, gradients and features that were not finite.
  uint64_t dropped = 0;
  // Maximum difference from the image in double, in units of B8's bound (support/double_image.h). Negative: not
  // compared.
  double from_double = 1.0;

  // Bounds of a single object without corners.
  static Bounds alone();
  Bounds dropping(uint64_t samples) const;
  Bounds without_double() const;
};

struct Outcome {
  std::vector<float> noisy, l2;  // RGBA
  film::Counters counters;
};

// Returns the mean of the colours of an RGBA image.
double mean(const std::vector<float>& rgba);
// Returns the root of the mean squared difference of two RGBA images over the mean of the second.
double difference(const std::vector<float>& a, const std::vector<float>& b);
void expect_finite(const std::vector<float>& values, const std::string& what);

// Returns a number with few digits, for names of cases.
std::string text_of(double value);

// Returns default settings for a small picture, with enough bounces for chains of glass.
GradusSettings small_picture();
// Renders the scene, checks the bounds and enters a row into the table.
Outcome render(const std::string& name, PathScene* scene, const Bounds& bounds,
               GradusSettings settings = small_picture());
// Enters a row that was measured elsewhere.
void enter_row(const std::string& name, const film::Counters& counters, const std::string& note = "");

// Builds a box with a ceiling light, another light, a matte, a metal and a glass ball. Lengths scale with scene->place.
void build_box(PathScene* scene);
// Builds a constant environment of 1, in which white objects are invisible.
void build_furnace(PathScene* scene, const Surface& ball);

}  // namespace gradus::stress
