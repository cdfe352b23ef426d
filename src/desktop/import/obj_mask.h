// MTL's map_d and map_Kd as one image.
#pragma once
#include "desktop/import/image.h"
#include "desktop/import/mtl_file.h"

namespace pocketray {

void make_opaque(Image* image);
// -mm base gain: colours become base + gain × value.
void apply_range(const MtlMap& map, Image* image);

// Puts the mask into the alpha of `image`, which is *map's, or becomes white if there is none. The mask is its own
// alpha if it has one, or the channel named by -imfchan. If the options of the maps differ, the image gets as many
// repetitions as the mask needs, and *map the matching options. Returns true if every alpha is 0 or 255.
bool put_mask(const Image& mask, const MtlMap& mask_map, bool has_color, Image* image, MtlMap* map,
              SceneBuilder* builder);

}  // namespace pocketray
