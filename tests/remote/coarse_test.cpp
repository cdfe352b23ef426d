// Coarse pictures: a server sends one of the whole frame before its rows, and the device shows it where rows are
// missing.
#include <doctest/doctest.h>

#include <algorithm>

#include "hostile_rig.h"
#include "remote/client/outlook.h"
#include "split_rig.h"
#include "support/effort.h"
#include "support/scripted_client.h"

using namespace pocketray;

namespace {

Message coarse_message(std::uint32_t frame, const std::vector<std::uint8_t>& pixels) {
  Message message;
  message.type = MessageType::coarse_picture;
  message.coarse_picture.frame = frame;
  message.coarse_picture.pixels = {pixels.data(), static_cast<std::uint32_t>(pixels.size())};
  return message;
}

}  // namespace

// Goal: the coarse picture has the frame's own pixels, of the whole frame whatever rows are asked for, once and only if
// it is asked for; the rows are as without. Method: scenes at rest and in motion, with and without coherence, formats,
// dither, threads, sizes that no square divides, settings that trace few pixels or many.
TEST_CASE("coarse_picture_has_the_pixels_of_the_frame") {
  for (std::uint32_t threads : {1u, 3u})
    for (CoherenceMode mode : {CoherenceMode::off, CoherenceMode::on}) {
      if (kEffortDivisor > 1 && (threads == 1) != (mode == CoherenceMode::off)) continue;
      ServerOptions options;
      options.thread_count = threads, options.coherence = mode;
      ServerRig rig(options);
      ScriptedClient client(&rig);
      std::uint32_t frame = 0;
      auto check = [&](FrameRequest q) {
        q.frame = ++frame;
        CAPTURE(frame);
        client.request(q);
        client.wait_for_rows(static_cast<std::uint32_t>(q.row_end - q.row_begin));
        const std::vector<std::uint8_t> right = rendered_here(q);
        if (q.row_begin == 0) CHECK(client.picture() == right);
        CHECK(client.has(MessageType::coarse_picture) == q.coarse_first);
        if (!q.coarse_first) return;
        const auto come = client.wait_for(MessageType::coarse_picture);
        const CoarsePicture& coarse = come->message.coarse_picture;
        CHECK(!client.has(MessageType::coarse_picture));
        CHECK(coarse.frame == frame);
        CHECK(std::vector<std::uint8_t>(coarse.pixels.begin(), coarse.pixels.end()) == squares_of(right, q));
      };
      FrameRequest q = frame_request("cube", 0, 131, 45);
      q.coarse_first = true;  // also while the cost of pixels is unknown
      check(q);
      q.coarse_first = false;
      check(q);
      q.coarse_first = true;
      for (WireFormat format : {WireFormat::rgb565, WireFormat::rgb888}) {
        q.format = format, q.dither = format == WireFormat::rgb565;
        check(q);
      }
      q.row_begin = 30, q.row_end = 41;
      check(q);
      q = frame_request("seesaw", 0, 64, 48);
      for (int i = 0; i < effort(6); ++i) q.seconds = 0.2 * (i / 2), q.coarse_first = i % 3 > 0, check(q);
      q.settings.samples_per_pixel = 4, check(q);
      q.settings.samples_per_pixel = 1, q.settings.resolution = Resolution::half, check(q);
      q.settings.resolution = Resolution::full, q.settings.selective_contrast = 0.1f, check(q);
    }
}

// Goal: a coarse picture that exceeds what the device takes is left out, and the rows come. Method: a tall picture and
// a device with room for single rows.
TEST_CASE("coarse_picture_that_fits_no_message_is_left_out") {
  for (std::uint32_t message_bytes : {150u, 400u}) {
    ServerRig rig;
    ScriptedClient client(&rig, false);
    Message hello = hello_message();
    hello.hello.message_bytes_max = message_bytes;
    client.send(hello);
    FrameRequest q = frame_request("cube", 1, 8, 800);
    q.coarse_first = true;
    client.request(q);
    client.wait_for_rows(800);
    CHECK(client.has(MessageType::coarse_picture) == (message_bytes == 400));
    CHECK(client.picture() == rendered_here(q));
  }
}

