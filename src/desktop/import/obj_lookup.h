// Finds the files that OBJ and MTL texts name.
#pragma once
#include <string>
#include <vector>

#include "desktop/import/scene_builder.h"

namespace pocketray {

// Reads the file `name`, searched for beside each of `bases` in turn, then by the last part of its name, with a remark.
// Throws the first attempt's ImportError if there is none. Stores its path.
Bytes read_named(const std::vector<std::string>& bases, const std::string& name, std::uint64_t byte_count_max,
                 SceneBuilder* builder, std::string* path);

}  // namespace pocketray
