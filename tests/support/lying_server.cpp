#include "support/lying_server.h"

#include "remote/server/state.h"

namespace pocketray {
namespace {

struct Liar {
  VirtualWorld* world;
  std::uint32_t server;
  Lie lie;
  std::uint64_t end_ns = 0;  // of the work last seen
};
std::vector<Liar> liars;
std::uint64_t told = 0;

// As far from the truth as a display can show, so that no format hides it.
Vec3 wrong(Vec3 radiance, float exposure) {
  return max_component(radiance) * exposure > 0.2f ? Vec3{0, 0, 0} : Vec3{1e6f, 1e6f, 1e6f};
}

void lie_about(Liar* liar, Session* s, const Slice& slice) {
  const FrameJob& job = s->job;
  Renderer* renderer = &s->renderer;
  std::uint32_t width = renderer->settings.width;
  bool in_row = slice.row_count == 0 || job.traced_columns > 0;
  std::uint32_t column_end = slice.column_end > 0 ? slice.column_end : width;
  RowRange ranges[kRunCountMax];
  const std::uint32_t range_count = next_ranges(job, in_row ? 1 : slice.row_count, ranges);
  for (std::uint32_t i = 0; i < range_count; ++i)
    for (std::uint32_t row = ranges[i].begin; row < ranges[i].end; ++row)
      for (std::uint32_t column = job.traced_columns; column < column_end; ++column) {
        if (!liar->lie(job.request.frame, row, column)) continue;
        Vec3* pixel = &renderer->image[std::size_t(row) * width + column];
        *pixel = wrong(*pixel, renderer->view.exposure);
        ++told;
      }
}

// A server asks for the time after tracing a slice and recording its end, but before packing it.
std::uint64_t now_and_lie(platform::Link* link) {
  for (Liar& liar : liars) {
    Server* server = liar.world->servers[liar.server];
    if (!server || server->work.session < 0) continue;
    const Work& work = server->work;
    if (work.end_ns == 0 || work.end_ns == liar.end_ns) continue;
    liar.end_ns = work.end_ns;
    Session* s = &server->sessions[static_cast<std::size_t>(work.session)];
    bool traced = work.is_job && work.slice.pixel_count > 0 && !work.slice.is_probe;
    if (traced && has_job(*s) && s->job_number == work.job_number) lie_about(&liar, s, work.slice);
  }
  return platform::kNullLink.now_ns(link);
}

}  // namespace

void make_liar(VirtualWorld* world, std::uint32_t server, const Lie& lie) {
  liars.push_back({world, server, lie});
  world->backend.now_ns = now_and_lie;
}

void forget_lies() {
  liars.clear();
  told = 0;
}

std::uint64_t lies_told() { return told; }

}  // namespace pocketray
