// Lets the user choose a scene from thumbnails, with a pad and one button.
#pragma once
#include <string>
#include <vector>

#include "viewer/viewer.h"

namespace pocketray {

// Maximum pixels. Derived: three by two fit on 320×240, with their titles and gaps.
constexpr int kThumbnailWidth = 96, kThumbnailHeight = 72;

struct PickerEntry {
  std::string scene, title;       // the scene as given to `view`, the title below the picture
  std::vector<std::uint8_t> rgb;  // the thumbnail; empty: none
  int width = 0, height = 0;
};

// Lists the .pray files of a folder, sorted by name, each with the thumbnail NAME.ppm beside NAME.pray if it exists;
// then the built-in scenes without a file of their name. Omits thumbnails that are unreadable or too large. Fails if
// the folder cannot be read.
Status list_scenes_to_pick(const std::string& folder, std::vector<PickerEntry>* entries);

// Shows the entries until the user chooses one with A or start: *chosen is its index, or −1 if the user quit. The pad
// moves the selection. Call with the screen open and no scene on it.
void pick_scene(Viewer* viewer, const std::vector<PickerEntry>& entries, int* chosen);

}  // namespace pocketray
