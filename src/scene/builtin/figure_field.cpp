#include "scene/builtin/figure_field.h"

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

// Ellipsoid: center a, radii b. Cone: from a with radius ra to b with radius rb, rounded ends.
struct Blob {
  enum Kind : unsigned char { ellipsoid, cone, carve } kind;  // carve: subtracts an ellipsoid
  Vec3 a, b;
  float ra, rb;
  float blend;  // width of the transition to the blobs before it
};

constexpr Blob kTorso[] = {
    {Blob::ellipsoid, {0, 5.70f, -.02f}, {.60f, .82f, .40f}, 0, 0, 0},            // ribs
    {Blob::ellipsoid, {0, 6.00f, -.04f}, {.66f, .36f, .33f}, 0, 0, .15f},         // chest
    {Blob::cone, {-.66f, 6.15f, -.08f}, {.66f, 6.15f, -.08f}, .17f, .17f, .15f},  // collar bones
    {Blob::cone, {0, 6.46f, -.12f}, {-.64f, 6.19f, -.1f}, .15f, .13f, .14f},      // trapezius
    {Blob::cone, {0, 6.46f, -.12f}, {.64f, 6.19f, -.1f}, .15f, .13f, .14f},
    {Blob::ellipsoid, {-.28f, 5.56f, .27f}, {.24f, .25f, .21f}, 0, 0, .16f},  // breasts
    {Blob::ellipsoid, {.28f, 5.56f, .27f}, {.24f, .25f, .21f}, 0, 0, .16f},
    {Blob::ellipsoid, {0, 4.98f, -.01f}, {.53f, .60f, .36f}, 0, 0, .2f},     // waist
    {Blob::ellipsoid, {0, 4.58f, .10f}, {.46f, .42f, .31f}, 0, 0, .15f},     // belly
    {Blob::ellipsoid, {0, 4.12f, -.03f}, {.69f, .54f, .45f}, 0, 0, .25f},    // pelvis
    {Blob::ellipsoid, {-.3f, 3.95f, -.27f}, {.34f, .38f, .3f}, 0, 0, .15f},  // buttocks
    {Blob::ellipsoid, {.3f, 3.95f, -.27f}, {.34f, .38f, .3f}, 0, 0, .15f},
    {Blob::cone, {0, 6.3f, -.06f}, {0, 6.95f, .0f}, .23f, .2f, .12f},  // neck
};
constexpr Blob kHead[] = {
    {Blob::ellipsoid, {0, 7.26f, -.06f}, {.325f, .36f, .39f}, 0, 0, .08f},  // cranium
    {Blob::ellipsoid, {0, 7.04f, .11f}, {.25f, .35f, .27f}, 0, 0, .08f},    // face
    {Blob::ellipsoid, {0, 6.77f, .27f}, {.1f, .08f, .09f}, 0, 0, .09f},     // chin
    {Blob::cone, {-.2f, 6.85f, .05f}, {0, 6.76f, .24f}, .08f, .07f, .08f},  // jaw
    {Blob::cone, {.2f, 6.85f, .05f}, {0, 6.76f, .24f}, .08f, .07f, .08f},
    {Blob::ellipsoid, {-.14f, 6.98f, .25f}, {.1f, .11f, .1f}, 0, 0, .06f},  // cheeks
    {Blob::ellipsoid, {.14f, 6.98f, .25f}, {.1f, .11f, .1f}, 0, 0, .06f},
    {Blob::cone, {-.15f, 7.16f, .27f}, {.15f, 7.16f, .27f}, .055f, .055f, .06f},  // brow
    {Blob::carve, {-.11f, 7.085f, .40f}, {.075f, .045f, .075f}, 0, 0, .05f},      // eyes
    {Blob::carve, {.11f, 7.085f, .40f}, {.075f, .045f, .075f}, 0, 0, .05f},
    {Blob::ellipsoid, {-.11f, 7.075f, .29f}, {.06f, .035f, .05f}, 0, 0, .015f},
    {Blob::ellipsoid, {.11f, 7.075f, .29f}, {.06f, .035f, .05f}, 0, 0, .015f},
    {Blob::cone, {0, 7.16f, .34f}, {0, 6.99f, .42f}, .03f, .045f, .04f},      // nose
    {Blob::ellipsoid, {0, 6.885f, .345f}, {.085f, .022f, .05f}, 0, 0, .02f},  // lips
    {Blob::ellipsoid, {0, 6.85f, .335f}, {.07f, .024f, .05f}, 0, 0, .02f},
};
constexpr Blob kHair[] = {
    {Blob::ellipsoid, {0, 7.30f, -.10f}, {.385f, .385f, .43f}, 0, 0, .03f},
    {Blob::ellipsoid, {-.27f, 7.10f, .0f}, {.12f, .22f, .22f}, 0, 0, .06f},
    {Blob::ellipsoid, {.27f, 7.10f, .0f}, {.12f, .22f, .22f}, 0, 0, .06f},
    {Blob::ellipsoid, {0, 7.10f, -.56f}, {.2f, .19f, .17f}, 0, 0, .05f},
};
constexpr Blob kLegs[] = {
    {Blob::cone, {-.33f, 3.85f, -.02f}, {-.27f, .1f, -.05f}, .44f, .3f, .2f},  // standing leg
    {Blob::cone, {.32f, 3.8f, .06f}, {.36f, 2.15f, .46f}, .42f, .25f, .15f},   // free leg: thigh, knee, shin
    {Blob::cone, {.36f, 2.15f, .46f}, {.42f, .1f, .14f}, .25f, .22f, .12f},
};
struct ArmShape {
  Vec3 shoulder, elbow;
  float shoulder_radius, elbow_radius;
  Vec3 deltoid;
  Vec3 break_at, break_normal;  // the plane in which the arm ends
};
constexpr ArmShape kArms[2] = {
    {{-.79f, 6.05f, -.05f},
     {-.98f, 4.75f, -.1f},
     .19f,
     .155f,
     {-.77f, 6.03f, -.05f},
     {-.95f, 5.02f, -.09f},
     {-.3f, -.93f, .2f}},
    {{.79f, 6.05f, -.05f},
     {1.02f, 5.1f, .16f},
     .19f,
     .15f,
     {.77f, 6.03f, -.05f},
     {.9f, 5.55f, .05f},
     {.35f, -.9f, .25f}},
};
constexpr float kArmTransition = .16f;  // how far from the arm its surface may bulge to join the shoulder

