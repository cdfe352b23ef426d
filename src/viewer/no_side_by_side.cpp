// split_screen.h for builds without the reference: there is no option that would ask for it.
#include "viewer/side_by_side.h"

namespace pocketray {

const char* split_screen_key_help() { return ""; }
const char* split_screen_hint() { return "V shows a reference on the desktop: this program was built without it"; }
SplitScreen* open_split_screen(const SplitScreenOptions&, const Renderer&, int, bool) { return nullptr; }
void close_split_screen(SplitScreen*) {}
Status advance_split_screen(SplitScreen*, Renderer*, double, std::uint32_t, std::uint64_t) { return success(); }
void forget_split_screen(SplitScreen*) {}
bool is_split_screen_full(const SplitScreen&) { return true; }
std::uint32_t split_screen_samples(const SplitScreen&) { return 0; }
const Vec3* split_picture(SplitScreen*, const Renderer& renderer) { return renderer.image.data; }
void write_split_lines(const SplitScreen&, HudText*) {}
void print_split_screen(const SplitScreen&) {}

}  // namespace pocketray
