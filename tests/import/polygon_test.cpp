// Triangles of concave polygons (HARDCASES row 68).
#include "desktop/import/polygon.h"

#include <chrono>
#include <map>
#include <utility>

#include "import/import_testing.h"
#include "import/polygon_testing.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

using Loop = std::vector<Vec2>;

struct NamedLoop {
  const char* name;
  Loop loop;
};
const std::vector<NamedLoop>& loops() {
  static const std::vector<NamedLoop> kLoops = {
      {"C", {{-1, -1}, {1, -1}, {1, -.5f}, {-.5f, -.5f}, {-.5f, .5f}, {1, .5f}, {1, 1}, {-1, 1}}},
      {"door", {{-1, 1}, {-1, -1}, {-.3f, -1}, {-.3f, .2f}, {.3f, .2f}, {.3f, -1}, {1, -1}, {1, 1}}},
      {"collinear", {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {3, 3}, {2, 3}, {1, 3}, {0, 3}, {0, 2}, {0, 1}}},
      {"triangle of many", {{0, 0}, {1, 0}, {2, 0}, {4, 0}, {3, 1}, {2, 2}, {1, 3}, {0, 4}, {0, 3}, {0, 1}}},
      {"keyhole", {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}},
      {"keyhole along a side",
       {{0, 0}, {2, 0}, {2, 1}, {1, 2}, {2, 3}, {3, 2}, {2, 1}, {2, 0}, {4, 0}, {4, 4}, {0, 4}}},
      {"twice", {{0, 0}, {2, 0}, {2, 0}, {2, 2}, {1, 1}, {1, 1}, {0, 2}, {0, 2}}},
      {"touching itself", {{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}},
      {"touching its side", {{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}},
      {"spike", {{0, 0}, {4, 0}, {4, 4}, {4, 6}, {4, 4}, {0, 4}}},
      {"bow-tie", {{0, 0}, {2, 2}, {2, 0}, {0, 2}}},
      {"pentagram", {{0, 1}, {.5878f, -.809f}, {-.9511f, .309f}, {.9511f, .309f}, {-.5878f, -.809f}}},
      {"twice around", {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {4, 0}, {4, 4}, {0, 4}}},
      {"overlapping sides", {{0, 0}, {3, 0}, {3, 1}, {2, 0}, {1, 0}, {1, 2}, {0, 2}}},
      {"line", {{0, 0}, {1, 1}, {2, 2}, {1, 1}}},
      {"comb", comb(20, false)},
      {"comb across", comb(20, true)},
      {"star", star(60, .1f, 1)},
      {"spiral", spiral(60, 3)}};
  return kLoops;
}

double area_of(const std::vector<Vec3>& positions, const PolygonTriangles& made) {
  std::vector<Vec3d> all;
  for (const Vec3& p : positions) all.push_back(to_double(p));
  for (const PolygonCrossing& c : made.crossings) {
    const Vec3d a = all[c.edges[0]], b = all[(c.edges[0] + 1) % positions.size()];
    all.push_back(a + (b - a) * static_cast<double>(c.along[0]));
  }
  double area = 0;
  for (std::size_t t = 0; t < made.corners.size(); t += 3) {
    const Vec3d &a = all[made.corners[t]], &b = all[made.corners[t + 1]], &c = all[made.corners[t + 2]];
    const Vec3d n = cross(b - a, c - a);
    area += std::sqrt(dot(n, n)) / 2;
  }
  return area;
}

std::vector<Vec3> flat(const Loop& loop) {
  std::vector<Vec3> positions;
  for (const Vec2& p : loop) positions.push_back({p.x, p.y, 0});
  return positions;
}

Loop rotated(const Loop& loop, std::size_t first, bool reversed) {
  Loop result;
  for (std::size_t i = 0; i < loop.size(); ++i) result.push_back(loop[(first + i) % loop.size()]);
  if (reversed) std::reverse(result.begin(), result.end());
  return result;
}

using Sides = std::map<std::pair<std::pair<float, float>, std::pair<float, float>>, int>;
void add_side(const Vec2& a, const Vec2& b, int times, Sides* sides) {
  const std::pair<float, float> p = {a.x, a.y}, q = {b.x, b.y};
  if (p == q) return;
  int& count = (*sides)[std::minmax(p, q)];
  count += times;
}

// Sides of odd number: those of the triangles, if each inner one has two; those of the polygon by the even-odd rule.
std::vector<Sides::key_type> odd_sides(const Sides& sides) {
  std::vector<Sides::key_type> odd;
  for (const auto& side : sides)
    if (side.second % 2) odd.push_back(side.first);
  return odd;
}

}  // namespace

// Goal: the area is right for every first corner, both windings and any plane; triangles turn as the polygon does.
// Method: the exact area of polygons that break fans and ear clippers, in 40 planes each.
TEST_CASE("hard_68_polygons_have_the_area_of_the_even_odd_rule") {
  std::mt19937 random(68);
  std::uniform_real_distribution<float> any(-1, 1);
  for (const NamedLoop& named : loops()) {
    CAPTURE(named.name);
    const double truth = even_odd_area(named.loop);
    for (std::size_t first = 0; first < named.loop.size(); ++first)
      for (bool reversed : {false, true}) {
        const Loop loop = rotated(named.loop, first, reversed);
        PolygonTriangles made;
        REQUIRE(triangulate_polygon(flat(loop), &made));
        CHECK(area_of(flat(loop), made) == doctest::Approx(truth).epsilon(1e-6));
        const Vec3 u = {any(random), any(random), any(random)}, v = {any(random), any(random), any(random)};
        const Vec3d n = cross(to_double(u), to_double(v));
        std::vector<Vec3> tilted;
        for (const Vec2& p : loop) tilted.push_back(u * p.x + v * p.y + Vec3{.25f, .5f, .125f});
        REQUIRE(triangulate_polygon(tilted, &made));
        const double scale = std::sqrt(dot(n, n)), bound = 1e-6 * (truth + 16) * std::max(scale, 0.1);
        CHECK(std::fabs(area_of(tilted, made) - truth * scale) < bound);
      }
  }
}

// Goal: the area is right where a fan, which renderers make of polygons, is wrong. Method: these polygons from every
// corner, both ways.
TEST_CASE("hard_68_polygons_by_an_ordinary_fan") {
  struct Shape {
    std::vector<Vec3> corners;
    double area;
  };
  std::vector<Shape> shapes;
  for (const NamedLoop& named : loops())
    for (std::size_t first = 0; named.loop.size() < 100 && first < named.loop.size(); ++first)
      for (bool reversed : {false, true})
        shapes.push_back({flat(rotated(named.loop, first, reversed)), even_odd_area(named.loop)});
  auto by_ours = [](const Shape& shape) {
    PolygonTriangles made;
    return triangulate_polygon(shape.corners, &made) ? area_of(shape.corners, made) : -1;
  };
  auto by_fan = [](const Shape& shape) {
    PolygonTriangles fan;
    for (std::uint32_t i = 2; i < shape.corners.size(); ++i)
      for (std::uint32_t corner : {0u, i - 1, i}) fan.corners.push_back(corner);
    return area_of(shape.corners, fan);
  };
  auto is_wrong = [](const Shape& shape, double area) {
    return !(std::fabs(area - shape.area) <= 1e-6 * (1 + shape.area));
  };
  const Answers ours = time_answers(shapes, by_ours, is_wrong), fan = time_answers(shapes, by_fan, is_wrong);
  CHECK(ours.wrong == 0);
  CHECK(fan.wrong > 0);
  count_beside("fan from the first corner", "polygon", shapes.size(), fan, ours);
  count_hard(shapes.size(), ours.wrong, "the even-odd area within 1e-6");
}

// Goal: neighbours of a polygon leave no gap: the sides of its triangles that are not shared are its own, also where
// corners lie on a line. Method: sides of odd number, of polygons whose sides do not cross.
TEST_CASE("hard_68_triangles_of_polygons_share_their_sides") {
  for (const NamedLoop& named : loops()) {
    const std::string name = named.name;
    if (name == "bow-tie" || name == "pentagram" || name == "touching its side" || name == "overlapping sides")
      continue;
    CAPTURE(named.name);
    for (std::size_t first = 0; first < named.loop.size(); ++first) {
      const Loop loop = rotated(named.loop, first, first % 2);
      PolygonTriangles made;
      REQUIRE(triangulate_polygon(flat(loop), &made));
      Sides own, given;
      for (std::size_t i = 0; i < loop.size(); ++i) add_side(loop[i], loop[(i + 1) % loop.size()], 1, &given);
      for (std::size_t t = 0; t < made.corners.size(); t += 3) {
        const Vec2 &a = loop[made.corners[t]], &b = loop[made.corners[t + 1]], &c = loop[made.corners[t + 2]];
        const bool is_repeated = loop[made.corners[t]].x == b.x && loop[made.corners[t]].y == b.y;
        CHECK(((b.x - a.x) * (c.y - a.y) == (b.y - a.y) * (c.x - a.x)) == is_repeated);
        add_side(a, b, 1, &own), add_side(b, c, 1, &own), add_side(c, a, 1, &own);
      }
      CHECK(odd_sides(own) == odd_sides(given));
    }
  }
}

// Goal: no polygon is too tangled. Method: 4,000 random loops, half of them on a lattice of few points, where sides
// overlap, touch and cross at corners; slivers, and sizes from 1e-12 to 1e12; the area by slabs.
TEST_CASE("hard_68_random_loops_have_the_area_of_the_even_odd_rule") {
  std::mt19937 random(1968);
  for (int i = 0; i < 4000; ++i) {
    const int corner_count = 3 + static_cast<int>(random() % 24);
    const bool on_lattice = i % 2;
    const float size = std::pow(10.0f, static_cast<float>(static_cast<int>(random() % 25)) - 12);
    const float height = i % 8 == 0 ? size * 1e-5f : size;
    auto coordinate = [&] {
      return on_lattice ? static_cast<float>(random() % 6) : static_cast<float>(random() % 65536) / 65536.0f;
    };
    Loop loop;
    for (int k = 0; k < corner_count; ++k) {
      const float u = coordinate();
      loop.push_back({u * size, coordinate() * height});
    }
    CAPTURE(i);
    PolygonTriangles made;
    REQUIRE(triangulate_polygon(flat(loop), &made));
    const double whole = static_cast<double>(size) * static_cast<double>(height) * (on_lattice ? 25 : 1);
    CHECK(std::fabs(area_of(flat(loop), made) - even_odd_area(loop)) < 2e-6 * whole);
  }
}

// Goal: time grows with n log n. Method: polygons of 200,000 corners, the worst for fans, ear clippers and sweeps with
// lists; one that crosses itself some 10⁹ times is refused.
TEST_CASE("hard_68_polygons_of_many_corners_take_little_time") {
  const std::vector<NamedLoop> kLarge = {{"round", star(200000, 1, 1)},
                                         {"star", star(200000, .2f, 1)},
                                         {"comb", comb(100000, false)},
                                         {"comb across", comb(100000, true)},
                                         {"spiral", spiral(200000, 50)}};
  for (const NamedLoop& named : kLarge) {
    CAPTURE(named.name);
    const auto begin = std::chrono::steady_clock::now();
    PolygonTriangles made;
    REQUIRE(triangulate_polygon(flat(named.loop), &made));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    MESSAGE(named.name << ": " << seconds << " s");
    CHECK(made.corners.size() == 3 * (named.loop.size() - 2));
    CHECK(area_of(flat(named.loop), made) == doctest::Approx(shoelace(named.loop)).epsilon(1e-6));
    CHECK(seconds < 20);  // 2 s at rest; sanitizers and busy machines take more
  }
  std::mt19937 random(9);
  Loop tangle;
  for (int i = 0; i < 100000; ++i)
    tangle.push_back({static_cast<float>(random() % 65536), static_cast<float>(random() % 65536)});
  tangle.resize(20000);
  PolygonTriangles made;
  CHECK_FALSE(triangulate_polygon(flat(tangle), &made));
}

namespace {

struct LargePolygon {
  std::vector<Vec3> corners;
  double area;
};
std::vector<LargePolygon> large_polygons(int corner_count) {
  std::vector<LargePolygon> polygons;
  for (const Loop& loop : {star(corner_count, .2f, 1), star(corner_count, .9f, 2), comb(corner_count / 2 - 1, false),
                           comb(corner_count / 2 - 1, true), spiral(corner_count, corner_count / 4000.0)})
    polygons.push_back({flat(loop), shoelace(loop)});
  return polygons;
}

double fan_area(const LargePolygon& polygon) {
  PolygonTriangles fan;
  for (std::uint32_t i = 2; i < polygon.corners.size(); ++i) fan.corners.insert(fan.corners.end(), {0u, i - 1, i});
  return area_of(polygon.corners, fan);
}

// [Meisters 1975]: cuts off corners whose triangle holds no other, until three are left.
double clipped_ears_area(const LargePolygon& polygon) {
  const std::vector<Vec3>& p = polygon.corners;
  auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return (double(p[b].x) - double(p[a].x)) * (double(p[c].y) - double(p[a].y)) -
           (double(p[b].y) - double(p[a].y)) * (double(p[c].x) - double(p[a].x));
  };
  double twice = 0;
  for (std::uint32_t i = 1; i + 1 < p.size(); ++i) twice += turn(0, i, i + 1);
  std::vector<std::uint32_t> left(p.size());
  for (std::uint32_t i = 0; i < left.size(); ++i)
    left[i] = twice > 0 ? i : static_cast<std::uint32_t>(p.size()) - 1 - i;
  PolygonTriangles made;
  std::size_t at = 0, failed = 0;
  while (left.size() > 2 && failed < left.size()) {
    const std::size_t count = left.size();
    const std::uint32_t a = left[(at + count - 1) % count], b = left[at % count], c = left[(at + 1) % count];
    bool is_ear = turn(a, b, c) > 0;
    for (std::size_t i = 0; is_ear && i < count; ++i)
      is_ear = left[i] == a || left[i] == b || left[i] == c ||
               !(turn(a, b, left[i]) >= 0 && turn(b, c, left[i]) >= 0 && turn(c, a, left[i]) >= 0);
    if (!is_ear) {
      ++at, ++failed;
      continue;
    }
    made.corners.insert(made.corners.end(), {a, b, c});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(at % count));
    failed = 0;
  }
  return area_of(p, made);
}

}  // namespace

