// Rewrites variants of OBJ and MTL text before parsing.
#pragma once
#include "desktop/import/files.h"

namespace pocketray {

// Rewrites the text in place, keeping its size and line numbers: lines continued by '\' become one, followed by as many
// empty lines; "1//" and "2/2/" of faces lose the slashes at their end; a UTF-8 byte order mark becomes blank. Throws
// ImportError for UTF-16 text.
void tidy_obj_text(Bytes* text);

}  // namespace pocketray
