#include "scene/builtin/seesaw_motion.h"

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

constexpr double kGravity = 9.81;
constexpr double kTilt = 0.30;         // of the board at rest
constexpr double kSeat = 2.15;         // distance from the pivot to where weight and worm meet the board
constexpr double kStandHeight = 0.86;  // of the standing worm's centre

// The weight is released at kRelease and falls onto the board, which swings over within kSwing.
constexpr double kRelease = 0.10, kWeightStart = 5.0, kSwing = 0.17;
constexpr double kLaunchSpeed = 7.1, kLaunchX = -0.75, kLaunchZ = 1.0;  // the worm jumps slightly forward
constexpr double kBounceSpeed[2] = {2.7, 1.2};

double clamp01(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }
double ease(double from, double to, double x) {
  double t = clamp01((x - from) / (to - from));
  return t * t * (3 - 2 * t);
}
// A blow at `since` = 0 that rings down.
double ring(double since, double decay, double frequency) {
  return since > 0 ? det_exp(-decay * since) * det_sin(frequency * since) : 0;
}

struct Events {
  double impact, launch, landing[3];
};
double seat_height(double board_angle, double seat) {
  return kPivotHeight + seat * det_sin(board_angle) + kBoardHalfThickness * det_cos(board_angle);
}
Events find_events() {
  Events e;
  double drop = kWeightStart - seat_height(-kTilt, -kSeat);
  e.impact = kRelease + std::sqrt(2 * drop / kGravity);
  e.launch = e.impact + kSwing;
  // The worm's centre starts above the raised seat and comes down to standing height.
  double above = seat_height(kTilt, kSeat) + (kStandHeight - 0.04) * det_cos(kTilt) - kStandHeight;
  e.landing[0] = e.launch + (kLaunchSpeed + std::sqrt(kLaunchSpeed * kLaunchSpeed + 2 * kGravity * above)) / kGravity;
  for (int i = 0; i < 2; ++i) e.landing[i + 1] = e.landing[i] + 2 * kBounceSpeed[i] / kGravity;
  CHECK(kRelease < e.impact && e.impact < e.launch);
  CHECK(e.launch < e.landing[0] && e.landing[0] < e.landing[1] && e.landing[1] < e.landing[2]);
  return e;
}

double board_angle_at(const Events& e, double t) {
  if (t <= e.impact) return -kTilt;
  if (t < e.launch) return -kTilt + 2 * kTilt * (t - e.impact) / kSwing;
  double rebound = ring(t - e.launch, 5, 13);
  return kTilt - 0.09 * std::fabs(rebound);
}

Vec3 to_float(double x, double y, double z) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

// A point in the board's frame: `along` from the pivot, `above` the middle of the plank.
void on_board(double angle, double along, double above, double* x, double* y) {
  *x = along * det_cos(angle) - above * det_sin(angle);
  *y = kPivotHeight + along * det_sin(angle) + above * det_cos(angle);
}

void move_weight(const Events& e, double t, SeesawState* s) {
  double x, y;
  if (t <= e.impact) {
    double fall = t > kRelease ? t - kRelease : 0;
    on_board(-kTilt, -kSeat, kBoardHalfThickness, &x, &y);
    s->weight_position = to_float(x, kWeightStart - 0.5 * kGravity * fall * fall, 0);
    s->weight_angle = 0;
    return;
  }
  on_board(s->board_angle, -kSeat, kBoardHalfThickness, &x, &y);
  double hop = 0.16 * std::fabs(ring(t - e.launch, 5.5, 11));
  s->weight_position = to_float(x, y + hop, 0);
  s->weight_angle = static_cast<float>(static_cast<double>(s->board_angle) * ease(e.impact, e.launch + 0.1, t));
}

