// Messages that are coded as a difference: what a receiver makes of them is what was meant.
#include <doctest/doctest.h>

#include "support/effort.h"
#include "wire/raw_messages.h"
#include "wire/sample_messages.h"

using namespace pocketray;

namespace {

// A part of a request, and whether a frame_change carries it.
struct Part {
  bool is_carried;
  void (*copy)(const FrameRequest& from, FrameRequest* to);
};
constexpr Part kParts[] = {
    {true, [](const FrameRequest& from, FrameRequest* to) { to->frame = from.frame; }},
    {true, [](const FrameRequest& from, FrameRequest* to) { to->seconds = from.seconds; }},
    {true, [](const FrameRequest& from, FrameRequest* to) { to->camera.eye = from.camera.eye; }},
    {true, [](const FrameRequest& from, FrameRequest* to) { to->camera.target = from.camera.target; }},
    {true, [](const FrameRequest& from, FrameRequest* to) { to->coarse_first = from.coarse_first; }},
    {true,
     [](const FrameRequest& from, FrameRequest* to) {
       to->row_begin = from.row_begin, to->row_end = from.row_end, to->run_count = from.run_count;
       std::copy(std::begin(from.runs), std::end(from.runs), to->runs);
     }},
    {true, [](const FrameRequest&, FrameRequest* to) { to->row_end = to->row_begin, to->run_count = 0; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->light_pitch = from.light_pitch; }},
    {false, [](const FrameRequest&, FrameRequest* to) { to->light_pitch = 0; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->scene = from.scene; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->camera_stated = from.camera_stated; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->camera_index = from.camera_index; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->camera.up = from.camera.up; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->camera.vertical_fov = from.camera.vertical_fov; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->camera.projection = from.camera.projection; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->settings = from.settings; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->settings.height = from.settings.height; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->settings.ray_depth = from.settings.ray_depth; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->exposure = from.exposure; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->dither = from.dither; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->format = from.format; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->chunk_rows = from.chunk_rows; }},
    {false, [](const FrameRequest& from, FrameRequest* to) { to->coding = from.coding; }},
};

Message request_message(MessageType type, const FrameRequest& request) {
  Message message;
  message.type = type;
  message.frame_request = request;
  return message;
}

FrameRequest with_rows_alone(FrameRequest request) {
  request.light_pitch = 0, request.row_begin = 0, request.row_end = request.settings.height, request.run_count = 0;
  return request;
}
FrameRequest with_light_alone(FrameRequest request) {
  if (request.light_pitch == 0) request.light_pitch = kLightPitchLow;
  request.row_end = request.row_begin = 0;
  request.run_count = 0;
  return request;
}

// The request of a peer that has `before` and receives the change.
std::vector<std::uint8_t> received(const FrameRequest& request, const FrameRequest& before) {
  Message change;
  REQUIRE(decode(encoded(request_message(MessageType::frame_change, request)), &change).state == DecodeState::message);
  Message whole = request_message(MessageType::frame_request, before);
  take_change(change.frame_request, &whole.frame_request);
  REQUIRE(can_encode(whole));
  return encoded(whole);
}

}  // namespace

// Goal: a frame_change is built only if a peer that decodes it has exactly the wanted request, and always where nothing
// differs but what it carries. Method: random pairs of requests that differ in a random choice of their fields; in half
// of them, light alone follows rows alone or the reverse.
TEST_CASE("change_message_gives_exactly_the_request") {
  Rng rng = make_rng(45);
  int changes = 0, others = 0, light_begins = 0, light_ends = 0;
  for (int round = 0; round < effort(20000); ++round) {
    CAPTURE(round);
    FrameRequest before = sample_message(MessageType::frame_request, &rng, {}).frame_request;
    const FrameRequest other = sample_message(MessageType::frame_request, &rng, {}).frame_request;
    const FrameRequest rows = with_rows_alone(before), light = with_light_alone(before);
    if (round % 4 == 0) before = rows;
    if (round % 4 == 1) before = light;
    FrameRequest request = round % 4 == 0 ? light : round % 4 == 1 ? rows : before;
    bool is_carried = round % 4 > 1;
    for (int count = 1 + static_cast<int>(next_u32(&rng) % 4); count > 0; --count) {
      const Part& part = kParts[next_u32(&rng) % (sizeof kParts / sizeof kParts[0])];
      part.copy(other, &request);
      is_carried = is_carried && part.is_carried;
    }
    if (!can_encode(request_message(MessageType::frame_request, request))) continue;
    const bool starts_light = request.light_pitch > 0 && before.light_pitch == 0,
               has_rows_only = request.light_pitch == 0 && before.row_begin == before.row_end;
    light_begins += starts_light && request.row_begin == request.row_end, light_ends += has_rows_only;
    const bool is_one = is_change(request, before);
    changes += is_one, others += !is_one;
    if (is_carried) CHECK(is_one);
    if (is_one) CHECK(received(request, before) == encoded(request_message(MessageType::frame_request, request)));
  }
  CHECK(changes > effort(20000) / 20);
  CHECK(others > effort(20000) / 20);
  CHECK(light_begins > effort(20000) / 20);
  CHECK(light_ends > effort(20000) / 20);
}

// Goal: a request that no peer takes is no change of any other, though nobody aborts. Method: neither rows nor light;
// rows beyond the picture; an order that is none.
TEST_CASE("change_message_of_an_impossible_request_is_none") {
  Rng rng = make_rng(46);
  FrameRequest before = sample_message(MessageType::frame_request, &rng, {}).frame_request;
  before.settings.height = 40, before.row_begin = 0, before.row_end = 10, before.run_count = 0, before.light_pitch = 0;
  REQUIRE(is_change(before, before));
  FrameRequest request = before;
  request.row_end = 0;
  CHECK(!is_change(request, before));
  request.row_end = 41;
  CHECK(!is_change(request, before));
  request.row_end = 10, request.run_count = 1, request.runs[0] = {9, 0};
  CHECK(!is_change(request, before));
  request.run_count = 255;
  CHECK(!is_change(request, before));
}

// Goal: the low bits of a frame's number give the frame, as long as fewer than 2^16 were requested since.
TEST_CASE("change_message_frame_numbers_come_back") {
  for (std::uint32_t latest : {1u, 65535u, 65536u, 200000u, 0xFFFFFFFFu})
    for (std::uint32_t back : {0u, 1u, 2u, 255u, 65534u, 65535u})
      if (back < latest) CHECK(frame_of((latest - back) & 0xFFFF, latest) == latest - back);
}
