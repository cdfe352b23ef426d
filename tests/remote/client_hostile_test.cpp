// A device and a server that wastes its time: whatever it sends, the frame goes on.
#include <doctest/doctest.h>

#include <algorithm>

#include "hostile_rig.h"

using namespace pocketray;

namespace {

Message message_of(MessageType type) {
  Message message;
  message.type = type;
  return message;
}

struct Flood {
  const char* what;
  Message (*make)(HostileRig* rig);
};
constexpr Flood kFloods[] = {
    {"pongs to no ping",
     [](HostileRig* rig) {
       return rig->pong({0, 0});
     }},
    {"pongs to another ping",
     [](HostileRig* rig) {
       return rig->pong({77'777, 16});
     }},
    {"hellos", [](HostileRig*) { return hello_of_server(); }},
    {"scene entries", [](HostileRig* rig) { return rig->entry(); }},
    {"scene pieces", [](HostileRig*) { return message_of(MessageType::scene_piece); }},
    {"view entries",
     [](HostileRig*) {
       Message message = message_of(MessageType::view_entry);
       message.view_entry.camera.vertical_fov = 1;
       return message;
     }},
    {"errors", [](HostileRig*) { return message_of(MessageType::error); }},
    {"rows of a frame before", [](HostileRig* rig) { return rig->rows.chunk(rig->all[0].frame, 0, 8); }},
    {"rows of this frame, again", [](HostileRig* rig) { return rig->rows.chunk(rig->request.frame, 56, 8); }},
    {"rows of a frame to come", [](HostileRig* rig) { return rig->rows.chunk(rig->request.frame + 5, 0, 8); }},
    {"rows of no frame", [](HostileRig* rig) { return rig->rows.chunk(0, 0, 8); }},
};

}  // namespace

// Goal: a server that floods unrequested messages is dropped at almost no cost. Method: every kind of message, as fast
// as the device can read, for longer than a frame may take.
TEST_CASE("client_leaves_a_server_that_floods") {
  for (const Flood& flood : kFloods)
    for (bool before_hello : {false, true}) {
      CAPTURE(flood.what);
      CAPTURE(before_hello);
      HostileRig rig;
      if (before_hello) rig.all.resize(1), rig.act = [](HostileRig*, const Message&) { return std::vector<Message>(); };
      if (!before_hello) rig.frames_until_ready();
      rig.flood_with([&] { return flood.make(&rig); });
      for (int i = 0; i < 3; ++i) CHECK(rig.frame() < 1.05);
      CHECK(rig.flood_count < kFloodMessages);
      CHECK(rig.client.servers[0].overture.phase == ServerPhase::waiting);
      CHECK(rig.log.size() == 1);
    }
}

// Goal: rows that come in another order than asked for end the connection, as do rows of two runs in one chunk. Method:
// a server sends the last run first, the upper row of the first run before its lowest, or that run with a row too many.
TEST_CASE("client_leaves_a_server_that_sends_in_another_order") {
  enum Deviation { last_run, upper_row, row_too_many };
  for (Deviation deviation : {last_run, upper_row, row_too_many}) {
    CAPTURE(deviation);
    HostileRig rig;
    bool ordered = false;
    rig.frames_until_ready();
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      if (!r->note_request(message)) return r->answer(message);
      const FrameRequest& q = r->request;
      if (q.run_count < 2) return r->rows.rows(q);
      ordered = true;
      const RowRange first = run_at(q, 0), last = run_at(q, q.run_count - 1u);
      REQUIRE(first.end - first.begin > 1);
      if (deviation == last_run) return {r->rows.chunk(q.frame, last.begin, last.end - last.begin)};
      if (deviation == upper_row) return {r->rows.chunk(q.frame, first.begin, 1)};
      return {r->rows.chunk(q.frame, first.begin - 1, first.end - first.begin + 1)};
    };
    for (int i = 0; i < 3 && rig.log.empty(); ++i) CHECK(rig.frame() < 1.05);
    CHECK(ordered);
    REQUIRE(rig.log.size() == 1);
    CHECK(rig.log[0].find("unrequested rows") != std::string::npos);
  }
}

// Goal: late rows of earlier requests do not end the connection; one row too many does. Method: a server holds back the
// rows of some frames and sends them in order with the next request, as a slow line would; then it repeats a few.
TEST_CASE("client_takes_late_rows_no_more_than_it_asked_for") {
  for (bool sends_more : {false, true}) {
    CAPTURE(sends_more);
    HostileRig rig;
    rig.frames_until_ready();
    rig.client.options.device_share = 0.5;  // whatever the client learns about the server
    std::vector<FrameRequest> kept;
    std::size_t asked_before = rig.all.size();
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      if (!r->note_request(message))
        return message.type == MessageType::ping ? r->answer(message) : std::vector<Message>();
      kept.push_back(r->request);
      if (kept.size() < 4) return {};
      std::vector<Message> chunks;
      for (const FrameRequest& request : kept) {
        if (sends_more && &request == &kept.back()) chunks.push_back(r->rows.chunk(kept[0].frame, 0, 4));
        for (const Message& chunk : r->rows.rows(request)) chunks.push_back(chunk);
      }
      kept.clear();
      return chunks;
    };
    for (int i = 0; i < 12; ++i) {
      CHECK(rig.frame() < 1.05);
      if (!rig.log.empty()) break;
    }
    CHECK(rig.all.size() >= asked_before + 4);
    CHECK(rig.log.empty() == !sends_more);
    for (const std::string& line : rig.log) CHECK(line.find("unrequested rows") != std::string::npos);
  }
}

