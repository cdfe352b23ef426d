#include "desktop/import/planar_sweep.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "base/check.h"
#include "scene/scene.h"

namespace pocketray {
namespace {

// Sign of a sum of six doubles, exactly [Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic", fig. 7].
int sign_of_sum(const double (&terms)[6]) {
  double parts[6];
  int count = 0;
  for (double sum : terms) {
    for (int i = 0; i < count; ++i) {
      const double whole = sum + parts[i], other = whole - sum;
      parts[i] = (sum - (whole - other)) + (parts[i] - other);
      sum = whole;
    }
    parts[count++] = sum;
  }
  while (count > 0 && parts[count - 1] == 0) --count;
  return count == 0 ? 0 : parts[count - 1] > 0 ? 1 : -1;
}

double area_twice(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double ax = static_cast<double>(a.x), ay = static_cast<double>(a.y);
  return (static_cast<double>(b.x) - ax) * (static_cast<double>(c.y) - ay) -
         (static_cast<double>(b.y) - ay) * (static_cast<double>(c.x) - ax);
}

double two_roundings(float a, float b) { return 0x1p-22 * static_cast<double>(std::max(std::fabs(a), std::fabs(b))); }

// The crossing of segments a and b, rounded, within the boxes of both.
Vec2 crossing_of(const Vec2& a0, const Vec2& a1, const Vec2& b0, const Vec2& b1) {
  const double before = area_twice(a0, a1, b0), after = area_twice(a0, a1, b1);
  double along = before / (before - after);
  if (!(along >= 0 && along <= 1)) along = 0.5;
  auto between = [&](float Vec2::*c) {
    const double low = static_cast<double>(b0.*c), high = static_cast<double>(b1.*c);
    const float value = static_cast<float>(low + (high - low) * along);
    const float least = std::max(std::min(a0.*c, a1.*c), std::min(b0.*c, b1.*c)),
                most = std::min(std::max(a0.*c, a1.*c), std::max(b0.*c, b1.*c));
    return std::min(std::max(value, least), most);
  };
  return {between(&Vec2::x), between(&Vec2::y)};
}

}  // namespace

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double ax = static_cast<double>(a.x), ay = static_cast<double>(a.y), bx = static_cast<double>(b.x),
               by = static_cast<double>(b.y), cx = static_cast<double>(c.x), cy = static_cast<double>(c.y);
  const double left = (bx - ax) * (cy - ay), right = (by - ay) * (cx - ax), area = left - right;
  constexpr double kErrorBound = 3.3306690738754716e-16;  // [Shewchuk 1997]: (3 + 16 ε) ε
  if (std::fabs(area) > kErrorBound * (std::fabs(left) + std::fabs(right))) return area > 0 ? 1 : -1;
  // Products of two floats are exact in double.
  return sign_of_sum({ax * by, -(ay * bx), bx * cy, -(by * cx), cx * ay, -(cy * ax)});
}

int PlanarSweep::side(std::uint32_t edge, std::uint32_t point) const {
  const Edge& e = edges_[edge];
  if (e.low == point || e.high == point) return 0;
  return orientation(points_[e.low], points_[e.high], points_[point]);
}

bool PlanarSweep::is_below(std::uint32_t a, std::uint32_t b) const {
  if (a == b) return false;
  const Edge &p = edges_[a], &q = edges_[b];
  if (p.low == q.low) return side(a, q.high) > 0;
  if (comes_before(p.low, q.low)) {
    const int sign = side(a, q.low);
    return (sign != 0 ? sign : side(a, q.high)) > 0;
  }
  const int sign = side(b, p.low);
  return (sign != 0 ? sign : side(b, p.high)) < 0;
}

std::uint32_t PlanarSweep::point_at(const Vec2& p) {
  const auto added = order_.emplace(p, static_cast<std::uint32_t>(points_.size()));
  if (added.second) {
    points_.push_back(p);
    first_out_.push_back(kNone);
  }
  return added.first->second;
}

void PlanarSweep::add_edge(std::uint32_t low, std::uint32_t high, std::uint32_t corner) {
  if (low == high) return;
  if (comes_before(high, low)) std::swap(low, high);
  edges_.push_back({low, high, corner, first_out_[low], false, false, {}});
  first_out_[low] = static_cast<std::uint32_t>(edges_.size() - 1);
}

