// The stress suite: renders of scenes that are hard on floats, each with bounds on what is dropped and which shifts
// fail.
//
// Every case renders with gradients and all passes, is reconstructed by L2 and L1, and is followed in double. What
// comes out must be finite; a table of the counts of all cases is printed in the end. A tenth of the cases and samples
// runs with every change, the whole with GRADUS_TEST_FULL=1 (make stress).
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

// Causes of failed shifts, in order of Bounds::failed.
enum Cause { kMissed, kOccluded, kClass, kTotalReflection, kSide, kDensity, kJacobian, kCauses };

// Most that a case may have. Failures are counted per base path and offset; one offset may fail at several light
// samples.
//
// How often shifts fail is a matter of geometry, not of scale or place: they miss at silhouettes, are occluded at the
// edges of shadows, and lack a class where materials meet. In the corners of rooms an offset often lies in the plane of
// the shared vertex: the Jacobian is then 0, or, by rounding, the density, or the connection is occluded. Total
// reflection and the wrong side happen at glass. The bounds are about twice what the cases have; numbers that go wrong
// exceed them by far.
struct Bounds {
  std::array<double, kCauses> failed = {0.06, 0.15, 0.45, 0.05, 0.03, 0.1, 0.1};
  // Radiance, gradients and features that were not finite.
  uint64_t dropped = 0;
  // Difference to the image in double, in units of B8's bound (support/double_image.h). Negative: not compared.
  double from_double = 1.0;

  // One object without corners, alone.
  static Bounds alone();
  Bounds dropping(uint64_t samples) const;
  Bounds without_double() const;
};

struct Outcome {
  std::vector<float> noisy, l2;  // RGBA
  film::Counters counters;
};

// Mean of the colours of an RGBA image.
double mean(const std::vector<float>& rgba);
// Root of the mean squared difference of two RGBA images over the mean of the second.
double difference(const std::vector<float>& a, const std::vector<float>& b);
void expect_finite(const std::vector<float>& values, const std::string& what);

// Few digits, for names of cases.
std::string text_of(double value);

// Defaults of all settings, of a small picture with limits on bounces that leave chains of glass whole.
GradusSettings small_picture();
// Renders the scene, checks the bounds, enters a row into the table.
Outcome render(const std::string& name, PathScene* scene, const Bounds& bounds,
               GradusSettings settings = small_picture());
// A row that was measured elsewhere.
void enter_row(const std::string& name, const film::Counters& counters, const std::string& note = "");

// A box with a ceiling light, a light, a matte, a metal and a glass ball. Lengths scale with scene->place.
void build_box(PathScene* scene);
// Constant light of 1 from everywhere: what is white looks like it.
void build_furnace(PathScene* scene, const Surface& ball);

}  // namespace gradus::stress
