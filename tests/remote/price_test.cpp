// The price of a server's time: what it states, and what a device among others makes of it.
#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "engine/frame.h"
#include "hostile_rig.h"
#include "present/pack.h"
#include "remote/server/state.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr double kDevicePixelNs = 20'000, kServerPixelNs = 10'000;

// A device and a server, and others that ask it for frame after frame, on one simulated link.
struct SharedServer {
  platform::LinkBackend device_net = platform::kNullLink, server_net = platform::kNullLink;
  ServerRig rig;
  std::vector<int> addresses = {1};  // of the connections, in order of creation, as the link has only one
  std::unique_ptr<BuiltScene> built = build_builtin("cornell");
  std::unique_ptr<TestRenderer> device, whole;
  std::vector<unsigned char> memory;
  Client client;
  std::vector<std::unique_ptr<ScriptedClient>> others;
  FrameRequest request = frame_request("cube", 0, 64, 48);
  std::vector<std::uint8_t> others_picture = rendered_here(request);
  int others_frames = 0;
  bool stepping = false;

  static ServerOptions options() {
    ServerOptions o;
    o.pace.ns_per_pixel = kServerPixelNs;
    return o;
  }
  SharedServer();
  ~SharedServer();
  void step();
  // The mean device's rows of the last frames of `seconds`; every frame has the pixels that the device would render.
  double device_rows_after(double seconds);
  double price() const { return static_cast<double>(client.plan.model.servers[0].price_stated); }
};
SharedServer* shared = nullptr;

const char* named_by_address(const platform::Link* link, int stream) {
  static char name[48];
  const char* own = platform::kNullLink.stream_name(link, stream);
  const int port = std::atoi(std::strrchr(own, ':') + 1);
  const std::size_t connection = static_cast<std::size_t>(port - 49152);
  if (connection >= shared->addresses.size()) return own;
  std::snprintf(name, sizeof name, "10.0.0.%d:%d", shared->addresses[connection], port);
  return name;
}

// Server and others work while the device waits.
int poll_stepping(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  const platform::LinkBackend& net = platform::kNullLink;
  if (shared->stepping) return net.poll(link, waits, wait_count, timeout_ns);
  shared->stepping = true;
  const std::uint64_t begin = net.now_ns(link);
  int ready = 0;
  for (;;) {
    shared->step();
    const std::uint64_t passed = net.now_ns(link) - begin, left = passed < timeout_ns ? timeout_ns - passed : 0;
    const std::uint64_t step =
        std::max<std::uint64_t>(2'000, std::min<std::uint64_t>(100'000, work_due_ns(shared->rig.server)));
    ready = net.poll(link, waits, wait_count, std::min(left, step));
    if (ready > 0 || left <= step) break;
  }
  shared->stepping = false;
  return ready;
}

SharedServer::SharedServer() : rig(options(), fine_clock()) {
  shared = this;
  device_net.poll = poll_stepping;
  server_net.stream_name = named_by_address;
  rig.server->net = &server_net, rig.link->backend = &device_net;
  Settings settings;
  settings.width = 64, settings.height = 48, settings.coherence = CoherenceMode::off;
  device = make_renderer(built->scene, settings), whole = make_renderer(built->scene, settings);
  ClientOptions o;
  o.pace.ns_per_pixel = kDevicePixelNs;
  memory.resize(client_need(settings, o.format, 1) + kArenaAlignment);
  Arena arena = make_arena("client", memory.data(), memory.size());
  REQUIRE(make_client(o, settings, builtin_hash("cornell"), rig.link, &rig.address, 1, &arena, &client).ok);
}

SharedServer::~SharedServer() {
  close_client(&client);
  rig.link->backend = &platform::kNullLink, rig.server->net = &platform::kNullLink;
}

void SharedServer::step() {
  rig.step(0);
  for (auto& other : others) {
    other->poll();
    REQUIRE_FALSE(other->closed);
    if (other->frame > 0 && other->rows_come < request.settings.height) continue;
    if (other->frame > 0) {
      CHECK(other->picture() == others_picture);
      ++others_frames;
    }
    request.frame = other->frame + 1;
    other->request(request);
  }
}

