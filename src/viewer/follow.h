// Decides whether the current picture is dropped for one with newer input: if the new one would be on screen before the
// rest of the current one. As long as everything goes as predicted it never is, since less is left of it than a new one
// takes, but a stalled picture is. At least every second picture is shown, so a held button keeps moving the screen,
// however wrong the estimates are.
#pragma once

namespace pocketray {

struct PictureChoice {
  double left_ns = 0;           // estimated time until the current picture is shown
  double anew_ns = 0;           // time until a new one would be; 0: unknown, which drops nothing
  bool dropped_before = false;  // the last picture was dropped unshown
};

inline bool gives_way(const PictureChoice& choice) {
  return !choice.dropped_before && choice.anew_ns > 0 && choice.anew_ns < choice.left_ns;
}

}  // namespace pocketray