void move_body(const Events& e, double t, SeesawState* s) {
  double x, y, z = 0, angle = s->board_angle;
  if (t <= e.launch) {
    on_board(angle, kSeat, kBoardHalfThickness + kStandHeight - 0.04, &x, &y);
  } else {
    on_board(kTilt, kSeat, kBoardHalfThickness + kStandHeight - 0.04, &x, &y);
    double flight = (t < e.landing[2] ? t : e.landing[2]) - e.launch;
    double first = e.landing[0] - e.launch;
    double slowed = flight < first ? flight : first + 0.45 * (flight - first);
    x += kLaunchX * slowed;
    z += kLaunchZ * slowed;
    if (t < e.landing[0]) {
      y += kLaunchSpeed * flight - 0.5 * kGravity * flight * flight;
    } else {
      y = kStandHeight;
      for (int i = 0; i < 2; ++i) {
        double since = t - e.landing[i];
        if (t < e.landing[i + 1]) {
          y += kBounceSpeed[i] * since - 0.5 * kGravity * since * since;
          break;
        }
      }
    }
    // One somersault, forward.
    angle = kTilt + (2 * kPi - kTilt) * ease(e.launch + 0.05, e.landing[0] - 0.15, t);
    if (t >= e.landing[0]) angle = 0;
  }
  // Squashed by each impact, stretched in fast flight.
  double squash = 0.30 * ring(t - e.impact, 9, 17) * (t < e.launch ? 1 : 0);
  const double blow[3] = {0.52, 0.34, 0.24};
  for (int i = 0; i < 3; ++i) {
    double until = i < 2 ? e.landing[i + 1] : 1e9;
    if (t > e.landing[i] && t <= until) squash += blow[i] * ring(t - e.landing[i], 5, 12);
  }
  squash -= 0.18 * ease(e.launch - 0.02, e.launch + 0.08, t) * ease(e.launch + 0.9, e.launch + 0.3, t);
  double breath = 0.012 * det_sin(2.6 * t);
  double tall = 1 - squash + breath, wide = 1 / std::sqrt(tall);
  CHECK_GT(tall, 0);
  s->body_scale = to_float(wide, tall, wide);
  // On the ground the tail stays down while the body is squashed.
  double lowered = t <= e.launch || t >= e.landing[0] ? (1 - tall) * kStandHeight : 0;
  s->body_position = to_float(x + lowered * det_sin(angle), y - lowered * det_cos(angle), z);
  s->body_angle = static_cast<float>(angle);
}

void flex_worm(const Events& e, double t, SeesawState* s) {
  constexpr double kStand[kWormJoints] = {75, -20, -25, -25, -10, 5, 5, -5};  // degrees
  double fly = ease(e.launch - 0.06, e.launch + 0.12, t) * (1 - ease(e.landing[0] - 0.35, e.landing[0], t));
  double calm = ease(e.landing[2] + 1.5, e.landing[2] + 0.3, t) * 0.6 + 0.4;
  for (int k = 0; k < kWormJoints; ++k) {
    double phase = 0.75 * k;
    double wave = 16 * det_sin(11 * (t - e.launch) - phase);
    double sway = k < 3 ? 0 : calm * (3.2 * det_sin(2.1 * t - 0.5 * phase) + 1.2 * det_sin(3.7 * t + phase));
    double shake = k < 2 ? 0 : 9 * ring(t - e.landing[0], 1.8, 13) * det_cos(phase) + 5 * ring(t - e.landing[2], 2, 9);
    double degrees = (1 - fly) * (kStand[k] + sway + shake) + fly * (k == 0 ? 4 : wave);
    s->joint_angle[k] = static_cast<float>(radians(degrees));
  }
  s->tail_offset = to_float(0.5 * (1 - fly), -(kStandHeight - kWormRadius * 0.67) * (1 - fly) - 1.1 * fly, 0);
}

}  // namespace

SeesawState seesaw_at(double seconds) {
  Events events = find_events();
  SeesawState state;
  state.board_angle = static_cast<float>(board_angle_at(events, seconds));
  move_weight(events, seconds, &state);
  move_body(events, seconds, &state);
  flex_worm(events, seconds, &state);
  return state;
}

}  // namespace pocketray
