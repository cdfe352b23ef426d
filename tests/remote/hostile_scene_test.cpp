// Servers that lie about the size of their scenes: nothing is written out of bounds.
#include <doctest/doctest.h>

#include <cstring>

#include "fake_server.h"
#include "remote/client/inquiry.h"
#include "remote/client/servers.h"

using namespace pocketray;

namespace {

const std::vector<std::uint8_t> kRubbish(kPieceBytesMax, 0xA5);

// Claims one scene of `byte_count` bytes, and sends every piece requested.
FakeServer::Answer scene_of(std::uint64_t byte_count) {
  return [=](const Message& question) -> std::vector<Message> {
    Message answer;
    if (question.type == MessageType::hello) {
      answer.hello = {kWireVersion, 2048, 1u << 20, 0};
    } else if (question.type == MessageType::scene_list) {
      answer.type = MessageType::scene_entry;
      answer.scene_entry.hash = {1, 2};
      answer.scene_entry.byte_count = byte_count;
      answer.scene_entry.count = 1;
      std::strcpy(answer.scene_entry.name, "lie");
    } else if (question.type == MessageType::scene_fetch) {
      const SceneFetch& fetch = question.scene_fetch;
      answer.type = MessageType::scene_piece;
      answer.scene_piece = {fetch.hash, fetch.offset, {kRubbish.data(), fetch.byte_count}};
    } else {
      answer.type = MessageType::error;
      answer.error.code = WireError::unknown_scene;
    }
    return {answer};
  };
}

const std::uint64_t kLies[] = {1u << 20,           (1u << 24) + 1,     0x7FFFFFFF,       0x80000000,    0xFFFFFFC1,
                               0xFFFFFFFF,         0x1'0000'0000,      0x1'0000'0040,    0x7'0000'1000, 1ull << 62,
                               0x8000000000000040, 0xFFFFFFFFFFFFFFC1, ~std::uint64_t(0)};

}  // namespace

// Goal: a device takes no more bytes from a server than fit, whatever the server claims and whatever the CPU's address
// width. Method: the whole path of `render lie --server` with sizes around every power at which a count could wrap; a
// sanitizer or the heap notices overruns.
TEST_CASE("hostile_scene_sizes_are_refused_with_one_line") {
  for (std::uint64_t lie : kLies) {
    CAPTURE(lie);
    FakeServer server(scene_of(lie));
    ConnectedServers servers;
    servers.link = server.link;
    servers.addresses = {server.address};
    CommonOptions options;
    options.scene = "lie";
    options.memory = "4M";
    options.size = "64x48";
    OpenScene opened;
    Status status = kRenderServers.open_scene(
        &servers, options, [](const Settings&) { return std::size_t(0); }, &opened);
    CHECK(!status.ok);
    CHECK(std::strlen(status.message) > 0);
    CHECK(std::strchr(status.message, '\n') == nullptr);
    if (lie > (1u << 24)) CHECK(std::strstr(status.message, "does not fit in --memory 4.0M") != nullptr);
    bool hopeless = lie > kMemoryBytesMax / 5 * 4;
    if (lie > (1u << 24)) CHECK((std::strstr(status.message, "would be a start") == nullptr) == hopeless);
  }
}

// Goal: fetch_scene() itself stays within its buffer.
TEST_CASE("hostile_scene_is_not_fetched_beyond_the_room") {
  for (std::uint64_t lie : kLies) {
    FakeServer server(scene_of(lie));
    Inquiry inquiry;
    REQUIRE(open_inquiry(InquiryOptions(), server.link, server.address, &inquiry).ok);
    SceneEntry entry;
    entry.byte_count = lie;
    std::vector<std::uint8_t> bytes(64 + 64, 7);
    Status status = fetch_scene(&inquiry, entry, bytes.data(), 64, {});
    CHECK(!status.ok);
    CHECK(std::strstr(status.message, "only 64 are free") != nullptr);
    CHECK(bytes == std::vector<std::uint8_t>(64 + 64, 7));
  }
}