// Goal: a polygon of 10⁵ corners is right and takes a fraction of a second, where a fan is wrong and clipping ears
// takes time that grows with the square. Method: stars, combs and a spiral; ears of polygons that they can finish.
TEST_CASE("hard_68_polygons_of_100000_corners_by_ordinary_triangulations") {
  auto by_ours = [](const LargePolygon& polygon) {
    PolygonTriangles made;
    return triangulate_polygon(polygon.corners, &made) ? area_of(polygon.corners, made) : -1;
  };
  auto is_wrong = [](const LargePolygon& polygon, double area) {
    return !(std::fabs(area - polygon.area) <= 1e-6 * polygon.area);
  };
  const std::vector<LargePolygon> large = large_polygons(gate_share(10000, 100000)),
                                  small = large_polygons(gate_share(600, 10000));
  auto corners = [](const std::vector<LargePolygon>& polygons) {
    return "polygon of " + std::to_string(polygons[0].corners.size()) + " corners";
  };
  const Answers ours = time_answers(large, by_ours, is_wrong), fan = time_answers(large, fan_area, is_wrong);
  const Answers ours_of_small = time_answers(small, by_ours, is_wrong),
                ears = time_answers(small, clipped_ears_area, is_wrong);
  CHECK(ours.wrong + ours_of_small.wrong == 0);
  CHECK(fan.wrong > 0);
  count_beside("fan from the first corner", corners(large).c_str(), large.size(), fan, ours);
  count_beside("ear clipping", corners(small).c_str(), small.size(), ears, ours_of_small);
  count_hard(large.size() + small.size(), ours.wrong + ours_of_small.wrong, "the area within 1e-6");
}

