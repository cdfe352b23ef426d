// Reference files: what their samples depend on, reading, comparing, saving.
#pragma once
#include "desktop/reference/accumulation.h"
#include "desktop/sweep/sweep.h"

namespace pocketray {

const char* name_of(Transport transport);

// Prepares the rig's frame for references.
Status prepare_for_reference(double seconds, Rig* rig);
// Returns everything that samples of the prepared frame depend on.
std::string reference_key(const Rig& rig, const AccuracyOptions& options, Transport transport);

// Reads a file; the error names it. *transport receives its kind.
Status load_accumulation(const std::string& path, Accumulation* accumulation, Transport* transport);
// Fails, naming the first difference, unless the file's samples match the key and size.
Status check_same_reference(const std::string& path, const Accumulation& there, const Accumulation& wanted);
// Replaces the file atomically.
Status save_accumulation(const std::string& path, const Accumulation& accumulation);

}  // namespace pocketray
