// The backend of viewer/side_by_side.h: traces the reference of the viewer's picture.
#pragma once
#include "viewer/side_by_side.h"

namespace pocketray {

extern const SideBySideBackend kReferenceView;

}  // namespace pocketray
