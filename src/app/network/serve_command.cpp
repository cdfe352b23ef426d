// pocketray serve: the render server.
#include <algorithm>
#include <cinttypes>
#include <thread>

#include "app/network/network_commands.h"
#include "app/options.h"
#include "base/isa.h"
#include "base/seal.h"
#include "platform/cpu_time.h"
#include "platform/net/descriptors.h"
#include "platform/net/tcp.h"
#include "platform/standard_streams.h"
#include "remote/encryption.h"
#include "remote/server/server.h"
#include "session/interrupt.h"
#include "session/note.h"
#include "session/report.h"

namespace pocketray {
namespace {

struct ServeOptions {
  std::string listen = "127.0.0.1:7411", key, scenes, memory = "64M", scene_memory = "1G", coherence = "auto", isa;
  int clients = 8;
  std::uint32_t threads = 0, image_side_max = 2048;
  double idle_seconds = 300;
  bool insecure_lan = false;
  Team team;
};

struct Serving {
  SceneStore store;
  std::vector<std::max_align_t> tcp_memory, tls_memory;
  platform::Link *tcp = nullptr, *link = nullptr;  // link: tcp, or the encrypted link over it
  Server* server = nullptr;
  Serving() = default;
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  ~Serving() {
    unseal_memory();
    close_server(server);
    if (link && link != tcp) link->backend->close_all(link);
    if (tcp) tcp->backend->close_all(tcp);
  }
};

// A log reader that hangs or exits must not affect clients.
void print_line(void*, const char* line) { (void)platform::print_line_at_once(line); }

// Fits the number of streams to the limit on open files; fails if that limit is too low.
Status plan_streams(ServerOptions* options) {
  constexpr int kOtherFiles = 4;  // the listener's spare, a scene being read, files that the C library opens
  int wanted = server_stream_count(*options) + kOtherFiles, left = platform::descriptors_left(wanted);
  if (left >= wanted) return success();
  int own = server_stream_count(*options) - options->client_count_max - options->guest_count_max + kOtherFiles;
  int client_count = options->client_count_max;
  options->guest_count_max = std::max(1, std::min((left - own) / 3, options->guest_count_max));
  options->client_count_max = std::min(left - own - options->guest_count_max, client_count);
  if (options->client_count_max < 1)
    return failure("this program may open only %d more files and needs %d to serve one client: raise `ulimit -n` by %d",
                   left, own + 2, own + 2 - left);
  if (options->client_count_max < client_count)
    print_note("the limit on open files allows " + std::to_string(options->client_count_max) + " clients, not " +
               std::to_string(client_count) + ": raise it with `ulimit -n`");
  return success();
}

Status find_address(const ServeOptions& o, platform::LinkAddress* address) {
  platform::Error error;
  if (!platform::kTcpLink.resolve(o.listen.c_str(), address, &error)) return failure("--listen: %s", error.text);
  if (address->loopback || o.insecure_lan || !o.key.empty()) return success();
  return failure(
      "--listen %.60s: other machines can reach it and there is no authentication: add --key (`pocketray keygen`), or "
      "--insecure-lan",
      o.listen.c_str());
}

Status read_options(const ServeOptions& o, ServerOptions* options) {
  RETURN_IF_ERROR(parse_bytes(o.memory, &options->client_memory_bytes));
  RETURN_IF_ERROR(choose_thread_count(team_threads(o.team, o.threads), std::thread::hardware_concurrency(),
                                      &options->thread_count));
  RETURN_IF_ERROR(parse_coherence(o.coherence, &options->coherence));
  options->client_count_max = o.clients;
  options->image_side_max = o.image_side_max;
  if (!(o.idle_seconds >= 1 && o.idle_seconds <= 1e6))
    return failure("--idle is %g: it must lie in 1 … 1000000 seconds", o.idle_seconds);
  options->idle_timeout_ns = static_cast<std::uint64_t>(o.idle_seconds * 1e9);
  options->log = print_line;
  Isa isa;
  RETURN_IF_ERROR(parse_isa(o.isa, &isa));
  select_isa(isa);
  return success();
}

Status open_link(const ServeOptions& o, int stream_count, Serving* serving) {
  auto options_in = [&](std::vector<std::max_align_t>* memory, std::size_t byte_count) {
    memory->resize(byte_count / sizeof(std::max_align_t) + 1);
    platform::LinkOptions options;
    options.memory = memory->data(), options.memory_bytes = memory->size() * sizeof(std::max_align_t);
    options.stream_count_max = stream_count;
    options.now_ns = clock_ns;
    return options;
  };
  platform::SharedKey key;
  if (!o.key.empty()) RETURN_IF_ERROR(read_key(o.key, &key));
  platform::Error error;
  serving->tcp = serving->link =
      platform::kTcpLink.open(options_in(&serving->tcp_memory, platform::kTcpLink.need(stream_count)), &error);
  if (serving->tcp && !o.key.empty())
    serving->link = open_encrypted_link(
        serving->tcp, options_in(&serving->tls_memory, encrypted_link_need(stream_count)), key, &error);
  platform::wipe(&key, sizeof key);
  return serving->link ? success() : failure("%s", error.text);
}

Status read_cluster_options(const ServeOptions& o, ClusterOptions* options) {
  RETURN_IF_ERROR(read_options(o, &options->server));
  std::size_t scene_bytes;
  RETURN_IF_ERROR(parse_bytes(o.scene_memory, &scene_bytes, "--scene-memory"));
  options->scene_bytes_max = scene_bytes;
  const ServerOptions& server = options->server;
  char text[160];
  std::snprintf(text, sizeof text, "%d %zu %zu %zu %d %u %d", static_cast<int>(kWireVersion), sizeof(FrameRequest),
                server.client_memory_bytes, scene_bytes, server.client_count_max, server.image_side_max,
                static_cast<int>(server.coherence));
  options->identity = text;
  return success();
}

Status start(const ServeOptions& o, const ServeCluster& cluster, const SceneStoreOptions& store_options,
             Serving* serving, ServerOptions* options) {
  platform::LinkAddress address;
  RETURN_IF_ERROR(find_address(o, &address));
  RETURN_IF_ERROR(plan_streams(options));
  RETURN_IF_ERROR(open_link(o, server_stream_count(*options), serving));
  // Binds the address first, so that one already in use is reported before the slow reading of scenes.
  RETURN_IF_ERROR(open_server(*options, serving->store, serving->link, address, &serving->server));
  RETURN_IF_ERROR(open_scene_store(store_options, &serving->store));
  for (const std::string& warning : serving->store.warnings) print_note(warning);
  return cluster.welcome ? cluster.welcome(serving->store) : success();
}

std::string threads_of(const ServeCluster& cluster, const ServerOptions& options) {
  const std::uint32_t count = cluster.thread_count ? cluster.thread_count() : options.thread_count;
  const std::string threads = std::to_string(count) + (count == 1 ? " thread" : " threads");
  return cluster.helpers ? std::to_string(cluster.rank_count) + " ranks with " + threads : threads;
}

void print_start(const ServeOptions& o, const ServeCluster& cluster, const Serving& serving,
                 const ServerOptions& options) {
  for (const StoredScene& scene : serving.store.scenes)
    std::printf("  %-24s %9s triangles %8.1f MiB\n", scene.name, grouped(scene.scene.triangles.count).c_str(),
                static_cast<double>(scene.byte_count) / (1 << 20));
  if (!o.key.empty())
    std::printf("  only for holders of the key in %s, encrypted; %.1f MiB for that\n", shown(o.key).c_str(),
                static_cast<double>(encrypted_link_need(server_stream_count(options))) / (1 << 20));
  std::printf("listening on %s: %zu scenes, %s, %d clients of %.0f MiB each; Ctrl-C stops it\n",
              server_address(*serving.server), serving.store.scenes.size(), threads_of(cluster, options).c_str(),
              options.client_count_max, static_cast<double>(options.client_memory_bytes) / (1 << 20));
  std::fflush(stdout);
}

void print_totals(const ServerTotals& totals, const ServeCluster& cluster) {
  char line[200];
  int length = std::snprintf(line, sizeof line, "%" PRIu64 " clients, %s frames, %s rows, %.1f MiB sent",
                             totals.client_count, grouped(totals.frame_count).c_str(),
                             grouped(totals.row_count).c_str(), static_cast<double>(totals.byte_count) / (1 << 20));
  if (cluster.helped_share)
    std::snprintf(line + length, sizeof line - static_cast<std::size_t>(length),
                  "; ranks besides 0 traced %.0f %% of the pixels", 100 * cluster.helped_share());
  (void)platform::print_line_at_once(line);
}

// Serves until an interrupt; on several ranks, runs on rank 0.
int serve(const ServeOptions& o, const ClusterOptions& given, const ServeCluster& cluster) {
  constexpr std::uint64_t kStepNs = 100'000'000;  // maximum delay until an interrupt is noticed
  Serving serving;
  ServerOptions options = given.server;
  options.helpers = cluster.helpers;
  if (!cluster.helpers) options.cpu_ns = platform::thread_cpu_ns;  // it waits for them
  SceneStoreOptions store_options;
  store_options.folder = o.scenes, store_options.lights_rooms = true;
  store_options.bytes_max = given.scene_bytes_max;
  Status status = start(o, cluster, store_options, &serving, &options);
  if (!status.ok) return report(status);
  print_start(o, cluster, serving, options);
  seal_memory();
  while (!interrupted && status.ok) {
    step_server(serving.server, kStepNs);
    if (cluster.tend) status = cluster.tend();
  }
  unseal_memory();
  ServerTotals totals = server_totals(*serving.server);
  close_server(serving.server);
  serving.server = nullptr;
  print_totals(totals, cluster);
  return status.ok ? kExitInterrupted : report(status);
}

int run(const ServeOptions& o, ServeOnRanks on_ranks) {
  platform::survive_closed_pipes();
  auto read = [&](ClusterOptions* options) { return read_cluster_options(o, options); };
  auto lead = [&](const ClusterOptions& options, const ServeCluster& cluster) { return serve(o, options, cluster); };
  if (o.team.size > 1 && on_ranks) return on_ranks(o.team, read, lead);
  ClusterOptions options;
  Status status = read(&options);
  return status.ok ? serve(o, options, ServeCluster()) : report(status);
}

}  // namespace

void add_serve_command(Command program, const Team& team, ServeOnRanks on_ranks, int* exit_status) {
  auto o = std::make_shared<ServeOptions>();
  o->team = team;
  Command command = program.add_subcommand("serve", "run a render server for devices");
  command.chapter("Link");
  command.add_option("--listen HOST:PORT", o->listen, "address; port 0: any free one")
      .capture_default_str()
      .details(
          "Addresses that other machines can reach need --key or --insecure-lan: otherwise anyone who reaches the port "
          "could use the CPU and see the scenes. Instead, 127.0.0.1 can be reached through an SSH tunnel.");
  Option key = add_key_option(command, &o->key);
  command.chapter("Link");
  command.add_flag("--insecure-lan", o->insecure_lan, "serve other machines without a key")
      .details("Everyone who reaches the port can then use the CPU and see the scenes.")
      .excludes(key, "a key authenticates clients");
  command.chapter("Scenes and clients");
  command.add_option("--scenes DIR", o->scenes, "folder of scenes to offer besides the built-in ones")
      .details("Its .pray files and, on a desktop, models; not its subfolders.");
  command.add_option("--clients N", o->clients, "clients at a time; others are told to wait")
      .range(1, kServerClientsMax)
      .capture_default_str();
  command.add_option("--size-max N", o->image_side_max, "longest picture side in pixels")
      .range(1, kImageSideMax)
      .capture_default_str();
  command.add_option("--idle SECONDS", o->idle_seconds, "silence after which a client is dropped")
      .range(1, 1e6)
      .capture_default_str();
  command.add_option("--coherence WHEN", o->coherence, "trace only what changed since a client's last frame")
      .one_of({"off", "auto", "on"})
      .capture_default_str()
      .details("auto: if it pays off and the client's memory allows it.");
  command.chapter("Machine");
  command.add_option("--threads N", o->threads, "threads that trace; 0: one per core")
      .range(0, kThreadCountMax)
      .capture_default_str()
      .details("Of each rank, shared by all clients.");
  command.add_option("--memory SIZE", o->memory, "memory per client, for pictures and rendering").capture_default_str();
  command.add_option("--scene-memory SIZE", o->scene_memory, "memory for all scenes together").capture_default_str();
  add_isa_option(command, &o->isa);
  command.everyday("Link", {"--listen", "--key", "--insecure-lan"});
  command.everyday("Scenes and clients", {"--scenes", "--clients", "--size-max"});
  command.everyday("Machine", {"--threads", "--memory", "--scene-memory"});
  command.example("pocketray serve --scenes DIR");
  command.example("pocketray keygen && pocketray serve --listen 0.0.0.0:7411 --key pocketray.key");
  command.about("Traces part of each frame for devices that name it with --server; under `mpirun`, on all ranks.");
  command.callback([=] { *exit_status = run(*o, on_ranks); });
}

}  // namespace pocketray
