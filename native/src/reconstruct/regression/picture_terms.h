// Reconstruction of the terms that a picture is split into, such as light passes, so that they add up to the picture.
//
// A term has no sampled gradients, so each goes through a regression of its own, with weights by its own noise: a
// linear operator once the weights are known. The difference between the picture and the sum of its terms is then
// distributed over the terms by their estimated errors, and beyond these by their light.
#pragma once

#include <vector>

#include "film/features.h"
#include "reconstruct/regression/feature_regression.h"

namespace gradus::reconstruct {

// One term of a picture: three channels in the picture's units, as the regression estimates it.
struct PictureTerm {
  Field image;
  Field error;  // estimated squared error, mean over the channels; one channel
  // Weight with which the term takes up missing light, for each pixel and channel: the term's possible light, such as
  // an albedo, over its mean in the surrounding pixels, at most 1.
  // Where it is 0, the term is 0. An empty field stands for 1 everywhere.
  Field capacity;
  bool may_be_negative = false;  // whether negative values were sampled
};

// Regresses a sampled term on the features `guides`. A term whose half-buffers agree everywhere is returned as it was
// sampled.
PictureTerm regress_term(const film::Features& guides, HalvedImage sampled, const CancelCheck& cancel);

// Changes the terms so that they add up to `whole`, an image of three channels and the same size. The missing light of
// each pixel and channel goes to the terms whose `capacity` is not 0, in proportion to capacity² · error, as far as
// two standard errors of the terms explain it. What is beyond them is an error of `whole` and goes to the terms in
// proportion to their absolute values; where these are 0, too, to the last such term. Terms that may not be negative
// stay at or above 0 unless the sum cannot be reached otherwise.
void add_up(const Field& whole, std::vector<PictureTerm>* terms);

}  // namespace gradus::reconstruct
