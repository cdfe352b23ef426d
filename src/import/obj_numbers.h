// The numbers of OBJ and MTL texts, read strictly. The library that parses these files takes what it cannot read for 0;
// here a line with such a number is refused by name (HARDCASES row 8).
#pragma once
#include <string>

#include "import/files.h"

namespace pocketray {

// Throw ImportError for the first token that stands where a number must and is not one, is not finite, or is larger
// than a coordinate may be (normals: than a float holds). They name the line, counted from 1, and the MTL file.
void check_obj_numbers(const Bytes& bytes);
void check_mtl_numbers(const Bytes& bytes, const std::string& name);

}  // namespace pocketray
