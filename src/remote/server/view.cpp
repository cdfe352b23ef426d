// Describes a scene to a device on which it does not fit.
#include "base/check.h"
#include "remote/server/session.h"

namespace pocketray {

Status answer_view_query(Session* session) {
  CHECK(has_job(*session) && session->job.is_view_query);
  const Renderer* renderer = &session->renderer;
  Message message;
  message.type = MessageType::view_entry;
  ViewEntry* entry = &message.view_entry;
  entry->scene = session->job.scene->hash;
  entry->animation = renderer->view.animation;
  if (renderer->scene.origin.count) entry->origin = renderer->scene.origin[0];
  entry->camera = renderer->view.camera;
  entry->camera.node = kNone;
  entry->exposure = renderer->view.exposure;
  entry->frames_per_second = renderer->scene.info.frames_per_second;
  entry->effects = renderer->effects.mask;
  entry->triangle_count = renderer->scene.triangles.count;
  if (!is_empty(renderer->accel.built.bounds)) entry->bounds = renderer->accel.built.bounds;
  if (!can_encode(message)) return failure("its camera, size or exposure does not fit in a message");
  send_message(session, message);
  drop_job(session);
  return success();
}

}  // namespace pocketray
