// Sequences by a team: each frame is rendered once, and the leader hears of all.
#include <doctest/doctest.h>

#include <atomic>
#include <mutex>
#include <set>

#include "app/render_team.h"
#include "session/interrupt.h"
#include "support/fake_team.h"

using namespace pocketray;

namespace {

struct Heard {
  Status status;
  std::set<std::uint32_t> own, of_helpers;
  double trace_ms = 0;
  std::uint64_t pixels = 0;
};

// Renders frames 0 … count − 1 with so many ranks. `render` is what each of them does for a frame.
Heard render_all(std::uint32_t size, std::uint32_t count,
                 const std::function<Status(const Team&, std::uint32_t)>& render, bool last_differs = false) {
  Heard heard;
  FakeTeam fake(size);
  fake.run([&](const Team& team) {
    auto lead = [&] {
      std::vector<std::uint32_t> frames;
      for (std::uint32_t i = 0; i < count; ++i) frames.push_back(i);
      FrameLead lead_frames(team, "scene", frames, [&](const SharedFrame& frame) {
        CHECK(heard.of_helpers.insert(frame.frame).second);
        heard.trace_ms += frame.trace_ms, heard.pixels += frame.coherent.pixels;
      });
      for (;;) {
        std::uint32_t frame;
        bool there;
        heard.status = lead_frames.next(&frame, &there);
        if (!heard.status.ok || !there) return 0;
        if (interrupted) continue;
        CHECK(render(team, frame).ok);
        CHECK(heard.own.insert(frame).second);
      }
    };
    auto open = [&] {
      tell_ready_for_frames(team, last_differs && team.rank + 1 == size ? "another scene" : "scene");
      return success();
    };
    return run_in_team(team, lead, open, [&](const TeamMessage& message) {
      return render_given_frames(team, message, [&](SharedFrame* shared, bool* complete) {
        Status status = render(team, shared->frame);
        *complete = status.ok && !interrupted;
        shared->trace_ms = 0.5, shared->coherent.pixels = shared->frame;
        return status;
      });
    });
  });
  return heard;
}

}  // namespace

// Goal: all frames are rendered once, by any number of ranks; times and counts of helpers' frames reach the leader.
TEST_CASE("render_team_renders_each_frame_once") {
  for (std::uint32_t size : {1u, 2u, 5u})
    for (std::uint32_t count : {0u, 1u, 3u, 200u}) {
      CAPTURE(size);
      CAPTURE(count);
      std::mutex mutex;
      std::multiset<std::uint32_t> rendered;
      Heard heard = render_all(size, count, [&](const Team&, std::uint32_t frame) {
        std::lock_guard<std::mutex> lock(mutex);
        rendered.insert(frame);
        return success();
      });
      CHECK_MESSAGE(heard.status.ok, heard.status.message);
      CHECK(rendered.size() == count);
      CHECK(std::set<std::uint32_t>(rendered.begin(), rendered.end()).size() == count);
      CHECK(heard.own.size() + heard.of_helpers.size() == count);
      std::uint64_t pixels = 0;
      for (std::uint32_t frame : heard.of_helpers) pixels += frame;
      CHECK(heard.pixels == pixels);
      CHECK(heard.trace_ms == doctest::Approx(0.5 * static_cast<double>(heard.of_helpers.size())));
    }
}

// Goal: frames of a slow rank go to the others. Method: the leader takes 100 times as long as each of two helpers.
TEST_CASE("render_team_gives_frames_of_a_slow_rank_to_others") {
  Heard heard = render_all(3, 300, [&](const Team& team, std::uint32_t) {
    std::this_thread::sleep_for(std::chrono::microseconds(leads(team) ? 20000 : 200));
    return success();
  });
  CHECK(heard.own.size() < 100);  // an equal share
  CHECK(heard.of_helpers.size() + heard.own.size() == 300);
}

// Goal: a helper that fails, or has another scene, ends the sequence with its rank; so does an interrupt, without an
// error, and the leader knows what is finished. Nobody hangs.
TEST_CASE("render_team_ends_early") {
  auto pause = [] { std::this_thread::sleep_for(std::chrono::milliseconds(1)); };
  Heard failed = render_all(3, 100000, [&](const Team& team, std::uint32_t) {
    pause();
    return team.rank == 2 ? failure("disk full") : success();
  });
  CHECK(std::string(failed.status.message) == "rank 2: disk full");
  Heard differs = render_all(
      2, 100000, [&](const Team&, std::uint32_t) { return pause(), success(); }, true);
  CHECK(std::string(differs.status.message).find("rank 1: its scene or program differs from rank 0's") == 0);
  std::atomic<int> count{0};
  Heard stopped = render_all(3, 100000, [&](const Team&, std::uint32_t) {
    pause();
    if (++count == 100) interrupted = true;
    return success();
  });
  interrupted = false;
  CHECK(stopped.status.ok);
  CHECK(stopped.own.size() + stopped.of_helpers.size() >= 50);
  CHECK(stopped.own.size() + stopped.of_helpers.size() < 200);
}
