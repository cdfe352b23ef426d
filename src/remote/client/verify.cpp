#include "remote/client/verify.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "engine/trace_frame.h"
#include "present/pack.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// What a check is taken to cost until one has been timed, in pixels of whole rows, whose rays are traced in packets. A
// guess.
constexpr double kLonePixelFactor = 2;

PixelFormat pixel_format(WireFormat format) { return format == WireFormat::rgb565 ? kRgb565 : kRgb888; }

void write_pixel_text(const std::uint8_t* pixel, WireFormat format, char text[8]) {
  if (format == WireFormat::rgb565)
    std::snprintf(text, 8, "%02x%02x", pixel[1], pixel[0]);
  else
    std::snprintf(text, 8, "%02x%02x%02x", pixel[0], pixel[1], pixel[2]);
}

// What proves the lie, for the log: where, what was sent and what is right.
void write_proof(const Client& c, std::uint32_t row, std::uint32_t column, const std::uint8_t* sent,
                 const std::uint8_t* right, char text[160]) {
  char was[8], is[8];
  write_pixel_text(sent, c.options.format, was);
  write_pixel_text(right, c.options.format, is);
  std::snprintf(text, 160, "frame %u, row %u, column %u is %s where %s is right", c.request.frame, row, column, was,
                is);
}

// Pixels that are due in this frame, of so many servers. The frame is checked again where a lie was found in it.
std::uint32_t due_count(Client* c, std::uint32_t sender_count) {
  Verifier* v = &c->verifier;
  if (v->check_count > 0) return std::max(static_cast<std::uint32_t>(v->check_count), sender_count);
  if (v->frame == c->request.frame) return std::max(v->due_count, sender_count);
  v->frame = c->request.frame;
  double pixel_ns = kLonePixelFactor * device_pixel_ns(*c);
  if (is_known(v->check_ns)) pixel_ns = static_cast<double>(v->check_ns.value);
  double frame_ns = static_cast<double>(client_now_ns(*c) - c->begin_ns);
  // What a pixel costs is not known where the device renders none: then one tells.
  double paid = pixel_ns > 0 ? kCheckShare * frame_ns / pixel_ns : 1;
  return v->due_count = due_checks(&v->schedule, paid, &v->random);
}

// Appends pixels of the server's rows to v->spans; returns how many there are then.
std::uint32_t pick_pixels(Client* c, std::uint32_t server, std::uint32_t count, std::uint32_t span_count) {
  Verifier* v = &c->verifier;
  if (count == 0) return span_count;
  std::uint32_t rows = 0, width = c->settings.width;
  for (std::uint32_t row = 0; row < c->merge.rows.count; ++row)
    if (c->merge.rows[row].state == RowState::server && c->merge.rows[row].server == server)
      v->rows[rows++] = static_cast<std::uint16_t>(row);
  draw_distinct(&v->random, rows * width, count, v->picks.data);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint16_t column = static_cast<std::uint16_t>(v->picks[i] % width);
    v->spans[span_count++] = {v->rows[v->picks[i] / width], column, static_cast<std::uint16_t>(column + 1)};
  }
  return span_count;
}

// Renders the first `count` pixels of v->spans into v->pixels, as the frame has them.
struct PixelCheck {
  Renderer* renderer;
  Client* client;
  std::uint32_t count;
};

void render_pixels(Renderer* r, Client* c, std::uint32_t count) {
  PixelCheck check = {r, c, count};
  SpanSource source = {&check};
  source.next = [](void* context, SpanBatch* batch) {
    const PixelCheck& p = *static_cast<PixelCheck*>(context);
    batch->spans = p.client->verifier.spans.data, batch->span_count = p.count;
  };
  source.pack = [](void* context, const SpanBatch& batch) {
    const PixelCheck& p = *static_cast<PixelCheck*>(context);
    const Client& own = *p.client;
    pack_spans(p.renderer->image.data, static_cast<int>(own.settings.width), batch.spans, batch.span_count,
               own.request.exposure, pixel_format(own.options.format), own.options.dither, own.verifier.pixels.data);
  };
  source.finished = [](void* context, const SpanBatch& batch) {
    smooth(&static_cast<PixelCheck*>(context)->client->verifier.check_ns,
           static_cast<double>(batch.took_ns) / batch.span_count);
    return true;
  };
  source.now_ns = [](void* context) { return client_now_ns(*static_cast<PixelCheck*>(context)->client); };
  source.pace = [](void* context, const SpanBatch& batch, std::uint64_t begin_ns) {
    return take_time(static_cast<PixelCheck*>(context)->client, batch.span_count, begin_ns);
  };
  trace_frame(r, source);
}

