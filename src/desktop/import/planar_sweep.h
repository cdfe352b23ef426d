// Triangulates a polygon in the plane by the even-odd rule, in one sweep from left to right [Hertel & Mehlhorn 1983,
// "Fast triangulation of simple polygons"]: each interval between two edges that is inside keeps the chain of corners
// that its next corner will see. Signs of areas are exact, so neither collinear corners nor slivers confuse it. Edges
// that cross, touch or overlap are split and the sweep repeated until none do.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "base/vec3.h"

namespace pocketray {

// Sign of the area of triangle abc, 1 if counter-clockwise. Exact for floats.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

class PlanarSweep {
 public:
  // A point where edges cross; edge i begins at corner i of the loop.
  struct Crossing {
    std::uint32_t point;
    std::uint32_t edges[2];
  };

  PlanarSweep() = default;
  PlanarSweep(const PlanarSweep&) = delete;
  PlanarSweep& operator=(const PlanarSweep&) = delete;

  // Triangulates the closed loop, once; returns false if its edges cross more than `crossing_count_max` times. Takes
  // O(n log n) time for n corners and crossings.
  bool triangulate(const std::vector<Vec2>& loop, std::size_t crossing_count_max);

  const std::vector<Vec2>& points() const { return points_; }  // distinct
  const std::vector<std::uint32_t>& points_of_corners() const { return points_of_corners_; }
  const std::vector<Crossing>& crossings() const { return crossings_; }
  // Three points per triangle, counter-clockwise; every corner on a triangle's edge is a corner of that triangle.
  const std::vector<std::uint32_t>& triangles() const { return triangles_; }

 private:
  struct Chain {
    std::uint32_t low, high, recent;  // nodes; the first ends the interval's lower edge, the last its upper edge
  };
  struct Node {
    std::uint32_t point, below, above;
  };
  struct Edge {
    std::uint32_t low, high;  // points, in the order of the sweep
    std::uint32_t corner;     // at which it begins in the loop
    std::uint32_t next_out;   // next edge that begins at this point
    bool inside_above, is_split;
    Chain chain;  // of the interval above, if that is inside
  };
  struct Split {
    std::uint32_t edge, point;
  };
  struct Leftmost {
    bool operator()(const Vec2& a, const Vec2& b) const { return a.x != b.x ? a.x < b.x : a.y < b.y; }
  };
  struct Key {
    std::uint32_t point;
  };
  // Active edges from below; a point is above the edges below it.
  struct Below {
    using is_transparent = void;
    const PlanarSweep* sweep;
    bool operator()(std::uint32_t a, std::uint32_t b) const { return sweep->is_below(a, b); }
    bool operator()(std::uint32_t edge, Key key) const { return sweep->side(edge, key.point) > 0; }
    bool operator()(Key key, std::uint32_t edge) const { return sweep->side(edge, key.point) < 0; }
  };
  using Status = std::set<std::uint32_t, Below>;

  std::uint32_t point_at(const Vec2& p);
  bool comes_before(std::uint32_t a, std::uint32_t b) const { return Leftmost()(points_[a], points_[b]); }
  int side(std::uint32_t edge, std::uint32_t point) const;
  bool is_below(std::uint32_t a, std::uint32_t b) const;

  void cancel_pairs();
  bool pass();
  void begin_pass();
  void end_pass();
  void unite_equal_points();
  void visit(std::uint32_t point);
  void take_arriving(std::uint32_t point, Status::iterator first, Status::iterator last);
  void take_leaving(std::uint32_t point);
  void add_edge(std::uint32_t low, std::uint32_t high, std::uint32_t corner);
  void split_where_crossing(std::uint32_t a, std::uint32_t b, std::uint32_t now);
  std::uint32_t end_on(const Edge& line, const Edge& edge) const;
  void note_equal(const Edge& edge, std::uint32_t point);
  void split(std::uint32_t edge, std::uint32_t point, std::uint32_t now);

  void advance_chains(std::uint32_t point, std::uint32_t below);
  std::uint32_t add_node(std::uint32_t point);
  void push_high(Chain* chain, std::uint32_t point);
  void push_low(Chain* chain, std::uint32_t point);
  Chain take_above_recent(Chain* chain);
  void close(const Chain& chain, std::uint32_t point);
  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles_.insert(triangles_.end(), {a, b, c}); }

  std::vector<Vec2> points_;
  std::vector<std::uint32_t> points_of_corners_, triangles_;
  std::vector<Crossing> crossings_;
  std::map<Vec2, std::uint32_t, Leftmost> order_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_out_;  // by point
  std::vector<Node> nodes_;
  std::vector<Split> splits_;                      // for the next pass
  std::vector<std::uint32_t> arriving_, leaving_;  // edges at the point visited, from below
  Status status_{Below{this}};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> equal_;  // points to merge in the next pass
  std::size_t edge_count_max_ = 0;
  bool is_planar_ = true;  // so far in this pass: no edges cross, touch or overlap
};

}  // namespace pocketray
