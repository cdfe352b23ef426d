// What a server tells of a scene to a device that has no room for it.
#include "remote/server/session.h"

namespace pocketray {

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
  if (!can_encode(message)) return failure("its camera, size or exposure is beyond what a message takes");
  send_message(s, message);
  drop_job(s);
  return success();
}

}  // namespace pocketray
