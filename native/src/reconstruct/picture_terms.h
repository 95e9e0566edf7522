// What a picture is split into, and what its parts become: light passes, and whatever else adds up to it.
//
// No differences are sampled of a part, so that each goes through a regression of its own, with weights by its own
// noise: a linear operator once these are known. What all of them then lack of the picture is spread over them by their
// estimated errors (contract 3.4).
#pragma once

#include <vector>

#include "film/features.h"
#include "reconstruct/feature_regression.h"

namespace gradus::reconstruct {

// A part in three channels, as it is and as sampled: in the picture's units.
struct PictureTerm {
  Field image;
  Field error;  // estimated squared error, mean over the channels; one channel
  // Of each channel: how much light there can be of the part, over that in the pixels around. 0: none, whatever is
  // lacking. None: as much.
  Field room;
  bool may_be_negative = false;  // light below 0 was sampled of it
};

// A part without noise stays what it is.
PictureTerm regress_term(const film::Features& guides, HalvedImage sampled, const CancelCheck& cancel);

// The parts, of one size, become such that they add up to `whole`, three channels. What lacks of the sum goes to all
// that have room, by their errors; where these tell nothing, by their light; where there is none, to the last of them.
// What was not negative stays so unless the sum cannot be had otherwise.
void add_up(const Field& whole, std::vector<PictureTerm>* terms);

}  // namespace gradus::reconstruct
