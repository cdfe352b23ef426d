#include "accel/bvh.h"

#include "accel/accel_list.h"

namespace pocketray {

const AccelInfo kBvhAccel = {
    "bvh",     bvh_need,    bvh_scratch_need,   bvh_build,    bvh_refit,
    bvh_adopt, bvh_closest, bvh_closest_packet, bvh_occluded, bvh_nearest_distance,
};

}  // namespace pocketray