double SharedServer::device_rows_after(double seconds) {
  const std::uint64_t begin = rig.now(), ns = static_cast<std::uint64_t>(seconds * 1e9);
  double rows = 0;
  int count = 0;
  while (rig.now() < begin + ns) {
    REQUIRE(render_frame(&device->renderer, &client, 0).ok);
    REQUIRE(render_frame(&whole->renderer, 0).ok);
    std::vector<std::uint8_t> alone(client.picture.pixels.count);
    pack_rows(whole->renderer.image.data, 64, 48, 0, 48, display_of(whole->renderer), kRgb888, Rotation::none, false,
              alone.data(), 64 * 3);
    CHECK(std::equal(alone.begin(), alone.end(), client.picture.pixels.begin()));
    if (rig.now() < begin + ns * 3 / 4) continue;
    rows += client.share.device_rows, ++count;
  }
  return rows / count;
}

// Messages of a server with that price.
std::vector<Message> priced(std::vector<Message> messages, std::uint16_t price) {
  for (Message& message : messages) message.hello.price = message.row_chunk.price = message.pong.price = price;
  return messages;
}

}  // namespace

// Goal: a busy server is dear, by address: its price rises with those that compete, a device's split follows, and falls
// again when they are gone; every pixel is right. Method: a device twice as slow as the server; four clients with frame
// after frame, of one other address or of four.
TEST_CASE("price_of_a_busy_server_moves_rows_to_the_device") {
  if (kEffortDivisor > 6) {
    MESSAGE("skipped: it takes minutes under emulation");
    return;
  }
  for (int address_count : {1, 4}) {
    CAPTURE(address_count);
    SharedServer s;
    const double alone = s.device_rows_after(1);
    CHECK(s.price() == 1);
    CHECK(alone == doctest::Approx(48 / 3.0).epsilon(0.1));
    for (int i = 0; i < 4; ++i) {
      s.addresses.push_back(2 + i % address_count);
      s.others.push_back(std::make_unique<ScriptedClient>(&s.rig));
    }
    const double among = s.device_rows_after(4), price = 1 + address_count;
    MESSAGE("price " << s.price() << ", " << among << " rows of the device, alone " << alone);
    CHECK(s.price() == doctest::Approx(price).epsilon(0.05));
    CHECK(among == doctest::Approx(48 * price / (2 + price)).epsilon(0.1));
    CHECK(s.others_frames > 40);
    s.others.clear();
    CHECK(s.device_rows_after(6) == doctest::Approx(alone).epsilon(0.15));
    CHECK(s.price() < 1.01);
  }
}

// Goal: a newcomer learns the price from the hello. Method: the hello to a further address, and to a second connection
// of the busy one.
TEST_CASE("price_is_in_the_hello") {
  if (kEffortDivisor > 6) {
    MESSAGE("skipped: it takes minutes under emulation");
    return;
  }
  for (int address : {1, 2, 3}) {
    CAPTURE(address);
    SharedServer s;
    s.addresses = {1, 2, address};
    s.others.push_back(std::make_unique<ScriptedClient>(&s.rig));
    s.device_rows_after(3);  // the device asks for a part of the time only
    ScriptedClient newcomer(&s.rig);
    const Message hello = newcomer.wait_for(MessageType::hello)->message;
    const double price = hello.hello.price / double(kPriceUnit);
    MESSAGE("price for address " << address << ": " << price);
    CHECK(price > (address == 3 ? 2.4 : 3));
    CHECK(price <= (address == 3 ? 3 : 4));
  }
}

