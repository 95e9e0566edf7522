// What an animation takes of memory and disks, before it begins.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/claims.h"
#include "plan/plan.h"
#include "reconstruct/space_time/sequence_pictures.h"
#include "render/stats.h"

namespace gradus {

// plan: of a frame; count: how many there are; keeps: their files stay, and windows take those beside them that other parts have left;
// with_flow: as of SequenceSettings.
PlannedBytes planned_bytes(const Plan& plan, const SequenceMethod& method, const WindowShape& windows, int count, bool keeps,
                           bool with_flow = false);

// Bytes of files by the folders that they lie in.
using FolderBytes = decltype(Claim::files);

// frames: the folder of the frames; rows of a window lie in that for temporary files.
Claim claim_of(const PlannedBytes& needs, const std::string& frames);

// Of those in folders that are memory themselves (tmpfs).
uint64_t bytes_in_memory(const FolderBytes& files);

// A line for each disk that has not the room for all that lies on it.
std::vector<std::string> lacking_room(const FolderBytes& files);

}  // namespace gradus
