#include "fault_plan.h"
#include "support/link_fault.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "fault_random.h"
#include "remote/client/verify.h"

namespace pocketray {
namespace {

// Thirty times as long as light may take until its server is dropped.
constexpr std::uint64_t kFarLightWaitNs = 60'000'000'000;
constexpr int kSizes[][2] = {{8, 8}, {16, 12}, {8, 40}}, kLargerSizes[][2] = {{12, 60}, {8, 64}, {16, 48}};

// Normalised to a mean of 1, so that all rows together cost what the plan says.
void draw_rows(FaultRandom* random, FaultPlan* plan) {
  static const char* const kNames[] = {"alike", "a cheap sky", "dear at the top", "one dear row", "ragged"};
  std::uint64_t kind = random->below(std::size(kNames));
  plan->rows = kNames[kind];
  std::uint32_t dear_row = static_cast<std::uint32_t>(random->below(plan->height));
  double sum = 0;
  for (std::uint32_t row = 0; row < plan->height; ++row) {
    double down = (row + 0.5) / plan->height, cost = 1;
    if (kind == 1) cost = down < 0.4 ? 0.2 : 2 * down;
    if (kind == 2) cost = 2.2 - 2 * down;
    if (kind == 3) cost = row == dear_row ? 5 : 1;
    if (kind == 4) cost = random->scale(0.25, 4);
    plan->row_costs[row] = static_cast<float>(cost), sum += cost;
  }
  for (std::uint32_t row = 0; row < plan->height; ++row) plan->row_costs[row] *= static_cast<float>(plan->height / sum);
  // Other clients' pictures may be higher.
  for (std::uint32_t row = plan->height; row < kSessionRowsMax; ++row) plan->row_costs[row] = 1;
}

void set_size(FaultPlan* plan, std::uint32_t width, std::uint32_t height) {
  double smaller = double(plan->width * plan->height) / (width * height);
  plan->device_ns *= smaller;
  for (double& ns : plan->server_ns) ns *= smaller;
  plan->width = width, plan->height = height;
}

// Excludes malice that only spot checks reveal.
Malice draw_malice(FaultRandom* random) {
  Malice malice = static_cast<Malice>(1 + random->below(kRowMaliceCount - 2));
  return malice >= Malice::wrong_pixels ? static_cast<Malice>(static_cast<int>(malice) + 1) : malice;
}

}  // namespace

FaultPlan draw_faults(std::uint64_t seed) {
  FaultPlan plan = {};
  plan.seed = seed;
  FaultRandom random = {platform::random_u64(&seed)};
  const int* size = kSizes[random.below(std::size(kSizes))];
  plan.width = static_cast<std::uint32_t>(size[0]), plan.height = static_cast<std::uint32_t>(size[1]);
  plan.server_count = 1 + static_cast<std::uint32_t>(random.below(3));
  plan.format = random.below(2) ? WireFormat::rgb565 : WireFormat::rgb888;
  plan.dither = random.below(2);
  double frame_ns = random.scale(25e6, 400e6);
  plan.device_ns = frame_ns / (plan.width * plan.height);
  for (double& ns : plan.server_ns) ns = plan.device_ns * random.scale(0.02, 2);
  plan.device_share = random.below(4) ? -1 : random.real();
  plan.line.clock_step_ns = 20;
  plan.line.bytes_per_second = random.below(4) ? static_cast<std::uint64_t>(random.scale(100e3, 20e6)) : 0;
  plan.line.latency_ns = random.below(4) ? static_cast<std::uint64_t>(random.scale(1e4, 2e7)) : 0;
  plan.line.jitter_ns = random.below(2) ? static_cast<std::uint64_t>(random.scale(1e3, 5e6)) : 0;
  plan.line.pipe_bytes = 24576;
  plan.line.seed = random.below(1u << 30) + 1;
  plan.line.fault_count = static_cast<int>(random.below(kSessionFaultsMax + 1));
  // Half of them fall within the overture's small messages.
  std::uint64_t byte_count = random.below(2) ? 200 : 30'000;
  draw_link_faults(random.below(~0u), kFaultyConnections, byte_count, plan.faults, plan.line.fault_count);
  plan.event_count = static_cast<int>(random.below(kSessionEventsMax + 1));
  for (int i = 0; i < plan.event_count; ++i) {
    PlannedEvent* e = &plan.events[i];
    e->event = static_cast<ServerEvent>(random.below(3));
    e->server = static_cast<std::uint32_t>(random.below(plan.server_count));
    e->frame = static_cast<int>(random.below(kFaultFrames));
    e->at = e->event == ServerEvent::end || random.below(4) == 0 ? 0 : random.real();
    e->back_frame = e->frame + 1 + static_cast<int>(random.below(4));
  }
  plan.has_scene = true;
  plan.coarse_first = false;
  plan.frames = kFaultFrames;
  plan.split = SplitKind::rows;
  plan.check_count = kCheckCountAuto;
  plan.rows = "alike";
  for (float& cost : plan.row_costs) cost = 1;
  return plan;
}

FaultPlan draw_hostile_faults(std::uint64_t seed) {
  FaultPlan plan = draw_faults(seed);
  std::uint64_t other_seed = seed ^ 0x5DEECE66D;
  FaultRandom random = {platform::random_u64(&other_seed)};
  if (random.below(4) == 0) {
    const int* size = kLargerSizes[random.below(std::size(kLargerSizes))];
    set_size(&plan, static_cast<std::uint32_t>(size[0]), static_cast<std::uint32_t>(size[1]));
  }
  draw_rows(&random, &plan);
  plan.read_ns = random.below(2) ? random.scale(0.1, 10) : 0;
  for (std::uint32_t i = 0; i < plan.server_count; ++i)
    if (random.below(3) == 0) plan.malice[i] = draw_malice(&random);
  if (random.below(8) == 0) {
    plan.neighbour_count = 1 + static_cast<int>(random.below(kNeighboursMax));
    for (int i = 0; i < plan.neighbour_count; ++i)
      plan.neighbours[i] = {static_cast<Nuisance>(random.below(kNuisanceCount)),
                            static_cast<std::uint32_t>(random.below(plan.server_count)),
                            1 + static_cast<int>(random.below(3))};
  }
  plan.has_scene = random.below(6) != 0;
  plan.coarse_first = seed % 2 == 1;
  // A flood refills the link as soon as it is read: the device is nearby.
  bool floods = std::any_of(plan.malice, plan.malice + plan.server_count,
                            [](Malice m) { return m >= Malice::pongs && m <= Malice::repeated_rows; });
  if (floods && random.below(2)) plan.line.bytes_per_second = plan.line.latency_ns = plan.line.jitter_ns = 0;
  // If all pixels of a frame are wrong, one check per server finds the lie before it is shown.
  if (plan.has_scene && random.below(6) == 0) {
    plan.malice[random.below(plan.server_count)] = Malice::wrong_pixels;
    plan.check_count = static_cast<int>(plan.server_count);
  }
  return plan;
}

FaultPlan draw_far_faults(std::uint64_t seed) {
  FaultPlan plan = draw_hostile_faults(seed);
  std::uint64_t other_seed = seed ^ 0x2545F4914F6CDD1D;
  FaultRandom random = {platform::random_u64(&other_seed)};
  plan.line.latency_ns = static_cast<std::uint64_t>(random.scale(2.5e6, 250e6));
  plan.frames = kFarFrames;
  for (PlannedEvent& e : plan.events) {
    e.frame *= kFarFrames / kFaultFrames, e.back_frame *= kFarFrames / kFaultFrames;
  }
  if (!plan.has_scene) return plan;
  const SplitKind kinds[] = {SplitKind::rows,      SplitKind::automatic, SplitKind::automatic,
                             SplitKind::automatic, SplitKind::effect,    SplitKind::effect};
  plan.split = kinds[random.below(std::size(kinds))];
  if (plan.split == SplitKind::rows) return plan;
  plan.device_share = -1;
  // Servers come into use only where the device's frame takes longer than a round trip.
  const double trips = random.scale(0.5, 20), frame_ns = plan.device_ns * plan.width * plan.height;
  const double longer = std::max(1.0, trips * 2 * static_cast<double>(plan.line.latency_ns) / frame_ns);
  plan.device_ns *= longer;
  for (double& ns : plan.server_ns) ns *= longer;
  plan.light_wait_ns = random.below(3) ? 0 : kFarLightWaitNs;
  for (std::uint32_t i = 0; i < plan.server_count; ++i)
    if (random.below(2) == 0) plan.malice[i] = static_cast<Malice>(kRowMaliceCount + random.below(3));
  // Nothing but one server keeps light from coming.
  if (plan.split == SplitKind::effect && plan.server_count > 1 && random.below(2)) {
    plan.line.fault_count = plan.event_count = plan.neighbour_count = 0;
    for (Malice& malice : plan.malice) malice = Malice::none;
    plan.malice[random.below(plan.server_count)] = Malice::no_light;
  }
  return plan;
}

const char* malice_name(Malice malice) {
  static const char* const kNames[kMaliceCount] = {"none",
                                                   "pongs",
                                                   "entries",
                                                   "errors",
                                                   "old rows",
                                                   "wrong pixels",
                                                   "foreign rows",
                                                   "repeated rows",
                                                   "free pixels",
                                                   "dear pixels",
                                                   "any price",
                                                   "another scene",
                                                   "another hello",
                                                   "quick pongs",
                                                   "dawdles",
                                                   "flaps",
                                                   "junk",
                                                   "a device's messages",
                                                   "coarse pictures",
                                                   "no light",
                                                   "other light",
                                                   "held rows"};
  return kNames[static_cast<int>(malice)];
}

const char* nuisance_name(Nuisance nuisance) {
  static const char* const kNames[kNuisanceCount] = {"is silent",   "is idle",     "pings",      "wants frames",
                                                     "wants views", "never reads", "sends junk", "comes and goes"};
  return kNames[static_cast<int>(nuisance)];
}

std::string plan_text(const FaultPlan& plan) {
  char text[400];
  std::snprintf(
      text, sizeof text,
      "%ux%u %s%s, device %.0f ns per pixel, share %.2f, servers %u: %.0f %.0f %.0f, %.0f kB/s, latency %.2f ms, "
      "jitter %.2f ms, rows %s, %.1f ns per byte%s%s%s",
      plan.width, plan.height, plan.format == WireFormat::rgb565 ? "rgb565" : "rgb888", plan.dither ? " dithered" : "",
      plan.device_ns, plan.device_share, plan.server_count, plan.server_ns[0], plan.server_ns[1], plan.server_ns[2],
      static_cast<double>(plan.line.bytes_per_second) / 1e3, static_cast<double>(plan.line.latency_ns) / 1e6,
      static_cast<double>(plan.line.jitter_ns) / 1e6, plan.rows, plan.read_ns,
      plan.has_scene ? "" : ", no scene on the device",
      plan.split == SplitKind::rows     ? ""
      : plan.split == SplitKind::effect ? ", by effect"
                                        : ", by what is faster",
      plan.light_wait_ns > 0 ? ", waits for light" : "");
  std::string all = text;
  for (int i = 0; i < plan.line.fault_count; ++i) {
    const platform::NullFault& f = plan.faults[i];
    std::snprintf(text, sizeof text, "; %s in connection %d at byte %u %s the device", link_fault_name(f.fault),
                  f.connection, static_cast<unsigned>(f.at_byte), f.to_device ? "to" : "from");
    all += text;
  }
  for (int i = 0; i < plan.event_count; ++i) {
    const PlannedEvent& e = plan.events[i];
    static const char* const kNames[] = {"dies", "ends", "freezes"};
    std::snprintf(text, sizeof text, "; server %u %s in frame %d at %.2f, back before %d", e.server,
                  kNames[static_cast<int>(e.event)], e.frame, e.at, e.back_frame);
    all += text;
  }
  for (std::uint32_t i = 0; i < plan.server_count; ++i)
    if (plan.malice[i] != Malice::none)
      all += "; malice of server " + std::to_string(i) + ": " + malice_name(plan.malice[i]);
  for (int i = 0; i < plan.neighbour_count; ++i) {
    const Neighbour& n = plan.neighbours[i];
    all += "; 10.0.0." + std::to_string(n.host) + " at server " + std::to_string(n.server) + " " +
           nuisance_name(n.nuisance);
  }
  return all;
}

}  // namespace pocketray