// Goal: very many corners at one place take little time, too. Method: a flower whose 50,000 petals meet in the middle,
// and a corner that is named 100,000 times before the rest of a fan.
TEST_CASE("hard_68_many_corners_at_one_place_take_little_time") {
  Loop flower;
  for (int i = 0; i < 50000; ++i) {
    flower.push_back({0, 0});
    for (double part : {0.1, 0.9}) {
      const double angle = 6.283185307179586 * (i + part) / 50000;
      flower.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))});
    }
  }
  Loop fan(100000, Vec2{0, 0});
  for (int i = 0; i < 100000; ++i) {
    const double angle = 3.0 * i / 100000, radius = i % 2 ? 1 : 0.9;
    fan.push_back({static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))});
  }
  for (const Loop& loop : {flower, fan}) {
    PolygonTriangles made;
    const auto begin = std::chrono::steady_clock::now();
    REQUIRE(triangulate_polygon(flat(loop), &made));
    CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 20);
    CHECK(area_of(flat(loop), made) == doctest::Approx(shoelace(loop)).epsilon(1e-6));
  }
}

// Goal: corners at one place keep their own attributes. Method: a square with a keyhole whose slit is at corners 0 and
// 4 and at 5 and 9: each triangle with such a corner has the one on its side.
TEST_CASE("polygon_corners_at_one_place_are_told_apart") {
  const Loop loop = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
  PolygonTriangles made;
  REQUIRE(triangulate_polygon(flat(loop), &made));
  REQUIRE(made.corners.size() == 24);
  for (std::size_t t = 0; t < 24; t += 3) {
    Vec2 middle = {0, 0};
    for (std::size_t k = 0; k < 3; ++k)
      middle.x += loop[made.corners[t + k]].x / 3, middle.y += loop[made.corners[t + k]].y / 3;
    const bool below = middle.x > middle.y;  // the slit is on the diagonal
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = made.corners[t + k];
      if (corner == 0 || corner == 9) CHECK(below);
      if (corner == 4 || corner == 5) CHECK_FALSE(below);
    }
  }
}

// Goal: where a polygon crosses itself, the new vertex has the mean attributes of both sides.
TEST_CASE("polygon_crossings_have_mean_attributes") {
  SceneBuilder builder;
  MeshData mesh;
  mesh.positions = {{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 0}, {0, 1}};
  mesh.colors = {{0, 0, 0, 65535}, {65534, 0, 0, 65535}, {0, 0, 0, 65535}, {0, 0, 0, 65535}};
  append_polygon({0, 1, 2, 3}, &mesh, &builder);
  REQUIRE(mesh.positions.size() == 5);
  CHECK(mesh.indices.size() == 6);
  CHECK(mesh.positions[4] == Vec3{1, 1, 0});
  CHECK((mesh.uvs[4].x == 0.25f && mesh.uvs[4].y == 0.25f));
  CHECK((mesh.colors[4].r == 16384 && mesh.colors[4].a == 65535));
}
