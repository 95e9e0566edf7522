// What an animation takes of memory and disks, before it begins.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plan/plan.h"
#include "reconstruct/space_time/sequence_pictures.h"
#include "render/stats.h"

namespace gradus {

// plan: of a frame; count: how many there are; keeps: their files stay.
PlannedBytes planned_bytes(const Plan& plan, const SequenceMethod& method, const WindowShape& windows, int count, bool keeps);

// What the job lacks, a line each: room for the frames in their folder, for rows in that for temporary files. Both may be on one disk.
std::vector<std::string> lacking_room(const PlannedBytes& needs, const std::string& folder);

}  // namespace gradus
