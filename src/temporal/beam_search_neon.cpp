// The search of beams with NEON of 32-bit ARM.
#include "base/isa.h"

#if defined(POCKETRAY_HAVE_NEON32)
#undef POCKETRAY_ISA
#define POCKETRAY_ISA neon
#define POCKETRAY_NEON32
#include "temporal/beam_search.h"

namespace pocketray {

bool meets_change_neon(const MovingGeometry& moving, const BoundedBeam& beam) {
  return neon::meets_change(moving, beam);
}

}  // namespace pocketray
#endif
