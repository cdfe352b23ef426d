#include "fault_session.h"
#include "client_count.h"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include "fault_oracle.h"
#include "fault_world.h"

namespace pocketray {
namespace {

// Limit on a frame's time relative to the device alone; one extra checked pixel is allowed on top.
constexpr double kTimeMax = 1.05;
// Limit for every frame, since kTimeMax holds only once the device has measured single rows: see frames_late. The worst
// of 10^6 frames was 1.25, with 8 rows of which the uppermost costs a quarter of the frame.
constexpr double kTimeLimit = 1.3;
// Of frames by effect, which wait for light as long as their rows took, and add it.
constexpr double kEffectTimeMax = 2 * kTimeLimit;
// Without light from an honest server that nothing disturbs: until another has been given up, and with a wait of that
// other's return.
constexpr std::uint64_t kUnlitNsMax = 8 * kSilenceNs;
// When a lie is found, the liar's rows are rendered again.
constexpr double kLieTimeMax = 2 * kTimeLimit;
constexpr double kSettledMax = 1.5;  // relative to the best split, plus two rows that the device begins in vain
constexpr std::uint64_t kThinTroublesNs = 200'000 * kMs;
constexpr int kSettleFrames = 12, kJudgedFrames = 5;
constexpr std::uint64_t kSettlePauseNs = 600 * kMs;  // between them, as links are measured again every few seconds
// Time to notice a lost connection, free its place at the server, reconnect and finish the overture.
constexpr std::uint64_t kReturnNsMax = kSilenceNs + kServerIdleNs + 2 * kRetryMaxNs + 3 * kSilenceNs;
// Without the scene: time without a row, plus the next poll.
constexpr std::uint64_t kCutOffNsMax = 5'000 * kMs + 3 * kSilenceNs;

std::string fail(const FaultWorld& w, const std::string& what, double value = 0) {
  char text[60];
  std::snprintf(text, sizeof text, " (%.4g)", value);
  return "frame " + std::to_string(w.frame) + ": " + what + text;
}

std::string phases(const FaultWorld& w) {
  std::string text;
  for (std::uint32_t i = 0; i < w.plan.server_count; ++i)
    text += std::string(i ? ", " : "") + phase_text(w.client.servers[i].overture.phase);
  for (const std::string& line : w.log) text += "\n    " + line;
  return text;
}

// A frame by rows is the device's own. In one by effect, an honest server's rows are the same, and the device's have
// its own light; or any that servers send, which never takes light away.
bool is_right(const FaultWorld& w, int second) {
  const std::vector<std::uint8_t>& expected = device_picture(w.plan, second);
  const Array<std::uint8_t>& pixels = w.client.picture.pixels;
  const FrameShare& share = w.client.share;
  if (!share.by_effect) return std::equal(pixels.begin(), pixels.end(), expected.begin(), expected.end());
  const std::vector<std::uint8_t>&own = device_picture(w.plan, second, Lighting::own),
        &direct = device_picture(w.plan, second, Lighting::direct);
  const std::size_t row_bytes = pixels.count / w.plan.height;
  for (std::uint32_t row = 0; row < w.plan.height; ++row) {
    const MergeRow& merged = w.client.picture.merge.rows[row];
    const std::size_t begin = row * row_bytes;
    auto equals = [&](const std::vector<std::uint8_t>& right) {
      return std::equal(pixels.begin() + begin, pixels.begin() + begin + row_bytes,
                        right.begin() + static_cast<std::ptrdiff_t>(begin));
    };
    if (merged.state == RowState::server) {
      if (w.plan.malice[merged.server] == Malice::none && !equals(expected)) return false;
    } else if (!share.has_light) {
      if (!equals(own)) return false;
    } else if (w.plan.format == WireFormat::rgb888 && !w.plan.dither) {
      for (std::size_t i = begin; i < begin + row_bytes; i += 3)  // of a bright pixel other channels may lose
        if (*std::max_element(&pixels[static_cast<std::uint32_t>(i)], &pixels[static_cast<std::uint32_t>(i)] + 3) <
            *std::max_element(&direct[i], &direct[i] + 3))
          return false;
    }
  }
  return true;
}

// Whether light has not come for long though a server that nothing disturbs could send it.
bool is_left_dark(const FaultWorld& w) {
  const FaultPlan& plan = w.plan;
  if (plan.split != SplitKind::effect || w.peace || w.faults_struck > 0 || plan.neighbour_count > 0) return false;
  if (w.elapsed() - w.lit_ns < kUnlitNsMax + 40 * plan.line.latency_ns + 4 * w.local_ns) return false;
  for (std::uint32_t i = 0; i < plan.server_count; ++i) {
    bool is_good = plan.malice[i] == Malice::none && w.client.servers[i].overture.phase >= ServerPhase::probing;
    for (int k = 0; k < plan.event_count; ++k) is_good = is_good && plan.events[k].server != i;
    if (is_good) return true;
  }
  return false;
}

void begin_frame(FaultWorld* w) {
  w->disturbed = w->stuck = false;
  look_for_events(true);
  w->frame_begin_ns = w->elapsed();
  w->lost_ns = 0;
}

// Honest servers are never taken for liars, and liars are never used again.
std::string check_lies(const FaultWorld& w, SessionResult* result) {
  result->lies += static_cast<int>(w.client.share.lies);
  for (std::uint32_t i = 0; i < w.plan.server_count; ++i) {
    const RemoteServer& s = w.client.servers[i];
    if (s.overture.lied && w.plan.malice[i] == Malice::none) return fail(w, "an honest server is taken for a liar");
    if (s.overture.lied && (s.overture.phase != ServerPhase::waiting || w.client.share.server_rows[i] > 0))
      return fail(w, "a liar is used again");
  }
  return "";
}

// One frame, compared with the device's own picture and time, excluding only what the device cannot know of. `ratio`:
// the frame's time relative to that.
std::string run_frame(FaultWorld* w, SessionResult* result) {
  const FaultPlan& plan = w->plan;
  int second = w->frame % static_cast<int>(std::size(kFaultSeconds));
  std::size_t lines_before = w->log.size();
  device_picture(plan, second);
  begin_frame(w);
  bool complete = false;
  if (!render_frame(device_renderer(plan), &w->client, kFaultSeconds[second], nullptr, &complete).ok || !complete)
    return fail(*w, "is not complete");
  double ns = static_cast<double>(w->elapsed() - w->frame_begin_ns);
  note_faults();
  if (!is_right(*w, second)) return fail(*w, "is not the device's own");
  const FrameShare& share = w->client.share;
  result->by_effect += share.by_effect, result->lit += share.has_light;
  if (share.has_light) w->lit_ns = w->elapsed();
  if (is_left_dark(*w)) return fail(*w, "has no server's light, as those before: " + phases(*w));
  bool calm = !w->disturbed && (w->disturbed_ns == 0 || w->frame_begin_ns > w->disturbed_ns + kSilenceNs);
  double ratio = (ns - static_cast<double>(w->lost_ns)) / static_cast<double>(w->local_ns);
  ++result->frames, result->frames_disturbed += !calm;
  if (w->stuck) return fail(*w, "a server holds the device", ratio);
  std::string failure = check_lies(*w, result);
  if (!failure.empty()) return failure;
  const CoherenceState& state = device_renderer(plan)->history.state;
  auto keeps = [](const RowModel& row) { return row.holder != kNoHolder && row.holder_part < 1; };
  result->unchanged += w->client.share.unchanged;
  result->device_kept += !state.whole_because && state.pixels_traced < plan.width * w->client.share.device_rows;
  result->server_kept += std::any_of(w->client.plan.model.rows.begin(), w->client.plan.model.rows.end(), keeps);
  bool lies = w->client.share.lies > 0;
  double* worst = calm ? &result->worst_calm : &result->worst_disturbed;
  if (!lies && !share.by_effect) *worst = std::max(*worst, ratio);
  double check_pixels = std::max(1, plan.check_count);
  if (share.by_effect) {
    if (ratio > kEffectTimeMax + light_wait_max_ns(plan) / static_cast<double>(w->local_ns))
      return fail(*w, "waits long for light", ratio);
  } else {
    result->frames_late += !lies && ratio > kTimeMax + check_pixels / (plan.width * plan.height);
    if (ratio > (lies ? kLieTimeMax : kTimeLimit)) return fail(*w, "is late", ratio);
  }
  if (w->log.size() > lines_before + 4 * plan.server_count + w->client.share.lies)
    return fail(*w, "is reported too often");
  return "";
}

// The same without the scene: takes as long as the servers do, and ends when no rows have come for long.
std::string run_thin_frame(FaultWorld* w, SessionResult* result) {
  int second = w->frame % static_cast<int>(std::size(kFaultSeconds));
  device_picture(w->plan, second);
  Renderer* renderer = device_renderer(w->plan);
  Client* c = &w->client;
  begin_frame(w);
  if (!begin_frame(renderer, c, kFaultSeconds[second]).ok) return fail(*w, "does not begin");
  std::uint64_t rows_come_ns = w->elapsed();
  std::uint32_t rows = 0;
  while (!advance_frame(renderer, c, client_now_ns(*c) + 20 * kMs, nullptr)) {
    if (w->stuck) return fail(*w, "a server holds the device");
    if (c->picture.merge.row_count_done != rows) rows = c->picture.merge.row_count_done, rows_come_ns = w->elapsed();
    if (is_cut_off(*c)) break;
    if (w->elapsed() - rows_come_ns > kCutOffNsMax + w->lost_ns) return fail(*w, "never gives up: " + phases(*w));
  }
  note_faults();
  ++result->frames, ++result->frames_disturbed;
  if (has_all_rows(*c) && !is_right(*w, second)) return fail(*w, "is not as servers render it");
  if (w->peace && !has_all_rows(*c)) return fail(*w, "is not complete: " + phases(*w));
  return "";
}

std::string run_any_frame(FaultWorld* w, SessionResult* result) {
  return w->plan.has_scene ? run_frame(w, result) : run_thin_frame(w, result);
}

// The most expensive row's cost in average pixels.
double dearest_row(const FaultPlan& plan) {
  return *std::max_element(plan.row_costs, plan.row_costs + plan.height) * static_cast<double>(plan.width);
}

// Idles between two frames.
void let_client_rest(FaultWorld* w, std::uint64_t ns) {
  for (std::uint64_t until = w->elapsed() + ns; w->elapsed() < until;) advance_client(&w->client, until - w->elapsed());
}

// True if a server is in use. One whose first rows take most of a frame takes no part: it is asked in every frame, but
// its rows come too late.
bool is_back(const FaultWorld& w, std::uint32_t i) {
  const FaultPlan& plan = w.plan;
  if (w.client.servers[i].overture.lied) return true;  // it stays out
  ServerPhase phase = w.client.servers[i].overture.phase;
  if (plan.split == SplitKind::effect) return phase >= ServerPhase::probing;  // of several, one is asked for light
  double rows_ns = 2 * static_cast<double>(plan.line.latency_ns + plan.line.jitter_ns) +
                   plan.server_count * (4 * plan.server_ns[i] * dearest_row(plan) + 2e6);
  return phase == ServerPhase::ready || (phase == ServerPhase::probing && rows_ns > w.client.share.measured_ns / 4);
}

// Log lines alternate: lost, in use again; a liar's last line says so.
std::string check_log(const FaultWorld& w, SessionResult* result) {
  for (std::uint32_t i = 0; i < w.plan.server_count; ++i) {
    bool lost = false, lied = false;
    for (const std::string& line : w.log) {
      if (line.find(w.places[i].address.text) == std::string::npos) continue;
      if (lied) return fail(w, "is reported after it was dropped: " + line);
      lied = line.find("wrong pixels") != std::string::npos;
      bool back = line.find("in use again") != std::string::npos;
      if (back != lost && !lied) return fail(w, "is reported out of order: " + line);
      lost = !back;
      result->losses += lost;
    }
    // Without the scene, some servers get no rows of a small picture and are not in use.
    bool used = w.plan.has_scene || w.client.share.server_rows[i] > 0;
    if (lost && used && w.client.servers[i].overture.phase == ServerPhase::ready)
      return fail(w, "a server that is back is not reported so");
  }
  return "";
}

std::string run_troubles(FaultWorld* w, SessionResult* result) {
  const FaultPlan& plan = w->plan;
  // Without the scene, each frame that no server renders takes seconds.
  for (w->frame = 0; w->frame < plan.frames && (plan.has_scene || w->elapsed() < kThinTroublesNs); ++w->frame) {
    for (int i = 0; i < plan.event_count; ++i)
      if (w->done[i] && plan.events[i].back_frame == w->frame) bring_back(plan.events[i].server);
    std::string failure = run_any_frame(w, result);
    if (!failure.empty()) return failure;
    if (w->frame % 3 == 2) advance_client(&w->client, w->local_ns);
  }
  return "";
}

// All servers are back within a bounded time.
std::string run_return(FaultWorld* w, SessionResult* result) {
  auto all_ready = [&] {
    for (std::uint32_t i = 0; i < w->plan.server_count; ++i)
      if (!is_back(*w, i)) return false;
    return true;
  };
  std::uint64_t begin = w->elapsed();
  // Long enough to notice dead connections.
  std::uint64_t quiet_ns = kSilenceNs + 600 * kMs;
  while (!all_ready() || w->elapsed() - begin < quiet_ns) {
    if (!all_ready() && w->elapsed() - begin > kReturnNsMax + 10 * w->local_ns + 200 * w->plan.line.latency_ns)
      return fail(*w, "not all servers are in use again: " + phases(*w));
    std::string failure = run_any_frame(w, result);
    if (!failure.empty()) return failure;
    ++w->frame;
    let_client_rest(w, 100 * kMs);
    if (!all_ready()) result->return_ns = w->elapsed() - begin;
  }
  return "";
}

// Frame time relative to the best split, for the best of some frames, as a link may be under measurement.
std::string run_settled(FaultWorld* w, SessionResult* result) {
  if (!w->plan.has_scene || w->plan.device_share >= 0 || w->plan.frames > kFaultFrames) return "";
  std::vector<double> times;
  for (int i = 0; i < kSettleFrames + kJudgedFrames; ++i, ++w->frame) {
    std::string failure = run_any_frame(w, result);
    if (!failure.empty()) return failure;
    if (!w->client.share.unchanged) times.push_back(static_cast<double>(w->elapsed() - w->frame_begin_ns));
    let_client_rest(w, kSettlePauseNs);
  }
  if (times.empty()) return "";
  auto judged = times.end() - std::min<std::ptrdiff_t>(times.end() - times.begin(), kJudgedFrames);
  double ns = *std::min_element(judged, times.end());
  double best = best_frame_ns(w->plan, w->client), ratio = ns / best;
  result->worst_settled = std::max(result->worst_settled, ratio);
  result->far_from_best = ns > kSettledMax * best + 2 * dearest_row(w->plan) * w->plan.device_ns;
  return "";
}

}  // namespace

SessionResult run_fault_session(const FaultPlan& plan) {
  SessionResult result;
  FaultWorld w;
  open_fault_world(plan, &w);
  result.failure = run_troubles(&w, &result);
  make_peace();
  if (result.failure.empty()) result.failure = run_return(&w, &result);
  if (result.failure.empty()) result.failure = run_settled(&w, &result);
  if (result.failure.empty()) result.failure = check_log(w, &result);
  result.faults_struck = w.faults_struck;
  for (int i = 0; i < plan.line.fault_count; ++i) ++result.struck[static_cast<int>(plan.faults[i].fault)];

  // No server keeps a departed client.
  close_client(&w.client);
  let_pass(kServerIdleNs + kSilenceNs + 200 * kMs);
  for (std::uint32_t i = 0; i < plan.server_count; ++i)
    if (result.failure.empty() && client_count(*w.places[i].server) > 0)
      result.failure = fail(w, "leaves a session behind");
  close_fault_world(&w);
  return result;
}

}  // namespace pocketray