bool PlanarSweep::triangulate(const std::vector<Vec2>& loop, std::size_t crossing_count_max) {
  CHECK(points_.empty());
  edge_count_max_ = loop.size() + 2 * crossing_count_max;
  for (const Vec2& p : loop) points_of_corners_.push_back(point_at({p.x + 0.0f, p.y + 0.0f}));
  for (std::size_t i = 0; i < loop.size(); ++i)
    add_edge(points_of_corners_[i], points_of_corners_[(i + 1) % loop.size()], static_cast<std::uint32_t>(i));
  constexpr int kPassesMax = 100;  // chosen: a few suffice, as only rounded crossings can lead to others
  for (int i = 0; i < kPassesMax; ++i) {
    if (!pass()) return false;
    if (is_planar_) return true;
  }
  return false;
}

// By the even-odd rule, two equal edges cancel.
void PlanarSweep::cancel_pairs() {
  std::vector<Edge> all = std::move(edges_);
  for (Edge& edge : all)
    if (comes_before(edge.high, edge.low)) std::swap(edge.low, edge.high);
  std::sort(all.begin(), all.end(), [](const Edge& a, const Edge& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.corner < b.corner;
  });
  edges_.clear();
  std::fill(first_out_.begin(), first_out_.end(), kNone);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_pair = i + 1 < all.size() && all[i].low == all[i + 1].low && all[i].high == all[i + 1].high;
    if (is_pair)
      ++i;
    else
      add_edge(all[i].low, all[i].high, all[i].corner);
  }
}

bool PlanarSweep::pass() {
  begin_pass();
  for (const auto& event : order_) {
    visit(event.second);
    if (edges_.size() > edge_count_max_) return false;
  }
  end_pass();
  return true;
}

void PlanarSweep::begin_pass() {
  cancel_pairs();
  is_planar_ = true;
  status_.clear();
  nodes_.clear();
  triangles_.clear();
  splits_.clear();
  equal_.clear();
}

void PlanarSweep::end_pass() {
  for (const Split& split : splits_) {
    Edge& edge = edges_[split.edge];
    const std::uint32_t high = edge.high, corner = edge.corner;
    edge.high = split.point;
    add_edge(split.point, high, corner);
  }
  unite_equal_points();
}

// Without this, edges between such points may be split at one and the other in turn, forever.
void PlanarSweep::unite_equal_points() {
  if (equal_.empty()) return;
  std::vector<std::uint32_t> stands_for(points_.size());
  std::iota(stands_for.begin(), stands_for.end(), 0u);
  auto resolved = [&](std::uint32_t point) {
    while (stands_for[point] != point) point = stands_for[point] = stands_for[stands_for[point]];
    return point;
  };
  for (const auto& pair : equal_) {
    const std::uint32_t a = resolved(pair.first), b = resolved(pair.second);
    stands_for[std::max(a, b)] = std::min(a, b);
  }
  for (Edge& edge : edges_) edge.low = resolved(edge.low), edge.high = resolved(edge.high);
  for (std::uint32_t& point : points_of_corners_) point = resolved(point);
}

// Ends the arriving edges; splits those that pass through the point.
void PlanarSweep::take_arriving(std::uint32_t point, Status::iterator first, Status::iterator last) {
  arriving_.assign(first, last);
  for (std::uint32_t e : arriving_) {
    const Edge edge = edges_[e];
    if (edge.high == point) continue;
    is_planar_ = false;
    if (!comes_before(edge.low, point) || !comes_before(point, edge.high)) continue;
    edges_[e].high = point;
    add_edge(point, edge.high, edge.corner);
  }
}

