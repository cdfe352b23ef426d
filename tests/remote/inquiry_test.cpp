// A device's inquiries before its first frame, with honest and lying servers.
#include "remote/client/inquiry.h"

#include <doctest/doctest.h>

#include <cstring>
#include <functional>

#include "desktop/split_report/virtual_world.h"
#include "engine/frame.h"
#include "fake_server.h"
#include "remote/server/scene_store.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"
#include "support/scripted_client.h"

using namespace pocketray;

namespace {

struct InquiryRig {
  VirtualWorld world;
  Inquiry inquiry;
  InquiryRig() {
    REQUIRE(open_world(platform::NullLinkSettings(), builtin_store(), 1, &world).ok);
    ServerOptions options;
    options.client_memory_bytes = 16u << 20;
    Status status = start_server(&world, 0, options);
    REQUIRE_MESSAGE(status.ok, status.message);
    status = open_inquiry(InquiryOptions(), world.link, world.addresses[0], &inquiry);
    REQUIRE_MESSAGE(status.ok, status.message);
  }
};

const std::vector<std::uint8_t> kFile(100'000, 7);  // fetched in several pieces

Message entry_of(std::uint16_t index, std::uint16_t count, const char* name) {
  Message message;
  message.type = MessageType::scene_entry;
  SceneEntry* entry = &message.scene_entry;
  entry->hash = content_hash(kFile.data(), kFile.size());
  entry->byte_count = kFile.size();
  entry->index = index, entry->count = count;
  std::snprintf(entry->name, kNameBytes, "%s", name);
  return message;
}

Message piece_of(const SceneFetch& fetch) {
  Message message;
  message.type = MessageType::scene_piece;
  message.scene_piece = {fetch.hash, fetch.offset, {kFile.data() + fetch.offset, fetch.byte_count}};
  return message;
}

// Error of fetching from it; `change` modifies each piece before it is sent.
std::string fetch_error(const std::function<void(Message*)>& change) {
  FakeServer fake([&](const Message& message) -> std::vector<Message> {
    if (message.type == MessageType::hello) return {hello_of_server()};
    Message piece = piece_of(message.scene_fetch);
    change(&piece);
    return {piece};
  });
  Inquiry inquiry;
  Status status = open_inquiry(InquiryOptions(), fake.link, fake.address, &inquiry);
  std::vector<std::uint8_t> bytes(kFile.size());
  if (status.ok) status = fetch_scene(&inquiry, entry_of(0, 1, "a").scene_entry, bytes.data(), bytes.size(), {});
  if (status.ok) CHECK(bytes == kFile);
  return status.message;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

// Goal: a device gets a server's list and any of its scenes unchanged. Method: all built-in ones.
TEST_CASE("inquiry_lists_and_fetches_scenes") {
  InquiryRig rig;
  std::vector<SceneEntry> entries;
  REQUIRE(list_scenes(&rig.inquiry, &entries).ok);
  REQUIRE(entries.size() == builtin_store().scenes.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const StoredScene& stored = builtin_store().scenes[i];
    CHECK(std::strcmp(entries[i].name, stored.name) == 0);
    CHECK(entries[i].triangle_count == stored.scene.triangles.count);
    REQUIRE(entries[i].byte_count == stored.byte_count);
    std::vector<std::uint8_t> bytes(stored.byte_count);
    std::uint64_t seen = 0;
    Status status = fetch_scene(&rig.inquiry, entries[i], bytes.data(), bytes.size(), [&](std::uint64_t done) {
      CHECK(done > seen);
      seen = done;
    });
    REQUIRE_MESSAGE(status.ok, status.message);
    CHECK(seen == stored.byte_count);
    CHECK(std::memcmp(bytes.data(), stored.bytes, bytes.size()) == 0);
  }
}

// Goal: a scene is found with and without its ending, and the exact name comes first.
TEST_CASE("inquiry_finds_names_but_for_the_ending") {
  std::vector<SceneEntry> entries(3);
  std::strcpy(entries[0].name, "room.pray");
  std::strcpy(entries[1].name, "room");
  std::strcpy(entries[2].name, "bunny.ply");
  CHECK(find_entry(entries, "room") == &entries[1]);
  CHECK(find_entry(entries, "room.pray") == &entries[0]);
  CHECK(find_entry(entries, "room.obj") == &entries[1]);
  CHECK(find_entry(entries, "bunny") == &entries[2]);
  CHECK(find_entry(entries, "bunny.obj") == nullptr);
  CHECK(find_entry(entries, "") == nullptr);
}

// Goal: a server describes the view that a device with the scene would begin with. Method: camera, bounds and exposure
// from make_renderer(): the scene's own, measured, and measured from a stated camera; a missing camera.
TEST_CASE("inquiry_view_is_what_a_device_would_see") {
  for (const char* name : {"cornell", "seesaw"})
    for (int round = 0; round < 3; ++round) {
      InquiryRig rig;
      std::unique_ptr<BuiltScene> built = build_builtin(name);
      ViewQuery query;
      query.scene = builtin_hash(name);
      query.settings.width = 64, query.settings.height = 48;
      query.measure_exposure = round > 0;
      std::unique_ptr<TestRenderer> device = make_renderer(built->scene, query.settings);
      Renderer* renderer = &device->renderer;
      if (round == 2) {
        query.camera_stated = true;
        query.camera = renderer->view.camera;
        query.camera.eye = renderer->view.camera.eye * 0.5f + renderer->view.camera.target * 0.5f;
        query.camera.node = kNone;
        REQUIRE(set_camera(renderer, query.camera).ok);
      }
      renderer->view.exposure = renderer->scene.info.exposure;
      REQUIRE(begin_frame(renderer, {0}).ok);
      if (round > 0) renderer->view.exposure = measure_exposure(renderer);
      ViewEntry entry;
      Status status = ask_view(&rig.inquiry, query, &entry);
      REQUIRE_MESSAGE(status.ok, status.message);
      CHECK(entry.exposure == renderer->view.exposure);
      CHECK(std::memcmp(&entry.camera.eye, &renderer->view.camera.eye, sizeof(Vec3)) == 0);
      CHECK(std::memcmp(&entry.camera.target, &renderer->view.camera.target, sizeof(Vec3)) == 0);
      CHECK(entry.camera.vertical_fov == renderer->view.camera.vertical_fov);
      CHECK(std::memcmp(&entry.bounds, &renderer->accel.built.bounds, sizeof(Box)) == 0);
      CHECK(entry.effects == renderer->effects.mask);
      CHECK(entry.triangle_count == renderer->scene.triangles.count);
      CHECK(entry.frames_per_second == renderer->scene.info.frames_per_second);
      CHECK(entry.animation == 0);
      const std::string numbered = built->scene.animations.count ? "0" : "";
      for (const std::string& wanted : {std::string("none"), std::string("all"), numbered, std::string("Walk")}) {
        CAPTURE(wanted);
        ViewQuery asked = query;
        std::memcpy(asked.animation, wanted.c_str(), wanted.size() + 1);
        status = ask_view(&rig.inquiry, asked, &entry);
        CHECK(status.ok == (wanted != "Walk"));
        if (status.ok) CHECK(entry.animation == (wanted == "none" ? kNone : 0u));
      }
      query.camera_index = 77;
      status = ask_view(&rig.inquiry, query, &entry);
      CHECK(!status.ok);
      CHECK(has(status.message, "cannot render with these settings"));
      query.scene.low ^= 1;
      status = ask_view(&rig.inquiry, query, &entry);
      CHECK(has(status.message, "does not have this scene"));
    }
}

// Goal: bytes that do not match the scene are refused with the reason.
TEST_CASE("inquiry_refuses_a_scene_that_is_not_what_was_told") {
  CHECK(fetch_error([](Message*) {}).empty());
  std::vector<std::uint8_t> other(kFile);
  other[5] ^= 1;
  CHECK(has(fetch_error([&](Message* m) {
              if (m->scene_piece.offset == 0) m->scene_piece.bytes.data = other.data();
            }),
            "a different scene than announced"));
  CHECK(has(fetch_error([](Message* m) { --m->scene_piece.bytes.count; }), "shorter than announced"));
  CHECK(has(fetch_error([](Message* m) {
              if (m->scene_piece.offset == 0) ++m->scene_piece.bytes.count;
            }),
            "longer than announced"));
  CHECK(has(fetch_error([](Message* m) { m->scene_piece.offset += 1; }), "the wrong piece"));
  CHECK(has(fetch_error([](Message* m) { m->scene_piece.hash.low ^= 1; }), "the wrong piece"));
  CHECK(has(fetch_error([](Message* m) { *m = entry_of(0, 1, "a"); }), "an unrequested message"));
  CHECK(has(fetch_error([](Message* m) {
              m->type = MessageType::error;
              m->error.code = WireError::busy;
            }),
            "it is full"));
}

// Goal: a silent or missing server is given up after a while. Method: virtual time.
TEST_CASE("inquiry_gives_up_on_silence") {
  FakeServer fake([&](const Message& message) -> std::vector<Message> {
    if (message.type == MessageType::hello) return {hello_of_server()};
    return {};
  });
  Inquiry inquiry;
  REQUIRE(open_inquiry(InquiryOptions(), fake.link, fake.address, &inquiry).ok);
  std::uint64_t begin = platform::kNullLink.now_ns(fake.link);
  std::vector<SceneEntry> entries;
  Status status = list_scenes(&inquiry, &entries);
  CHECK(has(status.message, "does not answer"));
  std::uint64_t took = platform::kNullLink.now_ns(fake.link) - begin;
  CHECK(took >= 10'000 * kMs);
  CHECK(took < 11'000 * kMs);
  bool stop = false;
  InquiryOptions options;
  options.stopped = [&] { return stop; };
  Inquiry stopped;
  fake.stream = -1;
  REQUIRE(open_inquiry(options, fake.link, fake.address, &stopped).ok);
  stop = true;
  CHECK(has(list_scenes(&stopped, &entries).message, "interrupted"));
}

// Goal: reasons leave the server's name to the caller, which puts it in front. Method: a server that hangs up, and
// none.
TEST_CASE("inquiry_reasons_do_not_name_the_server") {
  FakeServer* serving = nullptr;
  FakeServer fake([&](const Message&) -> std::vector<Message> { return serving->hang_up(), std::vector<Message>(); });
  serving = &fake;
  for (const char* reason : {"the peer ", "nothing is listening there"}) {
    Inquiry inquiry;
    const Status status = open_inquiry(InquiryOptions(), fake.link, fake.address, &inquiry);
    CHECK_FALSE(status.ok);
    CHECK_MESSAGE(std::strncmp(status.message, reason, std::strlen(reason)) == 0, status.message);
    platform::kNullLink.close(fake.link, fake.listener);
  }
}

// Goal: an inquiry can be stopped however fast a server answers. Method: a server whose answers are always ready, so
// that the device never waits; stopped at the first piece of a scene, and while reading a list.
TEST_CASE("inquiry_stops_while_a_server_never_makes_it_wait") {
  FakeServer fake([&](const Message& message) -> std::vector<Message> {
    if (message.type == MessageType::hello) return {hello_of_server()};
    if (message.type == MessageType::scene_list) return {entry_of(message.scene_list.index, 60'000, "a")};
    return {piece_of(message.scene_fetch)};
  });
  fake.flood = [] { return std::vector<std::uint8_t>(); };  // it sends while the device reads
  bool stop = false;
  std::uint32_t asked = 0;
  InquiryOptions options;
  options.stopped = [&] { return stop || ++asked > 1000; };
  Inquiry inquiry;
  REQUIRE(open_inquiry(options, fake.link, fake.address, &inquiry).ok);
  std::vector<std::uint8_t> bytes(kFile.size());
  std::uint64_t come = 0;
  Status status =
      fetch_scene(&inquiry, entry_of(0, 1, "a").scene_entry, bytes.data(), bytes.size(), [&](std::uint64_t done) {
        come = done;
        stop = true;
      });
  CHECK(has(status.message, "interrupted"));
  CHECK(come < kFile.size() / 2);
  stop = false;
  asked = 0;
  std::vector<SceneEntry> entries;
  Inquiry another;
  fake.hang_up();
  REQUIRE(open_inquiry(options, fake.link, fake.address, &another).ok);
  CHECK(has(list_scenes(&another, &entries).message, "interrupted"));
  CHECK(entries.size() < 2000);
}

// Goal: a server that sends extra answers is no longer trusted. Method: two answers to one question, of each kind; the
// second arrives in place of the next answer.
TEST_CASE("inquiry_ends_with_an_answer_to_no_question") {
  for (int kind = 0; kind < 3; ++kind) {
    CAPTURE(kind);
    FakeServer fake([&](const Message& message) -> std::vector<Message> {
      Message extra = kind == 0 ? hello_of_server() : entry_of(0, 2, "a");
      if (kind == 2) extra.type = MessageType::pong;
      if (message.type == MessageType::hello) return {hello_of_server(), extra};
      return {entry_of(message.scene_list.index, 2, "a"), extra};
    });
    Inquiry inquiry;
    std::vector<SceneEntry> entries;
    REQUIRE(open_inquiry(InquiryOptions(), fake.link, fake.address, &inquiry).ok);
    Status status = list_scenes(&inquiry, &entries);
    CHECK(has(status.message, kind == 1 ? "is inconsistent" : "an unrequested message"));
  }
}

// Goal: an inconsistent list is refused, an empty one accepted; names cannot control a terminal.
TEST_CASE("inquiry_does_not_trust_lists") {
  std::uint16_t count = 2, second_count = 2, second_index = 1;
  auto answer = [&](const Message& message) -> std::vector<Message> {
    if (message.type == MessageType::hello) return {hello_of_server()};
    std::uint16_t index = message.scene_list.index;
    Message entry = index == 0 ? entry_of(0, count, "a\x1b[2J") : entry_of(second_index, second_count, "b");
    if (count == 0) entry.scene_entry.byte_count = 0;
    return {entry};
  };
  auto list = [&](std::vector<SceneEntry>* entries) {
    FakeServer fake(answer);
    Inquiry inquiry;
    REQUIRE(open_inquiry(InquiryOptions(), fake.link, fake.address, &inquiry).ok);
    return list_scenes(&inquiry, entries);
  };
  std::vector<SceneEntry> entries;
  REQUIRE(list(&entries).ok);
  REQUIRE(entries.size() == 2);
  CHECK(std::strcmp(entries[0].name, "a?[2J") == 0);
  second_count = 9;
  CHECK(has(list(&entries).message, "is inconsistent"));
  second_count = 2, second_index = 0;
  CHECK(has(list(&entries).message, "is inconsistent"));
  count = 0;
  CHECK(list(&entries).ok);
  CHECK(entries.empty());
}
