#include "shade/contact.h"

namespace pocketray {
namespace {

struct ContactFilter {
  const FrameData* frame;
  const HitFilter* inner;
  const Contact* contact;
  Vec3 inward;
};

bool meets_front(const ContactFilter& f, std::uint32_t triangle) {
  const Triangle& t = f.frame->scene->triangles[triangle];
  const Vec3 &a = f.frame->geometry.positions[t.vertex(0)], &b = f.frame->geometry.positions[t.vertex(1)],
             &c = f.frame->geometry.positions[t.vertex(2)];
  return dot(normalize(cross(b - a, c - a)), f.inward) <= 0;
}

bool accept_new_face(const void* context, std::uint32_t triangle, float u, float v) {
  const auto& f = *static_cast<const ContactFilter*>(context);
  std::uint32_t material = f.frame->scene->triangles[triangle].material();
  bool front = meets_front(f, triangle);
  for (std::uint32_t i = 0; i < f.contact->count; ++i)
    if (f.contact->face[i].material == material && f.contact->face[i].front == front) return false;
  return !f.inner || f.inner->accept(f.inner->context, triangle, u, v);
}

}  // namespace

void gather_contact(const FrameData& frame, const Surface& s, const Hit& hit, const HitFilter* filter, Contact* contact,
                    TraceStats* stats) {
  contact->face[0] = {hit, frame.scene->triangles[hit.triangle].material(), s.front};
  contact->count = 1;
  Vec3 begin = safe_origin(s, 1);
  ContactFilter context = {&frame, filter && filter->accept ? filter : nullptr, contact, safe_origin(s, -1) - begin};
  HitFilter fresh = {accept_new_face, &context};
  while (contact->count < kMediumDepthMax) {
    Hit other;
    frame.geometry.accel_info->closest(frame.geometry.accel, {begin, context.inward, 1}, &fresh, &other, stats);
    if (other.triangle == kNoTriangle) return;
    contact->face[contact->count++] = {other, frame.scene->triangles[other.triangle].material(),
                                       meets_front(context, other.triangle)};
  }
}

}  // namespace pocketray