// Sorts the leaving edges from below; where two overlap, the longer leaves from the shorter's end instead.
void PlanarSweep::take_leaving(std::uint32_t point) {
  leaving_.clear();
  for (std::uint32_t e = first_out_[point]; e != kNone; e = edges_[e].next_out) leaving_.push_back(e);
  auto is_below_at = [&](std::uint32_t a, std::uint32_t b) {
    const int sign = orientation(points_[point], points_[edges_[a].high], points_[edges_[b].high]);
    if (sign != 0) return sign > 0;
    return comes_before(edges_[a].high, edges_[b].high);
  };
  std::sort(leaving_.begin(), leaving_.end(), is_below_at);
  std::size_t kept = 0;
  for (std::uint32_t e : leaving_) {
    const std::uint32_t before = kept > 0 ? leaving_[kept - 1] : kNone;
    if (before == kNone || orientation(points_[point], points_[edges_[before].high], points_[edges_[e].high]) != 0) {
      leaving_[kept++] = e;
      continue;
    }
    is_planar_ = false;
    const std::uint32_t middle = edges_[before].high;
    if (middle == edges_[e].high) {  // a pair: both become points, which the next pass drops
      edges_[before].high = edges_[e].high = point;
      --kept;
      continue;
    }
    // The next pass meets this part and `before` as a pair.
    splits_.push_back({e, middle});
  }
  leaving_.resize(kept);
}

void PlanarSweep::visit(std::uint32_t point) {
  const auto first = status_.lower_bound(Key{point});
  auto last = first;
  while (last != status_.end() && side(*last, point) == 0) ++last;
  const std::uint32_t below = first == status_.begin() ? kNone : *std::prev(first),
                      above = last == status_.end() ? kNone : *last;
  take_arriving(point, first, last);
  take_leaving(point);
  if (is_planar_) advance_chains(point, below);
  status_.erase(first, last);
  for (std::uint32_t e : leaving_) is_planar_ &= status_.insert(e).second;
  if (leaving_.empty() && arriving_.empty()) return;
  if (leaving_.empty()) return split_where_crossing(below, above, point);
  split_where_crossing(below, leaving_.front(), point);
  split_where_crossing(leaving_.back(), above, point);
}

void PlanarSweep::split_where_crossing(std::uint32_t a, std::uint32_t b, std::uint32_t now) {
  if (a == kNone || b == kNone) return;
  const Edge p = edges_[a], q = edges_[b];
  if (side(a, q.low) * side(a, q.high) >= 0 || side(b, p.low) * side(b, p.high) >= 0) return;
  is_planar_ = false;
  std::uint32_t near = end_on(p, q);
  if (near != kNone) note_equal(p, near);
  if (near == kNone && (near = end_on(q, p)) != kNone) note_equal(q, near);
  const std::size_t point_count = points_.size();
  const std::uint32_t at =
      near != kNone ? near : point_at(crossing_of(points_[p.low], points_[p.high], points_[q.low], points_[q.high]));
  if (at >= point_count) crossings_.push_back({at, {p.corner, q.corner}});
  split(a, at, now);
  split(b, at, now);
}

// Returns an end of `edge` that lies within two roundings of `line` and between its ends; kNone: none. Edges a rounding
// apart would cross again next to every rounded crossing.
std::uint32_t PlanarSweep::end_on(const Edge& line, const Edge& edge) const {
  const Vec2 &a = points_[line.low], &b = points_[line.high];
  const double u = static_cast<double>(b.x) - static_cast<double>(a.x),
               v = static_cast<double>(b.y) - static_cast<double>(a.y), square = u * u + v * v;
  const double bound = two_roundings(a.x, b.x) * std::fabs(v) + two_roundings(a.y, b.y) * std::fabs(u);
  for (std::uint32_t end : {edge.low, edge.high}) {
    const Vec2& p = points_[end];
    const double along = (static_cast<double>(p.x) - static_cast<double>(a.x)) * u +
                         (static_cast<double>(p.y) - static_cast<double>(a.y)) * v;
    if (along > 0 && along < square && std::fabs(area_twice(a, b, p)) <= bound) return end;
  }
  return kNone;
}

// Notes that the point and an end of the edge are equal, if they are at most two roundings apart.
void PlanarSweep::note_equal(const Edge& edge, std::uint32_t point) {
  const Vec2& p = points_[point];
  for (std::uint32_t end : {edge.low, edge.high}) {
    const Vec2& q = points_[end];
    if (std::fabs(static_cast<double>(p.x) - static_cast<double>(q.x)) <= two_roundings(p.x, q.x) &&
        std::fabs(static_cast<double>(p.y) - static_cast<double>(q.y)) <= two_roundings(p.y, q.y))
      equal_.push_back({point, end});
  }
}

