// Checks the numbers of OBJ and MTL texts strictly. The parsing library reads invalid numbers as 0; here such a line is
// refused by name (HARDCASES row 8).
#pragma once
#include <string>

#include "import/files.h"

namespace pocketray {

// Throw ImportError for the first token that should be a number but is not one, is not finite, or exceeds the limit for
// coordinates (normals: for float). The message names the line, counted from 1, and the MTL file.
void check_obj_numbers(const Bytes& bytes);
void check_mtl_numbers(const Bytes& bytes, const std::string& name);

}  // namespace pocketray
