#include "remote/client/verify.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "engine/trace_frame.h"
#include "present/pack.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// Assumed cost of a check until one has been timed, relative to a pixel of whole rows, which are traced in packets. A
// guess.
constexpr double kLonePixelFactor = 2;

PixelFormat pixel_format(WireFormat format) { return format == WireFormat::rgb565 ? kRgb565 : kRgb888; }

void write_pixel_text(const std::uint8_t* pixel, WireFormat format, char text[8]) {
  if (format == WireFormat::rgb565)
    std::snprintf(text, 8, "%02x%02x", pixel[1], pixel[0]);
  else
    std::snprintf(text, 8, "%02x%02x%02x", pixel[0], pixel[1], pixel[2]);
}

// Describes a wrong pixel for the log: position, value sent and correct value.
void write_proof(const Client& client, std::uint32_t row, std::uint32_t column, const std::uint8_t* sent,
                 const std::uint8_t* right, char text[160]) {
  char was[8], is[8];
  write_pixel_text(sent, client.options.format, was);
  write_pixel_text(right, client.options.format, is);
  std::snprintf(text, 160, "frame %u, row %u, column %u is %s instead of %s", client.frame.request.frame, row, column,
                was, is);
}

// Number of pixels to check in this frame for `sender_count` servers. A frame with a wrong pixel is checked again.
std::uint32_t due_count(Client* client, std::uint32_t sender_count) {
  Verifier* v = &client->verifier;
  if (v->check_count > 0) return std::max(static_cast<std::uint32_t>(v->check_count), sender_count);
  if (v->frame == client->frame.request.frame) return std::max(v->due_count, sender_count);
  v->frame = client->frame.request.frame;
  double pixel_ns = kLonePixelFactor * device_pixel_ns(*client);
  if (is_known(v->check_ns)) pixel_ns = static_cast<double>(v->check_ns.value);
  pixel_ns += preparing_left_ns(*client);
  double frame_ns = static_cast<double>(client_now_ns(*client) - client->frame.begin_ns);
  // If the pixel cost is unknown because the device renders none, one pixel measures it.
  double paid = pixel_ns > 0 ? kCheckShare * frame_ns / pixel_ns : 1;
  return v->due_count = due_checks(&v->schedule, paid, &v->random);
}

// Appends pixels of the server's rows to v->spans; returns the new count.
std::uint32_t pick_pixels(Client* client, std::uint32_t server, std::uint32_t count, std::uint32_t span_count) {
  Verifier* v = &client->verifier;
  if (count == 0) return span_count;
  std::uint32_t rows = 0, width = client->settings.width;
  for (std::uint32_t row = 0; row < client->picture.merge.rows.count; ++row)
    if (client->picture.merge.rows[row].state == RowState::server && client->picture.merge.rows[row].server == server)
      v->rows[rows++] = static_cast<std::uint16_t>(row);
  CHECK_LE(span_count + count, v->spans.count);
  draw_distinct(&v->random, rows * width, count, v->picks.data);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint16_t column = static_cast<std::uint16_t>(v->picks[i] % width);
    v->spans[span_count++] = {v->rows[v->picks[i] / width], column, static_cast<std::uint16_t>(column + 1)};
  }
  return span_count;
}

// Renders the first `count` pixels of v->spans into v->pixels, in the format of the frame.
struct PixelCheck {
  Renderer* renderer;
  Client* client;
  std::uint32_t count;
};

