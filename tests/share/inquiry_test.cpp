// What a device asks before its first frame, and servers that lie.
#include "app/inquiry.h"

#include <doctest/doctest.h>

#include <cstring>
#include <functional>

#include "app/frame.h"
#include "app/scene_store.h"
#include "app/virtual_world.h"
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

struct FakeServer;
struct FakeLink : platform::LinkBackend {
  FakeServer* server = nullptr;
};

// A server that answers as a test tells it to; it works while the device waits.
struct FakeServer {
  using Answer = std::function<std::vector<Message>(const Message&)>;
  std::vector<std::max_align_t> memory;
  FakeLink backend;
  platform::Link* link = nullptr;
  platform::LinkAddress address;
  int listener = -1, stream = -1;
  std::vector<std::uint8_t> in, out;
  Answer answer;

  explicit FakeServer(const Answer& answer_) : answer(answer_) {
    const platform::LinkBackend& net = platform::kNullLink;
    platform::NullLinkSettings line;
    platform::LinkOptions options;
    options.stream_count_max = 8;
    options.memory_bytes = null_link_need(8, line);
    memory.resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
    options.memory = memory.data();
    platform::Error error;
    link = null_link_open(options, line, &error);
    REQUIRE(link != nullptr);
    REQUIRE(net.resolve(":0", &address, &error));
    listener = net.listen(link, address, &error);
    REQUIRE(net.resolve(net.stream_name(link, listener), &address, &error));
    static_cast<platform::LinkBackend&>(backend) = net;
    backend.poll = step_and_poll;
    backend.server = this;
    link->backend = &backend;
  }
  ~FakeServer() { platform::kNullLink.close_all(link); }
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  static int step_and_poll(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
    static_cast<const FakeLink*>(link->backend)->server->step();
    return platform::kNullLink.poll(link, waits, wait_count, std::min(timeout_ns, kMs));
  }

  void step() {
    const platform::LinkBackend& net = platform::kNullLink;
    platform::Error error;
    if (stream < 0) net.accept(link, listener, &stream, &error);
    if (stream < 0) return;
    std::uint8_t bytes[4096];
    std::size_t count = 0;
    if (net.read(link, stream, bytes, sizeof bytes, &count, &error) == platform::LinkResult::done)
      in.insert(in.end(), bytes, bytes + count);
    Message message;
    for (Decoded decoded;
         (decoded = decode_message(in.data(), in.size(), 4096, &message)).state == DecodeState::message;) {
      for (const Message& reply : answer(message)) {
        std::vector<std::uint8_t> reply_bytes = bytes_of(reply);
        out.insert(out.end(), reply_bytes.begin(), reply_bytes.end());
      }
      in.erase(in.begin(), in.begin() + decoded.byte_count);
    }
    if (!out.empty() && net.write(link, stream, out.data(), out.size(), &count, &error) == platform::LinkResult::done)
      out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
  }
};

const std::vector<std::uint8_t> kFile(100'000, 7);  // fetched in several pieces

Message hello_of_server() {
  Message message;
  message.type = MessageType::hello;
  message.hello = {kWireVersion, 2048, 512, 0};
  return message;
}

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

// What fetching from it ends with; a piece goes through `change` before it is sent.
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
  if (status.ok) status = fetch_scene(&inquiry, entry_of(0, 1, "a").scene_entry, bytes.data(), {});
  if (status.ok) CHECK(bytes == kFile);
  return status.message;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

// Goal: a device gets a server's list and any of its scenes, as it lies there. Method: all of the built-in ones.
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
    Status status = fetch_scene(&rig.inquiry, entries[i], bytes.data(), [&](std::uint64_t done) {
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

// Goal: the view that a server tells of is the one that a device with the scene begins with. Method: camera, bounds and
// exposure by make_renderer(), the scene's own, measured, and measured from a stated camera; a camera that there is
// not.
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
      Renderer* r = &device->renderer;
      if (round == 2) {
        query.camera_stated = true;
        query.camera = r->camera;
        query.camera.eye = r->camera.eye * 0.5f + r->camera.target * 0.5f;
        query.camera.node = kNone;
        REQUIRE(set_camera(r, query.camera).ok);
      }
      r->exposure = r->scene.info.exposure;
      REQUIRE(prepare_frame(r, 0).ok);
      if (round > 0) r->exposure = measure_exposure(r);
      ViewEntry entry;
      Status status = ask_view(&rig.inquiry, query, &entry);
      REQUIRE_MESSAGE(status.ok, status.message);
      CHECK(entry.exposure == r->exposure);
      CHECK(std::memcmp(&entry.camera.eye, &r->camera.eye, sizeof(Vec3)) == 0);
      CHECK(std::memcmp(&entry.camera.target, &r->camera.target, sizeof(Vec3)) == 0);
      CHECK(entry.camera.vertical_fov == r->camera.vertical_fov);
      CHECK(std::memcmp(&entry.bounds, &r->accel.bounds, sizeof(Box)) == 0);
      CHECK(entry.effects == r->effects.mask);
      CHECK(entry.triangle_count == r->scene.triangles.count);
      CHECK(entry.frames_per_second == r->scene.info.frames_per_second);
      query.camera_index = 77;
      status = ask_view(&rig.inquiry, query, &entry);
      CHECK(!status.ok);
      CHECK(has(status.message, "cannot render with these settings"));
      query.scene.low ^= 1;
      status = ask_view(&rig.inquiry, query, &entry);
      CHECK(has(status.message, "does not have this scene"));
    }
}

// Goal: bytes that are not those of the scene are refused, and why is said.
TEST_CASE("inquiry_refuses_a_scene_that_is_not_what_was_told") {
  CHECK(fetch_error([](Message*) {}).empty());
  std::vector<std::uint8_t> other(kFile);
  other[5] ^= 1;
  CHECK(has(fetch_error([&](Message* m) {
              if (m->scene_piece.offset == 0) m->scene_piece.bytes.data = other.data();
            }),
            "not the scene that it told of"));
  CHECK(has(fetch_error([](Message* m) { --m->scene_piece.bytes.count; }), "shorter than it told"));
  CHECK(has(fetch_error([](Message* m) {
              if (m->scene_piece.offset == 0) ++m->scene_piece.bytes.count;
            }),
            "longer than it told"));
  CHECK(has(fetch_error([](Message* m) { m->scene_piece.offset += 1; }), "another piece"));
  CHECK(has(fetch_error([](Message* m) { m->scene_piece.hash.low ^= 1; }), "another piece"));
  CHECK(has(fetch_error([](Message* m) { *m = entry_of(0, 1, "a"); }), "what it was not asked for"));
  CHECK(has(fetch_error([](Message* m) {
              m->type = MessageType::error;
              m->error.code = WireError::busy;
            }),
            "as many clients as it takes"));
}

// Goal: a server that falls silent, or nobody at all, is given up after a while. Method: virtual time.
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
  CHECK(has(list_scenes(&stopped, &entries).message, "not waited for"));
}

// Goal: a list that contradicts itself is refused, an empty one is not; names cannot move a terminal's cursor.
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
  CHECK(has(list(&entries).message, "contradicts itself"));
  second_count = 2, second_index = 0;
  CHECK(has(list(&entries).message, "contradicts itself"));
  count = 0;
  CHECK(list(&entries).ok);
  CHECK(entries.empty());
}