// Goal: one poll handles at most a frame's worth of input, even if rows of many frames arrive at once. Method: a server
// answers only pings for some frames and then sends all rows it owes, one at a time.
TEST_CASE("client_look_is_bounded") {
  HostileRig rig;
  rig.frames_until_ready();
  rig.client.options.device_share = 0;
  std::vector<FrameRequest> kept;
  bool gives = false;
  rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
    if (message.type == MessageType::ping && !gives) return {};  // it would cancel the owed rows
    if (!r->note_request(message)) return {};
    kept.push_back(r->request);
    if (!gives) return {};
    std::vector<Message> chunks;
    for (const FrameRequest& request : kept)
      for (RowSequence at = first_rows(request); has_rows(at); pass_rows(request, 1, &at))
        chunks.push_back(r->rows.chunk(request.frame, at.row_end - 1, 1));
    kept.clear();
    return chunks;
  };
  for (int i = 0; i < 20; ++i) rig.frame();
  gives = true;
  RemoteServer* s = &rig.client.servers[0];
  std::uint64_t owed = s->rows.late_rows;
  REQUIRE(owed > 4 * kHeight);
  REQUIRE(begin_frame(&rig.device->renderer, &rig.client, 0).ok);
  std::uint32_t before = s->rows.chunk_count, most = 0, looks = 0;
  std::uint64_t begin = rig.fake.now();
  for (; s->rows.late_rows > 0 && looks < 1000 && s->overture.phase == ServerPhase::ready; ++looks) {
    advance_client(&rig.client, kMs);
    most = std::max(most, s->rows.chunk_count - before);
    before = s->rows.chunk_count;
  }
  CHECK(rig.log.empty());
  CHECK(s->rows.late_rows == 0);
  CHECK(most <= kHeight);
  CHECK(looks >= owed / kHeight);
  CHECK(rig.fake.now() - begin < looks * kMs / 5);  // input already received is not waited for
}

// Goal: a message that never ends is not an answer. Method: the first bytes of a pong or of rows, one every 0.1 s; the
// connection ends when the answer is overdue, in each phase.
TEST_CASE("client_leaves_a_server_that_dribbles") {
  for (MessageType until :
       {MessageType::hello, MessageType::scene_query, MessageType::ping, MessageType::frame_request}) {
    CAPTURE(static_cast<int>(until));
    HostileRig rig;
    bool dribbles = false;
    std::uint64_t next_ns = 0;
    rig.client.options.prepare_timeout_ns = rig.client.options.silence_timeout_ns;
    Message endless = rig.pong({1, 16'384});
    std::vector<std::uint8_t> bytes = bytes_of(endless);
    std::size_t at = 0;
    rig.fake.flood = [&]() -> std::vector<std::uint8_t> {
      if (!dribbles || rig.fake.now() < next_ns || at == bytes.size()) return {};
      next_ns = rig.fake.now() + 100 * kMs;
      return {bytes[at++]};
    };
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      dribbles = dribbles || message.type == until;
      return dribbles ? std::vector<Message>() : r->answer(message);
    };
    std::uint64_t begin = rig.fake.now();
    while (rig.log.empty() && rig.fake.now() < begin + 20'000 * kMs) CHECK(rig.frame() < 1.1);
    CHECK(rig.log.size() == 1);
    CHECK(at > 1);
    CHECK(rig.fake.now() - begin < 5'000 * kMs);
  }
}

// Goal: the line about a lost server names it as the user did, and in no other way. Method: a name that is no number,
// with a server that hangs up, and with none.
TEST_CASE("client_logs_a_lost_server_by_one_name") {
  HostileRig rig;
  platform::LinkAddress* address = &rig.client.servers[0].address;
  const std::string number = address->text;
  std::snprintf(address->text, sizeof address->text, "attic.example:7474");
  rig.frames_until_ready();
  rig.fake.hang_up();
  rig.frame(), rig.frame();
  REQUIRE(rig.log.size() == 1);
  CHECK_MESSAGE(rig.log[0].compare(0, 27, "server attic.example:7474: ") == 0, rig.log[0]);
  CHECK_MESSAGE(rig.log[0].find("127.0.0.1") == std::string::npos, rig.log[0]);

  HostileRig alone;
  platform::kNullLink.close(alone.fake.link, alone.fake.listener);
  for (int i = 0; i < 3; ++i) alone.frame();
  REQUIRE(alone.log.size() == 1);
  CHECK_MESSAGE(alone.log[0].find("server " + number + ": nothing is listening there") == 0, alone.log[0]);
}
