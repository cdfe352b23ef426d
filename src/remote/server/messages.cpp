#include <cstring>

#include "base/check.h"
#include "base/seal.h"
#include "remote/server/state.h"
#include "session/animation_choice.h"

namespace pocketray {
namespace {

// Messages taken from one client before the others get their turn. Chosen: a tenth of a slice of rendering. The count
// is the limit where the link's clock stands still meanwhile, as in simulations.
constexpr int kMessagesAtOnce = 32;
constexpr std::uint64_t kMessagesNs = 2'000'000;

void send_scene_entry(Session* session, const SceneStore& store, const ContentHash& hash, const StoredScene* scene) {
  Message reply;
  reply.type = MessageType::scene_entry;
  SceneEntry* entry = &reply.scene_entry;
  entry->hash = hash;
  CHECK_LE(store.scenes.size(), std::size_t(UINT16_MAX));
  entry->count = static_cast<std::uint16_t>(store.scenes.size());
  if (scene) {
    entry->hash = scene->hash;
    entry->byte_count = scene->byte_count;
    entry->index = static_cast<std::uint16_t>(scene - store.scenes.data());
    entry->triangle_count = scene->scene.triangles.count;
    std::memcpy(entry->name, scene->name, sizeof entry->name);
  }
  send_message(session, reply);
}

void send_scene_piece(Session* session, const SceneFetch& fetch, const StoredScene* scene) {
  if (!scene) return send_error(session, WireError::unknown_scene, 0);
  Message reply;
  reply.type = MessageType::scene_piece;
  reply.scene_piece.hash = fetch.hash;
  reply.scene_piece.offset = fetch.offset;
  std::uint64_t left = fetch.offset < scene->byte_count ? scene->byte_count - fetch.offset : 0;
  std::uint32_t count = left < fetch.byte_count ? static_cast<std::uint32_t>(left) : fetch.byte_count;
  CHECK_LE(count, kPieceBytesMax);
  reply.scene_piece.bytes = {count ? scene->bytes + fetch.offset : nullptr, count};
  send_message(session, reply);
}

void send_pong(Session* session, const Ping& ping, std::uint32_t pixel_ps) {
  Message reply;
  reply.type = MessageType::pong;
  reply.pong.id = ping.id;
  reply.pong.pixel_ps = pixel_ps;
  reply.pong.price = session->price_stated = session->price;
  reply.pong.bytes.count = ping.reply_bytes;
  std::uint32_t byte_count = message_bytes(reply);
  std::uint8_t* at = reserve_output(&session->messages, byte_count);
  std::memset(at, 0, byte_count);
  reply.pong.bytes.data = at + byte_count - ping.reply_bytes;
  send_message(session, reply);
}

void begin_job(Session* session, const StoredScene* scene) {
  CHECK(scene != nullptr && !has_job(*session));
  session->job = FrameJob();
  session->job.scene = scene;
}

// Replaces the previous request, even if this one is refused.
void take_request(Server* server, Session* session, const FrameRequest& request) {
  const Settings& settings = request.settings;
  if (request.frame == 0) return refuse(server, session, WireError::bad_request, 0, "frames count from 1");
  bool is_late = request.frame < session->frame_last;  // more rows of the same frame may be requested
  if (is_late)
    return refuse(server, session, WireError::bad_request, request.frame, "a later frame was already requested");
  drop_job(session);
  ++session->job_number;
  session->frame_last = request.frame;
  session->request = request;
  if (settings.width != session->shape.width || settings.height != session->shape.height ||
      request.format != session->shape.format) {
    session->shape = {settings.width, settings.height, 1, request.format};
    session->encoder = nullptr;  // both ends start over
  }
  if (settings.width > server->options.image_side_max || settings.height > server->options.image_side_max)
    return refuse(server, session, WireError::too_large, request.frame,
                  "the picture is larger than this server allows");
  const StoredScene* scene = find_scene(*server->store, request.scene);
  if (!scene) return refuse(server, session, WireError::unknown_scene, request.frame, "unknown scene");
  begin_job(session, scene);
  CHECK(asks_for_something(request) && request.row_begin <= request.row_end && request.row_end <= settings.height);
  session->job.request = request;
  session->job.traced = session->job.sent = first_rows(request);
}

void take_frame_change(Server* server, Session* session, const FrameRequest& change) {
  if (session->request.frame == 0 || change.row_end > session->request.settings.height)
    return refuse(server, session, WireError::bad_request, change.frame, "it changes a frame that was not requested");
  FrameRequest request = session->request;
  take_change(change, &request);
  if (!asks_for_something(request))
    return refuse(server, session, WireError::bad_request, change.frame, "it asks for neither rows nor light");
  take_request(server, session, request);
}

static Status find_by_name(const Scene& scene, const char* name, std::uint32_t* animation) {
  SealPause pause;  // names are on the heap
  return find_animation(scene, name, animation);
}

void take_view_query(Server* server, Session* session, const ViewQuery& query) {
  drop_job(session);
  ++session->job_number;
  const Settings& settings = query.settings;
  if (settings.width > server->options.image_side_max || settings.height > server->options.image_side_max)
    return refuse(server, session, WireError::too_large, 0, "the picture is larger than this server allows");
  const StoredScene* scene = find_scene(*server->store, query.scene);
  if (!scene) return refuse(server, session, WireError::unknown_scene, 0, "unknown scene");
  std::uint32_t animation;
  const Status found = find_by_name(scene->scene, query.animation, &animation);
  if (!found.ok) return refuse(server, session, WireError::bad_request, 0, found.message);
  begin_job(session, scene);
  session->job.is_view_query = true;
  session->job.measure_exposure = query.measure_exposure;
  FrameRequest* request = &session->job.request;
  request->scene = query.scene, request->animation = animation;
  request->camera_stated = query.camera_stated, request->camera_index = query.camera_index;
  request->camera = query.camera, request->settings = query.settings;
}

// Returns false if the session has ended.
bool take_message(Server* server, Session* session, const Message& message) {
  constexpr WireError kMalformed = WireError::malformed;
  const SceneStore& store = *server->store;
  switch (message.type) {
    case MessageType::scene_list: {
      std::size_t index = message.scene_list.index;
      send_scene_entry(session, store, ContentHash(), index < store.scenes.size() ? &store.scenes[index] : nullptr);
      return true;
    }
    case MessageType::scene_query:
      send_scene_entry(session, store, message.scene_query.hash, find_scene(store, message.scene_query.hash));
      return true;
    case MessageType::scene_fetch:
      send_scene_piece(session, message.scene_fetch, find_scene(store, message.scene_fetch.hash));
      return true;
    case MessageType::frame_request:
      take_request(server, session, message.frame_request);
      return true;
    case MessageType::frame_change:
      take_frame_change(server, session, message.frame_request);
      return true;
    case MessageType::view_query:
      take_view_query(server, session, message.view_query);
      return true;
    case MessageType::cancel:
      if (has_job(*session) && session->job.request.frame <= message.cancel.frame) drop_job(session);
      return true;
    case MessageType::ping:
      send_pong(session, message.ping, session->pixel_ps ? session->pixel_ps : server->pixel_ps);
      return true;
    case MessageType::error:
      end_session(server, session, message.error.code == WireError::closing ? "it shut down" : "it reported an error");
      return false;
    case MessageType::hello:
    case MessageType::scene_entry:
    case MessageType::scene_piece:
    case MessageType::row_chunk:
    case MessageType::coarse_picture:
    case MessageType::light_map:
    case MessageType::pong:
    case MessageType::view_entry:
      break;
  }
  leave(server, session, &kMalformed, "it sent a message only servers send");
  return false;
}

}  // namespace

Message server_hello(const Server& server, std::uint64_t address_key) {
  Message message;
  message.type = MessageType::hello;
  message.hello.image_side_max = static_cast<std::uint16_t>(server.options.image_side_max);
  message.hello.message_bytes_max = kRequestBytesMax;
  message.hello.price = newcomer_price(server, address_key);
  return message;
}

int take_messages(Server* server, Session* session) {
  constexpr WireError kMalformed = WireError::malformed;
  std::uint64_t start = now_ns(server);
  int count = 0;
  while (wants_messages(*session)) {
    Message message;
    DecodeState state = take_message(&session->messages, &message);
    session->more_to_take = state == DecodeState::message;
    if (state == DecodeState::need_more) break;
    ++count;
    if (state == DecodeState::malformed) {
      leave(server, session, &kMalformed, "it sent a malformed message");
      return count;
    }
    std::uint64_t now = now_ns(server);
    session->idle_timer = platform::link_timer(now, server->options.idle_timeout_ns);
    session->message_timer = platform::link_timer(now, server->options.message_timeout_ns);
    if (!take_message(server, session, message)) return count;
    if (count == kMessagesAtOnce || now_ns(server) > start + kMessagesNs) break;
  }
  if (session->messages.ended && !wants_messages(*session) && session->phase == SessionPhase::serving &&
      !session->more_to_take)
    end_session(server, session, "it closed the connection");
  return count;
}

void read_session(Server* server, Session* session) {
  MessageStream* messages = &session->messages;
  CHECK(session->phase != SessionPhase::unused);
  bool leaving = session->phase == SessionPhase::leaving;
  if (leaving) drop_input(messages);
  if (input_bytes(*messages) == 0)
    session->message_timer = platform::link_timer(now_ns(server), server->options.message_timeout_ns);
  std::uint64_t before = messages->bytes_in;
  platform::Error error;
  if (!read_message_stream(messages, &error)) return end_session(server, session, error.text);
  session->more_to_take |= !leaving && messages->bytes_in > before;
  // Its earlier messages are still handled.
  if (messages->ended && (leaving || !session->more_to_take)) end_session(server, session, "it closed the connection");
}

}  // namespace pocketray