float clamp01(float x) { return x < 0 ? 0 : x > 1 ? 1 : x; }
float smooth_step(float low, float high, float x) {
  float t = clamp01((x - low) / (high - low));
  return t * t * (3 - 2 * t);
}
float square(float x) { return x * x; }
float sine(float x) { return static_cast<float>(det_sin(static_cast<double>(x))); }

// Quadratic smooth minimum: differs from min() only where |a - b| < k.
float smooth_min(float a, float b, float k) {
  float h = k - std::fabs(a - b);
  float least = a < b ? a : b;
  return h > 0 ? least - h * h / (4 * k) : least;
}
float ellipsoid_distance(const Vec3& p, const Vec3& center, const Vec3& radii) {
  Vec3 q = p - center;
  Vec3 u = {q.x / radii.x, q.y / radii.y, q.z / radii.z};
  Vec3 v = {u.x / radii.x, u.y / radii.y, u.z / radii.z};
  float k0 = length(u), k1 = length(v);
  return k1 > 0 ? k0 * (k0 - 1) / k1 : -radii.x;
}
float cone_distance(const Vec3& p, const Vec3& a, const Vec3& b, float ra, float rb) {
  Vec3 ab = b - a, ap = p - a;
  float h = clamp01(dot(ap, ab) / dot(ab, ab));
  return length(ap - ab * h) - (ra + (rb - ra) * h);
}

// Returns whether y is more than `margin` outside the interval [a, b]: such blobs do not affect the surface at y.
bool beyond(float y, float a, float b, float margin) {
  return (y < a - margin && y < b - margin) || (y > a + margin && y > b + margin);
}

template <std::size_t n>
float unite(const Blob (&blobs)[n], const Vec3& p, float distance) {
  for (const Blob& blob : blobs) {
    switch (blob.kind) {
      case Blob::ellipsoid:
        if (beyond(p.y, blob.a.y, blob.a.y, blob.b.y + blob.blend + .1f)) break;
        distance = smooth_min(distance, ellipsoid_distance(p, blob.a, blob.b), blob.blend + 1e-3f);
        break;
      case Blob::cone:
        if (beyond(p.y, blob.a.y, blob.b.y, (blob.ra > blob.rb ? blob.ra : blob.rb) + blob.blend + .1f)) break;
        distance = smooth_min(distance, cone_distance(p, blob.a, blob.b, blob.ra, blob.rb), blob.blend);
        break;
      case Blob::carve:
        if (beyond(p.y, blob.a.y, blob.a.y, blob.b.y + blob.blend + .1f)) break;
        distance = -smooth_min(-distance, ellipsoid_distance(p, blob.a, blob.b), blob.blend);
        break;
    }
  }
  return distance;
}

// A fold: rounded ridge, sharp valley; mean near 0, from about -0.5 to 0.4.
float fold(float x) {
  float s = sine(x);
  return std::sqrt(s * s + .02f) - .62f;
}

// Upper hem of the robe: low in front, high at the back and over the figure's left hip.
float robe_edge(float azimuth) { return 4.03f + .22f * sine(azimuth) - .16f * sine(azimuth + 1.57f); }