// The first of these pixels that the server sent wrong, or `end`.
std::uint32_t find_wrong(const Client& c, std::uint32_t begin, std::uint32_t end) {
  const Verifier& v = c.verifier;
  std::size_t bytes = pixel_bytes(c.options.format);
  std::uint32_t i = begin;
  while (i < end && std::memcmp(shared_row(c, v.spans[i].row) + v.spans[i].column_begin * bytes,
                                v.pixels.data + i * bytes, bytes) == 0)
    ++i;
  return i;
}

void count_checks(Client* c, std::uint32_t server, std::uint32_t rows, std::uint32_t pixels) {
  ServerChecks* checks = &c->servers[server].checks;
  SpotCheck odds;
  odds.rows = rows, odds.width = c->settings.width, odds.wrong_rows = 1, odds.pixels = pixels;
  checks->rows += rows;
  checks->checked += pixels;
  checks->caught_row_last = catch_probability(odds);
  checks->caught_row = either_probability(checks->caught_row, checks->caught_row_last);
  c->share.checked[server] = pixels;
}

// Servers that are left get parts of the missing rows by their speed, the device keeps the upper ones.
void share_missing_rows(Client* c) {
  std::uint32_t begin = c->merge.next_row, end = c->settings.height;
  while (end > begin && c->merge.rows[end - 1].state != RowState::missing) --end;
  auto speed_of = [&](std::uint32_t i) {
    const Smoothed& speed = c->model.servers[i].speed;  // its time over the device's
    bool usable = c->servers[i].phase == ServerPhase::ready && !c->servers[i].frame.open && is_known(speed);
    return usable ? 1 / static_cast<double>(speed.value) : 0;
  };
  double sum = 1, so_far = 1, rows = end - begin;
  for (std::uint32_t i = 0; i < c->server_count; ++i) sum += speed_of(i);
  std::uint32_t at = begin + static_cast<std::uint32_t>(rows / sum + 0.5);
  for (std::uint32_t i = 0; i < c->server_count && at < end; ++i) {
    if (speed_of(i) == 0) continue;
    so_far += speed_of(i);
    std::uint32_t next = begin + static_cast<std::uint32_t>(rows * std::min(1.0, so_far / sum) + 0.5);
    if (next > at) ask_for_rows(c, &c->servers[i], at, next);
    at = std::max(at, next);
  }
}

// True: no lie was found.
bool check_pixels(Renderer* r, Client* c) {
  Verifier* v = &c->verifier;
  std::uint32_t pixels[kServerCountMax] = {}, counts[kServerCountMax] = {}, ends[kServerCountMax] = {}, senders = 0;
  for (const MergeRow& row : c->merge.rows)
    if (row.state == RowState::server) pixels[row.server] += c->settings.width;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    senders += pixels[i] > 0;
    if (pixels[i] > 0) v->sent_rows[i] = pixels[i] / c->settings.width;
  }
  if (senders == 0) return true;
  std::uint32_t due = std::min(due_count(c, senders), kSpotChecksMax), span_count = 0;
  allot_checks(&v->random, due, pixels, c->server_count, counts);
  for (std::uint32_t i = 0; i < c->server_count; ++i) ends[i] = span_count = pick_pixels(c, i, counts[i], span_count);
  if (span_count > 0) render_pixels(r, c, span_count);
  bool honest = true;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    std::uint32_t wrong = find_wrong(*c, ends[i] - counts[i], ends[i]);
    if (wrong == ends[i]) continue;
    honest = false;
    const Span& span = v->spans[wrong];
    std::size_t bytes = pixel_bytes(c->options.format);
    char proof[160];
    write_proof(*c, span.row, span.column_begin, shared_row(*c, span.row) + span.column_begin * bytes,
                v->pixels.data + wrong * bytes, proof);
    drop_liar(c, &c->servers[i], proof);
  }
  if (!honest) share_missing_rows(c);
  for (std::uint32_t i = 0; honest && i < c->server_count; ++i)
    if (pixels[i] > 0) count_checks(c, i, pixels[i] / c->settings.width, counts[i]);
  return honest;
}

}  // namespace

