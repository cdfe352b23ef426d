// What a server tells of a scene to a device that has no room for it.
#include <cmath>

#include "app/server_session.h"

namespace pocketray {
namespace {

bool can_travel(const Vec3& v) {
  return std::fabs(v.x) <= kCoordinateMax && std::fabs(v.y) <= kCoordinateMax && std::fabs(v.z) <= kCoordinateMax;
}

bool can_travel(const ViewEntry& entry) {
  const Camera& c = entry.camera;
  return can_travel(c.eye) && can_travel(c.target) && can_travel(c.up) && can_travel(entry.bounds.low) &&
         can_travel(entry.bounds.high) && std::fabs(c.vertical_fov) <= kCoordinateMax &&
         std::fabs(c.vertical_extent) <= kCoordinateMax && entry.exposure > 0 && entry.exposure <= kRadianceMax;
}

}  // namespace

Status answer_view_query(Session* s) {
  const Renderer* r = &s->renderer;
  Message message;
  message.type = MessageType::view_entry;
  ViewEntry* entry = &message.view_entry;
  entry->scene = s->job.scene->hash;
  entry->camera = r->camera;
  entry->camera.node = kNone;
  entry->exposure = r->exposure;
  entry->frames_per_second = r->scene.info.frames_per_second;
  entry->effects = r->effects.mask;
  entry->triangle_count = r->scene.triangles.count;
  if (!is_empty(r->accel.bounds)) entry->bounds = r->accel.bounds;
  if (!can_travel(*entry)) return failure("its camera, size or exposure is beyond what a message takes");
  send_message(s, message);
  drop_job(s);
  return success();
}

}  // namespace pocketray
