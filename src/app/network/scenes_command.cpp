// pocketray scenes: lists the scenes that render servers offer.
#include <nlohmann/json.hpp>

#include "app/network/network_commands.h"
#include "app/options.h"
#include "remote/client/servers.h"
#include "session/note.h"
#include "session/output.h"
#include "session/report.h"

namespace pocketray {
namespace {

struct ScenesOptions {
  std::string json;
  ServersOptions servers;
};

Json to_json(const std::vector<OfferedScene>& scenes) {
  Json list = Json::array();
  for (const OfferedScene& scene : scenes)
    list.push_back({{"name", scene.name}, {"triangles", scene.triangle_count}, {"bytes", scene.byte_count}});
  return list;
}

void print(const std::string& server, const std::vector<OfferedScene>& scenes) {
  std::printf("%s: %zu scene%s\n", shown(server).c_str(), scenes.size(), scenes.size() == 1 ? "" : "s");
  for (const OfferedScene& scene : scenes)
    std::printf("  %-24s %9s triangles %12s bytes\n", scene.name.c_str(), grouped(scene.triangle_count).c_str(),
                grouped(scene.byte_count).c_str());
}

int run(const ScenesOptions& o) {
  Servers* servers = nullptr;
  Status status = check_outputs({{"--key", o.servers.key}}, {{"--json", o.json}});
  if (status.ok) status = kRenderServers.open(o.servers, nullptr, &servers);
  ServersHandle closing(servers);
  if (!status.ok) return report(status);
  Json json = Json::array();
  int exit_status = kExitDone;
  for (std::size_t i = 0; i < o.servers.addresses.size(); ++i) {
    std::vector<OfferedScene> scenes;
    status = servers->backend->list_scenes(servers, i, &scenes);
    if (!status.ok) {
      exit_status = report(status);
      continue;
    }
    if (o.json != "-") print(o.servers.addresses[i], scenes);
    json.push_back({{"server", o.servers.addresses[i]}, {"scenes", to_json(scenes)}});
  }
  if (!o.json.empty()) status = write_json(o.json, json);
  return status.ok || exit_status != kExitDone ? exit_status : report(status);
}

}  // namespace

void add_scenes_command(Command program, int* exit_status) {
  auto o = std::make_shared<ScenesOptions>();
  Command command = program.add_subcommand("scenes", "list the scenes that render servers offer");
  add_server_option(command, &o->servers.addresses).required();
  add_key_option(command, &o->servers.key);
  add_json_option(command, &o->json);
  command.about(
      "Pass any of these names to `render` or `view` with the same --server. They fetch the scene, or leave it to the "
      "server if it does not fit in --memory.");
  command.everyday("Servers", {"--server", "--key", "--json"});
  command.example("pocketray scenes --server 127.0.0.1:7411");
  command.callback([=] { *exit_status = run(*o); });
}

}  // namespace pocketray
