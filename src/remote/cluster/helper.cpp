#include "remote/cluster/helper.h"

#include "base/check.h"
#include "base/seal.h"
#include "engine/workers.h"
#include "remote/cluster/pieces.h"
#include "session/source.h"

namespace pocketray {

ClusterHelper::ClusterHelper(const Team& team, const ServerOptions& options, std::uint64_t scene_bytes_max,
                             std::string identity)
    : team_(team), options_(options), scene_bytes_max_(scene_bytes_max), identity_(std::move(identity)) {
  CHECK(!leads(team));
}

ClusterHelper::~ClusterHelper() {
  stop_workers(workers_);
  for (void* block : blocks_) give_block_back(block);
}

Status ClusterHelper::open() {
  const std::size_t count = static_cast<std::size_t>(options_.client_count_max);
  CHECK(sessions_.empty() && count > 0);
  sessions_.resize(count);
  row_pixels_.resize(options_.image_side_max);
  for (Session& session : sessions_) {
    void* block = take_block(options_.client_memory_bytes);
    if (!block)
      return failure("not enough memory for %zu clients of %.0f MiB each", count,
                     static_cast<double>(options_.client_memory_bytes) / (1 << 20));
    blocks_.push_back(block);
    make_session(block, options_.client_memory_bytes, &session);
    session.message_bytes_max = kMessageBytesMax;
  }
  workers_ = start_workers(options_.thread_count);
  want({0, 0});
  return success();
}

void ClusterHelper::want(const ClusterWant& want) { send_plain(team_, 0, kWantScene, want); }

Status ClusterHelper::work(const TeamMessage& message) {
  CHECK(!message.bytes.empty());
  TeamReader reader(message);
  if (message.bytes[0] == kScene) return take_scene(&reader);
  if (message.bytes[0] == kPrepare) return prepare(&reader);
  if (message.bytes[0] == kTrace) return trace(&reader);
  return failure("rank 0 sent a message of an unknown kind: its program differs");
}

// Requests the next part, or reports that it has all scenes.
Status ClusterHelper::take_scene(TeamReader* reader) {
  ClusterScene scene;
  if (!read_plain(reader, &scene)) return failure("rank 0 sent a truncated message: its program differs");
  const std::size_t begin = scene_bytes_.size(), count = reader->left();
  if (scene.part.offset != begin || begin >= scene.byte_count || count > scene.byte_count - begin)
    return failure("rank 0 sent the wrong part of a scene: its program differs");
  scene_bytes_.resize(begin + count);
  CHECK(reader->take(scene_bytes_.data() + begin, count));
  if (scene_bytes_.size() < scene.byte_count) return want({scene.part.scene, scene_bytes_.size()}), success();
  scene.name[sizeof scene.name - 1] = 0;
  Status status = store_baked_scene(scene.name, scene_bytes_.data(), scene_bytes_.size(),
                                    scene_bytes_max_ - stored_bytes(store_), &store_);
  if (!status.ok) return failure("scene %s: %s", scene.name, status.message);
  if (store_.scenes.back().hash != scene.hash) return failure("scene %s arrived damaged", scene.name);
  scene_bytes_.clear();
  if (scene.part.scene + 1 < scene.scene_count) return want({scene.part.scene + 1, 0}), success();
  scene_bytes_ = std::vector<std::uint8_t>();
  TeamWriter text;
  text.text(identity_), text.number(options_.thread_count);
  send_to(team_, 0, kReady, text.bytes().data(), text.bytes().size());
  return success();
}

Status ClusterHelper::session_of(const ClusterJob& job, Session** session) {
  if (job.session >= sessions_.size()) return failure("rank 0 has more clients: give it and this one the same options");
  *session = &sessions_[job.session];
  return success();
}

Status ClusterHelper::prepare_job(Session* session, const ClusterPrepare& asked) {
  Message message;
  message.type = MessageType::frame_request, message.frame_request = asked.request;
  if (!(asked.own_exposure > 0) || !can_encode(message))
    return failure("rank 0 sent a request that no client can make");
  const FrameRequest& request = asked.request;
  const Settings& settings = request.settings;
  drop_job(session);
  session->job_number = asked.job.number;
  const CodecShape& shape = session->shape;
  if (settings.width != shape.width || settings.height != shape.height || request.format != shape.format) {
    session->shape = {settings.width, settings.height, 1, request.format};
    session->encoder = nullptr;
  }
  session->job = FrameJob();
  session->job.request = request;
  session->job.scene = find_scene(store_, request.scene);
  if (!session->job.scene) return failure("it has no such scene");
  session->own_exposure = asked.own_exposure;
  const JobTools tools = {options_.thread_count, workers_, options_.coherence};
  while (session->job.stage != JobStage::rows) {
    Slice slice;
    WireError code;
    RETURN_IF_ERROR(step_job(session, tools, kSliceNs, &slice, &code));
    session->own_exposure = asked.own_exposure;  // measured by rank 0
    if (session->job.stage == JobStage::own_exposure) session->job.stage = JobStage::aim;
  }
  return success();
}

Status ClusterHelper::prepare(TeamReader* reader) {
  ClusterPrepare asked;
  Session* session;
  if (!read_plain(reader, &asked)) return failure("rank 0 sent a truncated message: its program differs");
  RETURN_IF_ERROR(session_of(asked.job, &session));
  seal_memory();
  Status status = prepare_job(session, asked);
  unseal_memory();
  if (status.ok) return send_plain(team_, 0, kPrepared, asked.job), success();
  drop_job(session);
  TeamWriter text;
  write_plain(asked.job, &text), text.text(status.message);
  send_to(team_, 0, kRefused, text.bytes().data(), text.bytes().size());
  return success();
}

Status ClusterHelper::trace(TeamReader* reader) {
  ClusterTraced traced = {};
  Session* session;
  if (!read_plain(reader, &traced.asked)) return failure("rank 0 sent a truncated message: its program differs");
  RETURN_IF_ERROR(session_of(traced.asked.job, &session));
  const RowPiece& piece = traced.asked.piece;
  const bool is_part = piece.row_begin < piece.row_end && piece.row_end <= session->shape.height &&
                       piece.column_begin < piece.column_end && piece.column_end <= session->shape.width;
  if (!has_job(*session) || session->job_number != traced.asked.job.number || !is_part)
    return failure("rank 0 asked for rows of a frame that was not prepared");
  seal_memory();
  const std::uint64_t start = clock_ns();
  traced.pixels_traced = trace_piece(session, piece, row_pixels_.data());
  traced.took_ns = clock_ns() - start;
  unseal_memory();
  TeamWriter text;
  write_plain(traced, &text);
  if (piece.column_end == session->shape.width) {
    const std::uint32_t rows = piece.row_end - piece.row_begin;
    text.append(row_pixels_.data(), rows * sizeof row_pixels_[0]);
    text.append(packed_rows(*session, piece.row_begin), std::size_t(rows) * line_bytes(*session));
  }
  send_to(team_, 0, kTraced, text.bytes().data(), text.bytes().size());
  return success();
}

}  // namespace pocketray