std::size_t verifier_need(const Settings& settings) {
  return arena_need<std::uint16_t>(settings.height) + arena_need<std::uint32_t>(kSpotChecksMax) +
         arena_need<Span>(kSpotChecksMax) + arena_need(kSpotChecksMax * pixel_bytes(WireFormat::rgb888)) +
         2 * arena_need(settings.width * pixel_bytes(WireFormat::rgb888));
}

Status make_verifier(int check_count, bool (*entropy)(void*, std::size_t), const Settings& settings, Arena* arena,
                     Verifier* v) {
  *v = Verifier();
  v->check_count = check_count;
  std::uint64_t seed[2] = {1, 1};
  if (check_count != 0 && entropy && !entropy(seed, sizeof seed))
    return failure(
        "this system gives no random numbers, by which pixels of servers are checked: --verify 0 goes on unchecked");
  v->random = make_rng(seed[0], seed[1]);
  v->schedule = make_check_schedule(&v->random);
  v->rows = arena_array<std::uint16_t>(arena, settings.height);
  v->picks = arena_array<std::uint32_t>(arena, kSpotChecksMax);
  v->spans = arena_array<Span>(arena, kSpotChecksMax);
  v->pixels = arena_array<std::uint8_t>(arena, kSpotChecksMax * pixel_bytes(WireFormat::rgb888));
  for (Array<std::uint8_t>& version : v->versions)
    version = arena_array<std::uint8_t>(arena, settings.width * pixel_bytes(WireFormat::rgb888));
  return success();
}

void begin_checks(Client* c) {
  for (std::uint32_t i = 0; i < c->server_count; ++i) c->servers[i].is_witness = false;
  c->verifier.is_asking = c->verifier.again = c->verifier.dispute.open = false;
}

bool agrees_with_device(Client* c, RemoteServer* s, std::uint32_t row_begin, std::uint32_t row_end) {
  if (c->verifier.check_count == 0) return true;
  std::size_t bytes = pixel_bytes(c->options.format), row_bytes = c->settings.width * bytes;
  for (std::uint32_t row = row_begin; row < row_end; ++row) {
    if (c->merge.rows[row].state != RowState::device) continue;
    const std::uint8_t *right = shared_row(*c, row), *sent = picture_row(s->decoder->state, row);
    if (std::memcmp(right, sent, row_bytes) == 0) continue;
    std::uint32_t column = 0;
    while (std::memcmp(right + column * bytes, sent + column * bytes, bytes) == 0) ++column;
    char proof[160];
    write_proof(*c, row, column, sent + column * bytes, right + column * bytes, proof);
    drop_liar(c, s, proof);
    return false;
  }
  return true;
}

void drop_liar(Client* c, RemoteServer* s, const char* proof) {
  s->told = true;  // why it is lost, here
  lose_server(c, s, "");
  s->lied = true;
  ++c->share.lies;
  discard_rows(&c->merge, index_of(*c, s));
  if (!c->options.log) return;
  char line[400], before[100] = "";
  if (s->checks.rows > 0)
    std::snprintf(before, sizeof before, "; %llu rows of earlier frames are its and may be wrong, too",
                  static_cast<unsigned long long>(s->checks.rows));
  std::snprintf(line, sizeof line, "server %s sends wrong pixels and is not used any more: %s%s", s->address.text,
                proof, before);
  c->options.log(c->options.log_context, line);
}

bool is_verified(Renderer* r, Client* c) {
  if (c->verifier.check_count == 0) return true;
  return c->options.has_scene ? check_pixels(r, c) : is_witnessed(c);
}

}  // namespace pocketray