// Goal: chunks and pongs tell the work on a pixel, whoever else there is, and a price that rises while another client
// has work and falls afterwards. Method: 20 µs per pixel; another client arrives during a frame; the price approaches 2
// as the moving average says.
TEST_CASE("server_tells_its_work_on_a_pixel_and_its_price") {
  ServerOptions options;
  options.pace.ns_per_pixel = 20'000;
  ServerRig rig(options);
  ScriptedClient first(&rig), second(&rig);
  second.wait_for(MessageType::hello);
  FrameRequest request = frame_request("cube", 1, 64, 960);
  first.request(request);
  rig.run_until([&] { return first.poll(), first.rows_come >= 480; });
  CHECK(first.chunks.back().price == kPriceUnit);
  second.request(request);
  std::uint64_t start = rig.now();
  rig.run_until([&] { return first.poll(), second.poll(), first.rows_come == 960; });
  const double passed = static_cast<double>(rig.now() - start) / static_cast<double>(kDemandNs);
  for (const RowChunk& chunk : first.chunks) CHECK(chunk.pixel_ps == doctest::Approx(2e7).epsilon(0.05));
  CHECK(first.chunks.back().price == doctest::Approx(kPriceUnit * (2 - std::exp(-passed))).epsilon(0.03));
  const std::size_t chunks_before = second.chunks.size();
  CHECK(second.chunks.back().price > 1.9 * kPriceUnit);
  second.wait_for_rows(960);
  CHECK(second.chunks[chunks_before].price > 1.8 * kPriceUnit);
  CHECK(second.chunks.back().price < 1.5 * kPriceUnit);
  CHECK(second.chunks.back().pixel_ps == doctest::Approx(2e7).epsilon(0.05));
  ScriptedClient third(&rig);
  ScriptedClient* clients[] = {&first, &second, &third};  // the third has no figure of its own
  Message ping;
  ping.type = MessageType::ping;
  for (int i = 0; i < 3; ++i) {
    clients[i]->send(ping);
    const Pong pong = clients[i]->wait_for(MessageType::pong)->message.pong;
    CHECK(pong.pixel_ps == doctest::Approx(2e7).epsilon(0.1));
    CHECK(pong.price > 1.1 * kPriceUnit);
  }
}

// Goal: a server that lies about its price costs a frame at most 5 % of the device's time alone. Method: prices that
// are as high as can be, that flap from message to message, and too low for a server that then takes its time.
TEST_CASE("price_that_is_a_lie_costs_at_most_the_device_s_time") {
  enum Lie { dear, flapping, cheap_but_slow };
  for (Lie lie : {dear, flapping, cheap_but_slow}) {
    CAPTURE(lie);
    HostileRig rig;
    std::uint32_t count = 0;
    rig.act = [&](HostileRig* r, const Message& message) -> std::vector<Message> {
      const bool high = lie == dear || (lie == flapping && ++count % 2 > 0);
      const bool asks = message.type == MessageType::frame_request || message.type == MessageType::frame_change;
      std::vector<Message> answers = priced(r->answer(message), high ? UINT16_MAX : kPriceUnit);
      if (lie == cheap_but_slow && asks && r->all.size() > 3) return {};
      return answers;
    };
    for (int i = 0; i < 40; ++i) CHECK(rig.frame() < 1.05);
    CHECK(rig.all.size() > 1);
    CHECK(rig.client.plan.model.servers[0].price <= kPriceMax);
    CHECK((rig.log.empty() || lie == cheap_but_slow));
  }
}

// Goal: a price out of range is malformed. Method: a pong with a price of 0, or just below one, and the right checksum.
TEST_CASE("price_out_of_range_ends_the_connection") {
  for (int price : {0, kPriceUnit - 1}) {
    CAPTURE(price);
    HostileRig rig;
    rig.frames_until_ready();
    bool sent = false;
    rig.fake.flood = [&]() -> std::vector<std::uint8_t> {
      if (sent) return {};
      sent = true;
      std::vector<std::uint8_t> bytes = bytes_of(rig.pong({rig.client.servers[0].link.ping_id, 0}));
      bytes[16] = static_cast<std::uint8_t>(price), bytes[17] = 0;
      const uLong crc = crc32(crc32(0, bytes.data(), 4), bytes.data() + 8, static_cast<uInt>(bytes.size() - 8));
      for (std::uint32_t i = 0; i < 4; ++i) bytes[4 + i] = static_cast<std::uint8_t>(crc >> 8 * i);
      return bytes;
    };
    for (int i = 0; i < 3; ++i) CHECK(rig.frame() < 1.05);
    REQUIRE(rig.log.size() == 1);
    CHECK(rig.log[0].find("malformed") != std::string::npos);
  }
}
