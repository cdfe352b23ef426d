// Polygons for tests, and their area by another method.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "base/vec3.h"

namespace pocketray {

// Area inside the loop by the even-odd rule: slabs between the abscissas of corners and crossings hold trapezoids.
inline double even_odd_area(const std::vector<Vec2>& loop) {
  struct Segment {
    long double u0, v0, u1, v1;
    long double at(long double u) const { return v0 + (v1 - v0) * ((u - u0) / (u1 - u0)); }
  };
  std::vector<Segment> segments;
  std::vector<long double> cuts;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    cuts.push_back(static_cast<long double>(a.x));
    if (a.x == b.x) continue;
    const bool ordered = a.x < b.x;
    const Vec2 &low = ordered ? a : b, &high = ordered ? b : a;
    segments.push_back({static_cast<long double>(low.x), static_cast<long double>(low.y),
                        static_cast<long double>(high.x), static_cast<long double>(high.y)});
  }
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Segment &a = segments[i], &b = segments[k];
      const long double low = std::max(a.u0, b.u0), high = std::min(a.u1, b.u1);
      if (!(low < high)) continue;
      const long double before = a.at(low) - b.at(low), after = a.at(high) - b.at(high);
      if (before * after < 0) cuts.push_back(low + (high - low) * (before / (before - after)));
    }
  std::sort(cuts.begin(), cuts.end());
  long double area = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const long double middle = (cuts[i] + cuts[i + 1]) / 2;
    std::vector<long double> heights;
    for (const Segment& s : segments)
      if (s.u0 <= cuts[i] && s.u1 >= cuts[i + 1] && s.u0 < middle && middle < s.u1) heights.push_back(s.at(middle));
    std::sort(heights.begin(), heights.end());
    for (std::size_t k = 0; k + 1 < heights.size(); k += 2)
      area += (heights[k + 1] - heights[k]) * (cuts[i + 1] - cuts[i]);
  }
  return static_cast<double>(area);
}

inline double shoelace(const std::vector<Vec2>& loop) {
  long double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    sum += static_cast<long double>(a.x) * static_cast<long double>(b.y) -
           static_cast<long double>(a.y) * static_cast<long double>(b.x);
  }
  return static_cast<double>(sum < 0 ? -sum : sum) / 2;
}

// `tooth_count` teeth side by side; with `across`, one above the other.
inline std::vector<Vec2> comb(int tooth_count, bool across) {
  std::vector<Vec2> loop = {{0, 0}, {static_cast<float>(tooth_count), 0}};
  for (int i = tooth_count; i-- > 0;) {
    loop.push_back({static_cast<float>(i) + 0.5f, 1000});
    loop.push_back({static_cast<float>(i), 1});
  }
  if (across)
    for (Vec2& p : loop) std::swap(p.x, p.y);
  return loop;
}

inline std::vector<Vec2> star(int corner_count, float radius_min, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> radius(radius_min, 1);
  std::vector<Vec2> loop;
  for (int i = 0; i < corner_count; ++i) {
    const double angle = 6.283185307179586 * i / corner_count, r = static_cast<double>(radius(random));
    loop.push_back({static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle))});
  }
  return loop;
}

inline std::vector<Vec2> spiral(int corner_count, double turns) {
  std::vector<Vec2> loop, back;
  for (int i = 0; i < corner_count / 2; ++i) {
    const double angle = 6.283185307179586 * turns * i / (corner_count / 2);
    for (double more : {0.0, 3.0}) {
      const double r = 1 + angle + more;
      (more == 0 ? loop : back)
          .push_back({static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle))});
    }
  }
  loop.insert(loop.end(), back.rbegin(), back.rend());
  return loop;
}

}  // namespace pocketray