void render_pixels(Renderer* renderer, Client* client, std::uint32_t count) {
  CHECK(count > 0 && count <= kSpotChecksMax);
  PixelCheck check = {renderer, client, count};
  SpanSource source = {&check};
  source.next = [](void* context, SpanBatch* batch) {
    const PixelCheck& p = *static_cast<PixelCheck*>(context);
    batch->spans = p.client->verifier.spans.data, batch->span_count = p.count;
  };
  source.pack = [](void* context, const SpanBatch& batch) {
    const PixelCheck& p = *static_cast<PixelCheck*>(context);
    const Client& own = *p.client;
    pack_spans(p.renderer->image.data, static_cast<int>(own.settings.width), batch.spans, batch.span_count,
               {own.frame.request.exposure, own.settings.tone}, pixel_format(own.options.format), own.options.dither,
               own.verifier.pixels.data);
  };
  source.finished = [](void* context, const SpanBatch& batch) {
    CHECK_GT(batch.span_count, 0u);
    smooth(&static_cast<PixelCheck*>(context)->client->verifier.check_ns,
           static_cast<double>(batch.took_ns) / batch.span_count);
    return true;
  };
  source.now_ns = [](void* context) { return client_now_ns(*static_cast<PixelCheck*>(context)->client); };
  source.pace = [](void* context, const SpanBatch& batch, std::uint64_t begin_ns) {
    return take_time(static_cast<PixelCheck*>(context)->client, batch.span_count, begin_ns);
  };
  trace_frame(renderer, source);
}

// Returns the index of the first wrong pixel in [begin, end), or `end`.
std::uint32_t find_wrong(const Client& client, std::uint32_t begin, std::uint32_t end) {
  const Verifier& v = client.verifier;
  CHECK(begin <= end && end <= client.verifier.spans.count);
  std::size_t bytes = pixel_bytes(client.options.format);
  std::uint32_t i = begin;
  while (i < end &&
         pixels_close(client.options.format, merged_row(client, v.spans[i].row) + v.spans[i].column_begin * bytes,
                      v.pixels.data + i * bytes, 1, pixel_tolerance(client)))
    ++i;
  return i;
}

void count_checks(Client* client, std::uint32_t server, std::uint32_t rows, std::uint32_t pixels) {
  CHECK_LT(server, client->server_count);
  ServerChecks* checks = &client->servers[server].checks;
  SpotCheck odds;
  odds.rows = rows, odds.width = client->settings.width, odds.wrong_rows = 1, odds.pixels = pixels;
  checks->rows += rows;
  checks->checked += pixels;
  checks->caught_row_last = catch_probability(odds);
  CHECK(checks->caught_row_last >= 0 && checks->caught_row_last <= 1);
  checks->caught_row = either_probability(checks->caught_row, checks->caught_row_last);
  client->share.checked[server] = pixels;
}

// Divides the missing rows among the remaining servers by speed; the device keeps the upper ones.
void share_missing_rows(Client* client) {
  std::uint32_t begin = client->picture.merge.next_row, end = client->settings.height;
  while (end > begin && client->picture.merge.rows[end - 1].state != RowState::missing) --end;
  auto speed_of = [&](std::uint32_t i) {
    const double slowness = server_slowness(client->plan.model.servers[i]);
    bool usable =
        client->servers[i].overture.phase == ServerPhase::ready && !client->servers[i].rows.frame.open && slowness > 0;
    return usable ? 1 / slowness : 0;
  };
  double sum = 1, so_far = 1, rows = end - begin;
  for (std::uint32_t i = 0; i < client->server_count; ++i) sum += speed_of(i);
  std::uint32_t at = begin + static_cast<std::uint32_t>(rows / sum + 0.5);
  for (std::uint32_t i = 0; i < client->server_count && at < end; ++i) {
    if (speed_of(i) == 0) continue;
    so_far += speed_of(i);
    std::uint32_t next = begin + static_cast<std::uint32_t>(rows * std::min(1.0, so_far / sum) + 0.5);
    if (next > at) ask_for_rows(client, &client->servers[i], at, next);
    at = std::max(at, next);
  }
}

