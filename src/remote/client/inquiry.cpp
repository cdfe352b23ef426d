#include "remote/client/inquiry.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "remote/client/client.h"

namespace pocketray {
namespace {

// Chosen: two pieces in flight keep a link busy if its round trip is shorter than a piece takes, 26 ms at 10 Mbit/s; a
// stop after 50 ms feels immediate. Derived: kOutBytes holds two of the longest messages that a server takes.
constexpr std::size_t kOutBytes = 1024;
constexpr std::uint32_t kPieceBytes = 32768, kPiecesAhead = 2;  // requested while another is in flight
constexpr std::uint64_t kLookNs = 50'000'000;                   // longest delay until a stop is noticed

std::uint64_t now_ns(const Inquiry& q) { return q.link->backend->now_ns(q.link); }

Status check_stop(const Inquiry& q) {
  return q.options.stopped && q.options.stopped() ? failure("interrupted") : success();
}

Status wait_for_news(Inquiry* q, bool want_write, std::uint64_t left_ns) {
  RETURN_IF_ERROR(check_stop(*q));
  platform::LinkWait wait;
  wait.stream = q->messages.stream;
  wait.want_read = true;
  wait.want_write = want_write;
  q->link->backend->poll(q->link, &wait, 1, std::min(left_ns, kLookNs));
  return success();
}

Status connect(Inquiry* q, const platform::LinkAddress& address) {
  platform::Error error;
  if (!connect_message_stream(&q->messages, q->link, address, q->options.connect_timeout_ns, &error))
    return failure("%s", error.text);
  platform::LinkTimer timer = platform::link_timer(now_ns(*q), q->options.connect_timeout_ns);
  for (;;) {
    platform::LinkResult result = connected_message_stream(&q->messages, &error);
    if (result == platform::LinkResult::done) return success();
    if (result == platform::LinkResult::failed) return failure("%s", error.text);
    std::uint64_t left = platform::link_timer_left(&timer, now_ns(*q));
    if (left == 0) return failure("it does not answer");
    RETURN_IF_ERROR(wait_for_news(q, true, left));
  }
}

Status send(Inquiry* q, const Message& message) {
  return send_message(&q->messages, message) ? success() : failure("it stopped reading");
}

// Waits for an answer of that type; its arrays are valid until the next.
Status await(Inquiry* q, MessageType type, Message* answer) {
  platform::LinkTimer whole = platform::link_timer(now_ns(*q), q->options.answer_timeout_ns);
  platform::LinkTimer silence = platform::link_timer(now_ns(*q), q->options.silence_timeout_ns);
  RETURN_IF_ERROR(check_stop(*q));  // even if the server answers without a wait
  for (;;) {
    DecodeState state = take_message(&q->messages, answer);
    if (state == DecodeState::malformed) return failure("%s", malformed_text(q->messages));
    if (state == DecodeState::message) {
      if (answer->type == MessageType::error) return failure("%s", wire_error_text(answer->error.code));
      return answer->type == type ? success() : failure("it sent an unrequested message");
    }
    platform::Error error;
    std::uint64_t bytes_in = q->messages.bytes_in;
    if (!pump_message_stream(&q->messages, &error)) return failure("%s", error.text);
    if (q->messages.bytes_in != bytes_in) {
      silence = platform::link_timer(now_ns(*q), q->options.silence_timeout_ns);
      continue;
    }
    std::uint64_t left =
        std::min(platform::link_timer_left(&whole, now_ns(*q)), platform::link_timer_left(&silence, now_ns(*q)));
    if (left == 0) return failure("it does not answer");
    RETURN_IF_ERROR(wait_for_news(q, queued_bytes(q->messages) > 0, left));
  }
}

Status greet(Inquiry* q) {
  Message message, answer;
  message.type = MessageType::hello;
  message.hello.image_side_max = static_cast<std::uint16_t>(kImageSideMax);
  message.hello.message_bytes_max = q->messages.in.count;
  RETURN_IF_ERROR(send(q, message));
  RETURN_IF_ERROR(await(q, MessageType::hello, &answer));
  return check_version(answer.hello);
}

// Removes control characters from a server's text, which goes to a terminal.
void make_printable(char* text) {
  for (; *text; ++text)
    if (static_cast<unsigned char>(*text) < 0x20 || *text == 0x7F) *text = '?';
}

std::string without_ending(const std::string& name) { return name.substr(0, name.rfind('.')); }

}  // namespace

Status open_inquiry(const InquiryOptions& options, platform::Link* link, const platform::LinkAddress& address,
                    Inquiry* q) {
  CHECK(link != nullptr && q->messages.stream < 0);
  q->options = options;
  q->link = link;
  std::size_t in_bytes = kPiecesAhead * (kPieceBytes + 64);
  q->memory.resize(message_stream_need(in_bytes, kOutBytes) + kArenaAlignment);
  Arena arena = make_arena("inquiry", q->memory.data(), q->memory.size());
  q->messages = make_message_stream(in_bytes, kOutBytes, &arena);
  RETURN_IF_ERROR(connect(q, address));
  return greet(q);
}

Status list_scenes(Inquiry* q, std::vector<SceneEntry>* entries) {
  CHECK(entries != nullptr);
  entries->clear();
  std::uint32_t count = 1;
  platform::LinkTimer whole = platform::link_timer(now_ns(*q), q->options.answer_timeout_ns);
  for (std::uint32_t i = 0; i < count; ++i) {
    Message message, answer;
    message.type = MessageType::scene_list;
    message.scene_list.index = static_cast<std::uint16_t>(i);
    RETURN_IF_ERROR(send(q, message));
    RETURN_IF_ERROR(await(q, MessageType::scene_entry, &answer));
    SceneEntry* entry = &answer.scene_entry;
    if (entry->byte_count == 0 && i == 0) return success();
    if (entry->index != i || entry->byte_count == 0 || (i > 0 && entry->count != count))
      return failure("its list of scenes is inconsistent");
    count = entry->count;
    make_printable(entry->name);
    entries->push_back(*entry);
    if (platform::link_timer_left(&whole, now_ns(*q)) == 0) return failure("its list of scenes takes too long");
  }
  return success();
}

const SceneEntry* find_entry(const std::vector<SceneEntry>& entries, const std::string& name) {
  for (const SceneEntry& entry : entries)
    if (name == entry.name) return &entry;
  for (const SceneEntry& entry : entries)
    if (name == without_ending(entry.name) || without_ending(name) == entry.name) return &entry;
  return nullptr;
}

Status fetch_scene(Inquiry* q, const SceneEntry& entry, std::uint8_t* bytes, std::size_t byte_count_max,
                   const std::function<void(std::uint64_t)>& progress) {
  if (entry.byte_count > byte_count_max)
    return failure("the scene has %llu bytes but only %zu are free", static_cast<unsigned long long>(entry.byte_count),
                   byte_count_max);
  CHECK(bytes != nullptr || entry.byte_count == 0);
  std::uint64_t asked = 0, come = 0;
  auto piece_bytes = [&](std::uint64_t offset) {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(kPieceBytes, entry.byte_count - offset));
  };
  while (come < entry.byte_count) {
    for (; asked < entry.byte_count && asked < come + kPiecesAhead * kPieceBytes; asked += piece_bytes(asked)) {
      Message message;
      message.type = MessageType::scene_fetch;
      message.scene_fetch = {entry.hash, asked, piece_bytes(asked)};
      RETURN_IF_ERROR(send(q, message));
    }
    Message answer;
    RETURN_IF_ERROR(await(q, MessageType::scene_piece, &answer));
    const ScenePiece& piece = answer.scene_piece;
    if (!(piece.hash == entry.hash) || piece.offset != come) return failure("it sent the wrong piece of the scene");
    if (piece.bytes.count != piece_bytes(come))
      return failure("the scene is %s than announced", piece.bytes.count < piece_bytes(come) ? "shorter" : "longer");
    std::memcpy(bytes + come, piece.bytes.data, piece.bytes.count);
    come += piece.bytes.count;
    if (progress) progress(come);
  }
  CHECK_EQ(come, entry.byte_count);
  if (content_hash(bytes, to_size(entry.byte_count)) == entry.hash) return success();
  return failure("it sent a different scene than announced");
}

Status ask_view(Inquiry* q, const ViewQuery& query, ViewEntry* entry) {
  CHECK(entry != nullptr);
  Message message, answer;
  message.type = MessageType::view_query;
  message.view_query = query;
  RETURN_IF_ERROR(send(q, message));
  RETURN_IF_ERROR(await(q, MessageType::view_entry, &answer));
  *entry = answer.view_entry;
  return entry->scene == query.scene ? success() : failure("it described a different scene than requested");
}

}  // namespace pocketray