float robe_relief(float azimuth, float y) {
  float edge = robe_edge(azimuth);
  float front = .5f + .5f * sine(azimuth + 1.57f);
  float knee = square(.5f + .5f * sine(azimuth - .55f + 1.57f));  // 1 over the free leg
  knee *= knee;
  // Pleats that fall to the ground, flatter over the free leg.
  float fall = smooth_step(3.9f, .5f, y);
  float wander = .35f * sine(2.1f * y + 3 * azimuth) + .8f * sine(2 * azimuth + .7f);
  float pleats = fold(7 * azimuth + wander) + .45f * fold(17 * azimuth + 1.7f * wander + .5f * y);
  float relief = .16f * fall * (1 - .85f * knee * smooth_step(.6f, 1.5f, y)) * pleats;
  // Folds from the raised knee to the hip of the standing leg.
  float drawn = smooth_step(1.3f, 2.2f, y) * smooth_step(edge, edge - .5f, y) * square(front);
  relief += .10f * drawn * fold(3.6f * y + 2.3f * azimuth + .5f * sine(3 * azimuth));
  // The rolled hem, twisted like a rope.
  float roll = 1 - square((y - edge + .2f) / .32f);
  if (roll > 0) relief += .07f * roll * (1 + .55f * fold(8 * y + 5 * azimuth));
  return relief + .03f * smooth_step(edge + .08f, edge - .1f, y);
}

// Waves combed from the parting to the nape.
float hair_relief(const Vec3& p, float y) {
  float back = p.z * .8f;
  float parting = std::fabs(p.x) < .12f && p.z > -.3f ? .03f * square(1 - std::fabs(p.x) / .12f) : 0;
  return .045f * fold(12 * (y - back) + 2 * std::fabs(p.x)) * smooth_step(6.8f, 6.95f, y) - parting;
}

// Elliptical skirt under the folds, from the hips to the ground.
float skirt_distance(const Vec3& p) {
  float t = clamp01((4.2f - p.y) / 4.2f);
  float ax = .71f - .1f * t + .3f * t * t, az = .46f - .04f * t + .33f * t * t;
  float k = std::sqrt(square(p.x / ax) + square((p.z - .04f) / az));
  return (k - 1) * az;
}

}  // namespace

float body_distance(const Vec3& p, float azimuth) {
  float distance = 1e3f;
  if (p.y > 3.2f) distance = unite(kTorso, p, distance);
  if (p.y > 6.4f) {
    distance = unite(kHead, p, distance);
    float hair = unite(kHair, p, 1e3f);
    if (std::fabs(hair) < .2f) hair -= hair_relief(p, p.y);
    // The hairline: no hair over the face.
    float face = ellipsoid_distance(p, {0, 6.98f, .34f}, {.235f, .43f, .3f});
    if (-face > hair) hair = -face;
    distance = smooth_min(distance, hair, .02f);
  }
  if (p.y < 4.6f) {
    float robe = unite(kLegs, p, skirt_distance(p));
    float top = p.y - (robe_edge(azimuth) + .12f);
    if (top > robe) robe = top;
    distance = smooth_min(distance, robe, .04f);
    if (std::fabs(distance) < .3f) distance -= robe_relief(azimuth, p.y);  // folds are less deep than that
  }
  return distance;
}

float arm_distance(int side, const Vec3& p) {
  const ArmShape& arm = kArms[side];
  float alone = cone_distance(p, arm.shoulder, arm.elbow, arm.shoulder_radius, arm.elbow_radius);
  alone = smooth_min(alone, ellipsoid_distance(p, arm.deltoid, {.2f, .28f, .22f}), .12f);
  // The robe grows out of the shoulder and hangs free below the armpit.
  float grown = smooth_step(5.5f, 5.95f, p.y);
  float joined = smooth_min(alone, unite(kTorso, p, 1e3f), .2f * grown + 1e-3f);
  float limit = alone - kArmTransition * grown;
  float distance = joined > limit ? joined : limit;
  float cut = dot(p - arm.break_at, arm.break_normal);
  return cut > distance ? cut : distance;
}

void arm_axis(int side, Vec3* from, Vec3* to) {
  CHECK(side == 0 || side == 1);
  *from = kArms[side].shoulder;
  *to = kArms[side].break_at;
}

Vec3 bend_figure(const Vec3& p) {
  // The hips lean over the standing leg (the figure's right, -x), the shoulders lean back, the head again to the right.
  float hip = smooth_step(0, 4.1f, p.y), chest = smooth_step(4.1f, 6.1f, p.y), head = smooth_step(6.2f, 7.0f, p.y);
  float sway = -.26f * hip + .22f * chest - .05f * head;
  float lean = .06f * hip - .14f * chest + .1f * head;
  float tilt =
      .16f * hip * p.x - .26f * chest * p.x + .05f * head * p.x;  // tilt of the lines through hips, shoulders and eyes
  float turn = -.1f * hip + .22f * chest - .5f * head;
  float s = sine(turn), c = sine(turn + 1.57079633f);
  return {c * p.x + s * p.z + sway, p.y + -tilt, -s * p.x + c * p.z + lean};
}

}  // namespace pocketray