// Goal: of a frame that takes longer than the client's limit, a coarse picture is on the device early, in every row
// that is missing; finished rows keep their pixels, and the complete frame is exact. Method: two servers, a scene in
// motion, with and without the scene on the device; a limit that frames exceed, one that they do not, and none.
TEST_CASE("coarse_picture_is_shown_where_rows_are_missing") {
  for (bool has_scene : {true, false})
    for (double after_ns : {0.0, 1.0, 1e12}) {
      CAPTURE(has_scene);
      CAPTURE(after_ns);
      SplitRigOptions o;
      o.scene = "seesaw", o.server_count = 2, o.server_ns = {30'000, 40'000}, o.device_ns = 60'000;
      o.coherence = CoherenceMode::off;
      o.client.has_scene = has_scene, o.client.coarse_after_ns = after_ns;
      SplitRig rig(o);
      for (int i = 0; i < 4; ++i) rig.frame(0.1 * i);
      REQUIRE(rig.client.plan.model.servers[0].connected);
      int shown = 0;
      for (int i = 4; i < 7; ++i) {
        const double seconds = 0.1 * i;
        const std::vector<std::uint8_t> right = rig.local_pixels(seconds);
        FrameRequest q;
        q.settings = rig.client.settings, q.format = o.client.format;
        REQUIRE(begin_frame(&rig.device->renderer, &rig.client, seconds).ok);
        CHECK(!rig.client.coarse.shown);
        bool complete = false, was_shown = false;
        while (!complete) {
          complete = advance_frame(&rig.device->renderer, &rig.client, rig.now() + 2'000'000);
          if (!rig.client.coarse.shown || was_shown || complete) continue;
          was_shown = true;
          CHECK(rig.client.picture.merge.row_count_done < 30);
          CHECK(rig.client.coarse.ns < 0.3 * rig.client.share.measured_ns);
          const std::vector<std::uint8_t> squares = squares_of(right, q);
          const std::uint32_t columns = coarse_count(q.settings.width);
          int wrong = 0;
          for (std::uint32_t row = 0; row < q.settings.height; ++row)
            for (std::uint32_t x = 0; x < q.settings.width; ++x) {
              const std::uint8_t* pixel = merged_row(rig.client, row) + 3 * x;
              const std::uint8_t* wanted = is_done(rig.client.picture.merge.rows[row])
                                               ? &right[3 * (row * q.settings.width + x)]
                                               : &squares[3 * (row / kCoarseSide * columns + x / kCoarseSide)];
              wrong += !std::equal(pixel, pixel + 3, wanted);
            }
          CHECK(wrong == 0);
          const FrameOutlook outlook = outlook_of(rig.client);
          CHECK(outlook.anew_ns < outlook.left_ns);
        }
        CHECK(std::vector<std::uint8_t>(rig.client.picture.pixels.begin(), rig.client.picture.pixels.end()) == right);
        shown += was_shown;
      }
      CHECK(shown == (after_ns == 1.0 ? 3 : 0));
      CHECK(rig.log.empty());
    }
}

// Goal: a coarse picture that is not due, or of another size, ends the connection; one that a late line brings with the
// next frame does not, and is not shown. Method: a server that deviates in one way.
TEST_CASE("coarse_picture_that_is_not_due_ends_the_connection") {
  enum Deviation { none, unasked, twice, after_rows, another_size, late };
  const std::vector<std::uint8_t> pixels(coarse_bytes(kWidth, kHeight, WireFormat::rgb565), 0x77);
  const std::vector<std::uint8_t> more(pixels.size() + 2, 0x77);
  for (Deviation deviation : {none, unasked, twice, after_rows, another_size, late}) {
    CAPTURE(static_cast<int>(deviation));
    HostileRig rig;
    rig.client.options.coarse_after_ns = deviation == unasked ? 0 : 1;
    rig.frames_until_ready();
    rig.client.options.device_share = 0.5;  // whatever the client learns about the server
    std::uint32_t asked = 0, before = 0;
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      if (!r->note_request(message)) return r->answer(message);
      const FrameRequest& q = r->request;
      if (!q.coarse_first && deviation != unasked) return r->rows.rows(q);
      ++asked;
      const Message coarse = coarse_message(q.frame, deviation == another_size ? more : pixels);
      // Nothing of every other frame comes before the next one is asked for, and then its coarse picture alone.
      if (deviation == late && before == 0) return before = q.frame, std::vector<Message>();
      std::vector<Message> answers = r->rows.rows(q);
      if (deviation == late) {
        answers.insert(answers.begin(), coarse_message(before, pixels));
        return before = 0, answers;
      }
      answers.insert(deviation == after_rows ? answers.end() : answers.begin(), coarse);
      if (deviation == twice) answers.insert(answers.begin(), coarse);
      return answers;
    };
    for (int i = 0; i < 6 && rig.log.empty(); ++i) {
      rig.frame();
      if (deviation == late) CHECK(!rig.client.coarse.shown);
      CHECK(std::count(rig.client.picture.pixels.begin(), rig.client.picture.pixels.end(), 0x77) <
            int(rig.client.picture.pixels.count) / 4);
    }
    CHECK(asked > 0);
    CHECK(rig.log.empty() == (deviation == none || deviation == late));
    for (const std::string& line : rig.log)
      CHECK(line.find(deviation == another_size ? "wrong size" : "unrequested") != std::string::npos);
  }
}
