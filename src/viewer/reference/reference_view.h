// The backend of viewer/side_by_side.h: the reference of what the viewer shows.
#pragma once
#include "viewer/side_by_side.h"

namespace pocketray {

extern const SideBySideBackend kReferenceView;

}  // namespace pocketray
