#include "app/network/serve_ranks.h"

#include <memory>

#include "base/check.h"
#include "remote/cluster/helper.h"
#include "remote/cluster/lead.h"
#include "session/report.h"

namespace pocketray {

int serve_on_ranks(const Team& team, const std::function<Status(ClusterOptions*)>& read_options,
                   const std::function<int(const ClusterOptions&, const ServeCluster&)>& lead) {
  CHECK_GT(team.size, 1u);
  std::unique_ptr<ClusterHelper> helper;
  auto run_lead = [&] {
    ClusterOptions options;
    Status status = read_options(&options);
    if (!status.ok) return report(status);
    ClusterLead cluster(team, options.server, options.identity);
    ServeCluster with;
    with.helpers = cluster.helpers();
    with.rank_count = cluster.rank_count();
    with.welcome = [&](const SceneStore& store) { return cluster.welcome(store); };
    with.tend = [&] { return cluster.tend(); };
    with.thread_count = [&] { return cluster.thread_count(); };
    with.helped_share = [&] { return cluster.helped_share(); };
    return lead(options, with);
  };
  auto open = [&] {
    ClusterOptions options;
    RETURN_IF_ERROR(read_options(&options));
    helper = std::make_unique<ClusterHelper>(team, options.server, options.scene_bytes_max, options.identity);
    return helper->open();
  };
  return run_in_team(team, run_lead, open, [&](const TeamMessage& message) { return helper->work(message); });
}

}  // namespace pocketray