// Returns true if no wrong pixel was found.
bool check_pixels(Renderer* renderer, Client* client) {
  Verifier* v = &client->verifier;
  std::uint32_t pixels[kServerCountMax] = {}, counts[kServerCountMax] = {}, ends[kServerCountMax] = {}, senders = 0;
  for (const MergeRow& row : client->picture.merge.rows)
    if (row.state == RowState::server) pixels[row.server] += client->settings.width;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    senders += pixels[i] > 0;
    if (pixels[i] > 0) v->sent_rows[i] = pixels[i] / client->settings.width;
  }
  if (senders == 0) return true;
  std::uint32_t due = std::min(due_count(client, senders), kSpotChecksMax), span_count = 0;
  allot_checks(&v->random, due, pixels, client->server_count, counts);
  for (std::uint32_t i = 0; i < client->server_count; ++i)
    ends[i] = span_count = pick_pixels(client, i, counts[i], span_count);
  if (span_count > 0 && !client->frame.prepared) prepare_device(renderer, client);
  if (span_count > 0) render_pixels(renderer, client, span_count);
  bool honest = true;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    std::uint32_t wrong = find_wrong(*client, ends[i] - counts[i], ends[i]);
    if (wrong == ends[i]) continue;
    honest = false;
    const Span& span = v->spans[wrong];
    std::size_t bytes = pixel_bytes(client->options.format);
    char proof[160];
    write_proof(*client, span.row, span.column_begin, merged_row(*client, span.row) + span.column_begin * bytes,
                v->pixels.data + wrong * bytes, proof);
    drop_liar(client, &client->servers[i], proof);
  }
  if (!honest) share_missing_rows(client);
  for (std::uint32_t i = 0; honest && i < client->server_count; ++i)
    if (pixels[i] > 0) count_checks(client, i, pixels[i] / client->settings.width, counts[i]);
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
  CHECK(check_count == kCheckCountAuto || (check_count >= 0 && check_count <= static_cast<int>(kSpotChecksMax)));
  *v = Verifier();
  v->check_count = check_count;
  std::uint64_t seed[2] = {1, 1};
  if (check_count != 0 && entropy && !entropy(seed, sizeof seed))
    return failure(
        "this system provides no random numbers to choose pixels for checks: use --verify 0 to continue without "
        "checks");
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

void begin_checks(Client* client) {
  for (std::uint32_t i = 0; i < client->server_count; ++i) client->servers[i].witness.is_asked = false;
  client->verifier.is_asking = client->verifier.again = client->verifier.dispute.open = false;
}

bool agrees_with_device(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end) {
  if (client->verifier.check_count == 0 || client->light.by_effect) return true;
  const std::size_t bytes = pixel_bytes(client->options.format);
  for (std::uint32_t row = row_begin; row < row_end; ++row) {
    if (client->picture.merge.rows[row].state != RowState::device) continue;
    const std::uint8_t *right = merged_row(*client, row), *sent = picture_row(server->decoder->state, row);
    const std::uint32_t width = client->settings.width, tolerance = pixel_tolerance(*client);
    if (pixels_close(client->options.format, right, sent, width, tolerance)) continue;
    std::uint32_t column = 0;
    while (pixels_close(client->options.format, right + column * bytes, sent + column * bytes, 1, tolerance)) ++column;
    char proof[160];
    write_proof(*client, row, column, sent + column * bytes, right + column * bytes, proof);
    drop_liar(client, server, proof);
    return false;
  }
  return true;
}

void drop_liar(Client* client, RemoteServer* server, const char* proof) {
  CHECK(proof != nullptr && !server->overture.lied);
  server->overture.told = true;  // the line below gives the reason
  lose_server(client, server, "");
  server->overture.lied = true;
  ++client->share.lies;
  discard_rows(&client->picture.merge, index_of(*client, server));
  if (!client->options.log) return;
  char line[400], before[100] = "";
  if (server->checks.rows > 0)
    std::snprintf(before, sizeof before, "; %llu of its rows in earlier frames may also be wrong",
                  static_cast<unsigned long long>(server->checks.rows));
  std::snprintf(line, sizeof line, "server %s sent wrong pixels and is no longer used: %s%s", server->address.text,
                proof, before);
  client->options.log(client->options.log_context, line);
}

bool is_verified(Renderer* renderer, Client* client) {
  if (client->verifier.check_count == 0 || client->light.by_effect) return true;
  return client->options.has_scene ? check_pixels(renderer, client) : is_witnessed(client);
}

}  // namespace pocketray