// Splits at once if the sweep has not yet reached the point, else in the next pass.
void PlanarSweep::split(std::uint32_t e, std::uint32_t point, std::uint32_t now) {
  const Edge edge = edges_[e];
  if (point == edge.low || point == edge.high || edge.is_split) return;
  if (comes_before(now, point) && comes_before(edge.low, point) && comes_before(point, edge.high)) {
    edges_[e].high = point;
    add_edge(point, edge.high, edge.corner);
  } else {
    edges_[e].is_split = true;
    splits_.push_back({e, point});
  }
}

// Closes the intervals between arriving edges and opens those between leaving edges; the intervals below and above the
// point add it to their chains.
void PlanarSweep::advance_chains(std::uint32_t point, std::uint32_t below) {
  bool inside = below != kNone && edges_[below].inside_above;
  Chain high = {};
  if (inside && arriving_.empty() && !leaving_.empty()) high = take_above_recent(&edges_[below].chain);
  for (std::size_t i = 0; i + 1 < arriving_.size(); ++i)
    if (edges_[arriving_[i]].inside_above) close(edges_[arriving_[i]].chain, point);
  if (!arriving_.empty()) high = edges_[arriving_.back()].chain;
  if (inside && (!arriving_.empty() || !leaving_.empty())) push_high(&edges_[below].chain, point);
  const bool inside_top = arriving_.empty() ? inside : edges_[arriving_.back()].inside_above;
  if (leaving_.empty()) {
    if (!inside || !inside_top || arriving_.empty()) return;
    // Both chains end at the point and become one.
    push_low(&high, point);
    Chain& low = edges_[below].chain;
    const std::uint32_t second = nodes_[high.low].above;
    nodes_[low.high].above = second;
    if (second != kNone) nodes_[second].below = low.high, low.high = high.high;
    return;
  }
  for (std::uint32_t e : leaving_) {
    inside = !inside;
    edges_[e].inside_above = inside;
    if (!inside) continue;
    if (e == leaving_.back()) {
      push_low(&high, point);
      edges_[e].chain = high;
    } else {
      const std::uint32_t node = add_node(point);
      edges_[e].chain = {node, node, node};
    }
  }
}

std::uint32_t PlanarSweep::add_node(std::uint32_t point) {
  nodes_.push_back({point, kNone, kNone});
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

// Cuts off the triangles visible from the point at the chain's upper end.
void PlanarSweep::push_high(Chain* chain, std::uint32_t point) {
  std::uint32_t last = chain->high;
  for (std::uint32_t before; (before = nodes_[last].below) != kNone; last = before) {
    const std::uint32_t a = nodes_[before].point, b = nodes_[last].point;
    if (orientation(points_[a], points_[point], points_[b]) <= 0) break;
    emit(a, point, b);
  }
  const std::uint32_t node = add_node(point);
  nodes_[node].below = last;
  nodes_[last].above = node;
  chain->high = chain->recent = node;
}

void PlanarSweep::push_low(Chain* chain, std::uint32_t point) {
  std::uint32_t first = chain->low;
  for (std::uint32_t after; (after = nodes_[first].above) != kNone; first = after) {
    const std::uint32_t a = nodes_[first].point, b = nodes_[after].point;
    if (orientation(points_[a], points_[point], points_[b]) <= 0) break;
    emit(a, point, b);
  }
  const std::uint32_t node = add_node(point);
  nodes_[node].above = first;
  nodes_[first].below = node;
  chain->low = chain->recent = node;
}

// A point without arriving edges sees the chain's most recent one; both parts keep that one.
PlanarSweep::Chain PlanarSweep::take_above_recent(Chain* chain) {
  const std::uint32_t copy = add_node(nodes_[chain->recent].point), above = nodes_[chain->recent].above;
  Chain upper = {copy, copy, copy};
  if (above != kNone) {
    nodes_[copy].above = above, nodes_[above].below = copy;
    upper.high = chain->high;
  }
  nodes_[chain->recent].above = kNone;
  chain->high = chain->recent;
  return upper;
}

// Makes a fan around the point, which sees the whole chain: concave, with sides on both edges that end here.
void PlanarSweep::close(const Chain& chain, std::uint32_t point) {
  std::uint32_t node = chain.low;
  for (std::uint32_t above; (above = nodes_[node].above) != kNone; node = above)
    emit(nodes_[node].point, point, nodes_[above].point);
}

}  // namespace pocketray
