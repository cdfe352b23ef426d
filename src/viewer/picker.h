// Lets the user choose a scene from thumbnails, with a pad and one button.
#pragma once
#include <string>
#include <vector>

#include "viewer/viewer.h"

namespace pocketray {

// Pixels, at most. Derived: three by two fit on 320×240, with their titles and gaps.
constexpr int kThumbnailWidth = 96, kThumbnailHeight = 72;

struct PickerEntry {
  std::string scene, title;       // the scene as for `view`, and what to write below the picture
  std::vector<std::uint8_t> rgb;  // the thumbnail; empty: none
  int width = 0, height = 0;
};

// The .pray files of a folder, sorted by name, with the thumbnail NAME.ppm beside NAME.pray where there is one; then
// the built-in scenes that have no file of their name. A thumbnail that cannot be read or is too large is left out.
// Fails if the folder cannot be read.
Status list_scenes_to_pick(const std::string& folder, std::vector<PickerEntry>* entries);

// Shows the entries until the user chooses one with A or start: *chosen is its index, or −1 if the user quit. The pad
// moves. Call with the screen open and no scene on it.
void pick_scene(Viewer* viewer, const std::vector<PickerEntry>& entries, int* chosen);

}  // namespace pocketray
