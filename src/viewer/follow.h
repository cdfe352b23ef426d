// Whether the picture under way gives way to one with newer input. It does if the new one would be on the screen sooner
// than the rest of it: while all goes as predicted it never does, since less of it is left than a new one takes, but one
// that has come to a halt does. Of two pictures in a row one is shown, so a held button moves the screen at least every
// two pictures, whatever the estimates are worth.
#pragma once

namespace pocketray {

struct PictureChoice {
  double left_ns = 0;           // estimated until the picture under way is shown
  double anew_ns = 0;           // until a new one would be; 0: unknown, and no reason to drop anything
  bool dropped_before = false;  // the last picture was dropped unshown
};

inline bool gives_way(const PictureChoice& choice) {
  return !choice.dropped_before && choice.anew_ns > 0 && choice.anew_ns < choice.left_ns;
}

}  // namespace pocketray
