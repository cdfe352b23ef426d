// What the options of `pocketray render` ask for.
#include "app/render_options.h"

#include <doctest/doctest.h>

#include <cstring>

using namespace pocketray;

namespace {

// The request for a picture of `cube` with these options, which must make sense.
RenderRequest request_of(RenderOptions* o) {
  RenderRequest request;
  o->common.scene = "cube";
  const Status status = read_render_options(o, &request);
  CHECK_MESSAGE(status.ok, std::string(status.message));
  return request;
}

}  // namespace

// Goal: a turntable goes around once, at one time; a sequence moves through time and orbits as far as asked. Method:
// frames, angles and times of each.
TEST_CASE("render_turntable_goes_around_once_at_one_time") {
  RenderOptions o;
  o.turntable = 8, o.seconds = 2.5;
  RenderRequest request = request_of(&o);
  CHECK(request.paths.size() == 8);
  CHECK(request.paths.back() == "out-0007.png");
  CHECK(moves_camera(o));
  CHECK(orbit_after(o, 0) == 0);
  CHECK(orbit_after(o, 2) == 90);
  CHECK(orbit_after(o, 7) == 315);
  for (std::uint32_t frame : {0u, 5u}) CHECK(time_of(o, request, frame, SceneInfo()) == 2.5);

  RenderOptions sequence;
  sequence.frames = "15:20", sequence.orbit_degrees = 3;
  request = request_of(&sequence);
  CHECK(request.paths.size() == 6);
  CHECK(request.paths.front() == "out-0015.png");
  CHECK(orbit_after(sequence, 5) == 15);
  CHECK(time_of(sequence, request, 15, SceneInfo()) == 0.5);

  sequence.frames_per_second = 10;
  CHECK(time_of(sequence, request, 15, SceneInfo()) == 1.5);

  RenderOptions still;
  still.seconds = 4;
  request = request_of(&still);
  CHECK(request.paths == std::vector<std::string>{"out.png"});
  CHECK_FALSE(moves_camera(still));
  CHECK(time_of(still, request, 0, SceneInfo()) == 4);
}

// Goal: a crop lies within the picture. Method: the whole picture, its last pixel, and one beyond each side.
TEST_CASE("render_crop_is_within_the_picture") {
  auto crop_of = [](const char* text, Status* status) {
    RenderOptions o;
    RenderRequest request;
    o.common.scene = "cube", o.common.size = "32x24", o.crop = text;
    *status = read_render_options(&o, &request);
    return request.picture.crop;
  };
  Status status;
  PixelBox box = crop_of("0,0,32x24", &status);
  CHECK((status.ok && box.width == 32 && box.height == 24));
  box = crop_of("31,23,1x1", &status);
  CHECK((status.ok && box.left == 31 && box.top == 23 && box.width == 1 && box.height == 1));
  for (const char* text : {"31,23,2x1", "31,23,1x2", "32,0,1x1", "0,24,1x1", "0,0,0x1", "0,0,1x0", "0,0,1x1x"}) {
    CAPTURE(text);
    crop_of(text, &status);
    CHECK_FALSE(status.ok);
    CHECK(std::strstr(status.message, "within the picture's 32x24 pixels") != nullptr);
  }
}
