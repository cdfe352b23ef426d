// Share of uniform light that the GGX lobe reflects to the viewer at once: specular · A + grazing · B [Karis 2013,
// "Real shading in Unreal Engine 4", split sum], where A + B is the albedo for F = 1 and B belongs to the rise (1 −
// v·h)⁵. Tabulated from the lobe's samples; ggx_reflects_the_integral_of_its_value holds it to .035, 5e-3 in the root
// mean square.
#pragma once
#include <cmath>
#include <cstdint>

#include "brdf/brdf.h"

namespace pocketray {

constexpr int kGgxAlbedoSide = 12;
// A and B in 1/65535. Rows: √α from 0.1 to 1 in equal steps; columns: √(n·v) from 0 to 1.
constexpr std::uint16_t kGgxAlbedo[kGgxAlbedoSide][kGgxAlbedoSide][2] = {
    {{10502, 54896},
     {8233, 50503},
     {11832, 50545},
     {21648, 43175},
     {33523, 31798},
     {44989, 20456},
     {54324, 11191},
     {60628, 4898},
     {64001, 1530},
     {65271, 262},
     {65524, 11},
     {65535, 0}},
    {{22810, 42684},
     {21220, 41198},
     {20045, 38396},
     {25031, 35384},
     {34700, 28495},
     {45231, 19286},
     {54176, 10874},
     {60393, 4886},
     {63816, 1578},
     {65152, 287},
     {65485, 16},
     {65534, 0}},
    {{33760, 31755},
     {32864, 31034},
     {31247, 28965},
     {32079, 26070},
     {37332, 21995},
     {45377, 16155},
     {53344, 9806},
     {59367, 4702},
     {62947, 1634},
     {64529, 338},
     {65024, 26},
     {65192, 0}},
    {{42394, 23127},
     {41791, 22632},
     {40442, 21152},
     {39950, 18846},
     {41783, 15838},
     {46324, 12099},
     {52204, 7915},
     {57551, 4158},
     {61254, 1613},
     {63241, 394},
     {64084, 42},
     {64414, 1}},
    {{48774, 16749},
     {48213, 16352},
     {47052, 15219},
     {46068, 13454},
     {46128, 11202},
     {47932, 8607},
     {51233, 5861},
     {55081, 3327},
     {58419, 1446},
     {60703, 419},
     {61994, 60},
     {62701, 1}},
    {{53311, 12212},
     {52637, 11873},
     {51367, 10962},
     {50091, 9592},
     {49252, 7901},
     {49326, 6038},
     {50501, 4166},
     {52514, 2476},
     {54826, 1177},
     {56879, 394},
     {58448, 71},
     {59579, 2}},
    {{56467, 9054},
     {55613, 8754},
     {54088, 7997},
     {52378, 6905},
     {50873, 5610},
     {49863, 4242},
     {49544, 2926},
     {49939, 1776},
     {50896, 893},
     {52146, 333},
     {53452, 72},
     {54686, 3}},
    {{58640, 6877},
     {57589, 6606},
     {55617, 5951},
     {53389, 5056},
     {51244, 4039},
     {49391, 3010},
     {47985, 2058},
     {47104, 1256},
     {46760, 651},
     {46888, 261},
     {47389, 64},
     {48161, 3}},
    {{60133, 5379},
     {58830, 5123},
     {56328, 4537},
     {53488, 3781},
     {50658, 2961},
     {48034, 2166},
     {45736, 1460},
     {43840, 887},
     {42385, 465},
     {41379, 194},
     {40812, 53},
     {40652, 3}},
    {{61162, 4345},
     {59560, 4091},
     {56482, 3552},
     {52957, 2894},
     {49390, 2214},
     {46003, 1584},
     {42908, 1048},
     {40164, 629},
     {37798, 330},
     {35822, 141},
     {34237, 41},
     {33035, 3}},
    {{61877, 3624},
     {59933, 3364},
     {56242, 2855},
     {51982, 2265},
     {47656, 1688},
     {43515, 1177},
     {39685, 762},
     {36219, 449},
     {33133, 234},
     {30420, 101},
     {28065, 31},
     {26049, 3}},
    {{62378, 3116},
     {60080, 2847},
     {55724, 2352},
     {50707, 1812},
     {45615, 1311},
     {40751, 889},
     {36259, 561},
     {32197, 324},
     {28574, 167},
     {25373, 72},
     {22563, 23},
     {20108, 2}},
};

// Position between two of the table's rows or columns; x in [0, 1].
template <class T>
struct GgxCell {
  int index;
  T rest;
  explicit GgxCell(T x) {
    T place = (x > 0 ? x < 1 ? x : T(1) : T(0)) * (kGgxAlbedoSide - 1);
    index = static_cast<int>(place);
    if (index > kGgxAlbedoSide - 2) index = kGgxAlbedoSide - 2;
    rest = place - static_cast<T>(index);
  }
};
template <class T>
GgxCell<T> ggx_row(T alpha) {
  return GgxCell<T>((std::sqrt(alpha) - T(0.1)) * T(1 / 0.9));
}
template <class T>
GgxCell<T> ggx_column(T cosine) {
  return GgxCell<T>(std::sqrt(cosine > 0 ? cosine : T(0)));
}

// A or B, or with both the albedo for F = 1.
template <class T, class Entry>
T ggx_between(const GgxCell<T>& row, const GgxCell<T>& column, Entry entry) {
  auto at = [&](int r, int c) { return static_cast<T>(entry(kGgxAlbedo[row.index + r][column.index + c])); };
  T low = at(0, 0) + (at(0, 1) - at(0, 0)) * column.rest, high = at(1, 0) + (at(1, 1) - at(1, 0)) * column.rest;
  return (low + (high - low) * row.rest) * T(1.0 / 65535.0);
}
template <class T>
T ggx_energy(const GgxCell<T>& row, const GgxCell<T>& column) {
  return ggx_between(row, column, [](const std::uint16_t(&e)[2]) { return e[0] + e[1]; });
}

// Loss of a lobe of F = 1 per row: the mean over the hemisphere, 1 − Ē with Ē = 2 ∫ E(μ) μ dμ = 4 ∫ E t³ dt and t = √μ,
// in which E is piecewise linear; and the largest in any direction.
struct GgxRows {
  double lost[kGgxAlbedoSide] = {}, most_lost[kGgxAlbedoSide] = {};
  constexpr GgxRows() {
    constexpr double step = 1.0 / (kGgxAlbedoSide - 1);
    auto energy = [](int r, int c) { return (kGgxAlbedo[r][c][0] + kGgxAlbedo[r][c][1]) / 65535.0; };
    for (int r = 0; r < kGgxAlbedoSide; ++r) {
      lost[r] = 1;
      for (int c = 0; c < kGgxAlbedoSide; ++c) {
        if (1 - energy(r, c) > most_lost[r]) most_lost[r] = 1 - energy(r, c);
        if (c + 1 == kGgxAlbedoSide) break;
        const double a = c * step, b = (c + 1) * step, low = energy(r, c), high = energy(r, c + 1);
        const double slope = (high - low) / step, offset = low - slope * a;
        lost[r] -= offset * (b * b * b * b - a * a * a * a) + 0.8 * slope * (b * b * b * b * b - a * a * a * a * a);
      }
    }
  }
};
inline constexpr GgxRows kGgxRows;

template <class T>
T ggx_between_rows(const GgxCell<T>& row, const double (&values)[kGgxAlbedoSide]) {
  const T low = static_cast<T>(values[row.index]), high = static_cast<T>(values[row.index + 1]);
  return low + (high - low) * row.rest;
}

// Light scattered more than once between microfacets [Kulla & Conty 2017, "Revisiting physically based shading at
// Imageworks", pp. 16–20]: a lobe F (1 − E(n·v)) (1 − E(n·l)) / (π (1 − Ē)), which for F = 1 reflects all that the
// lobe loses. F is the colour of all orders of scattering, from Schlick's mean, specular + (grazing − specular) / 21.
template <class T>
Vec3T<T> ggx_scattered_color(const GgxCell<T>& row, const Vec3T<T>& specular, T grazing) {
  const T lost = ggx_between_rows(row, kGgxRows.lost);
  Vec3T<T> color;
  for (int c = 0; c < 3; ++c) {
    const T mean = specular[c] + (grazing - specular[c]) * T(1.0 / 21);
    color[c] = mean * mean * (1 - lost) / (1 - mean * lost);
  }
  return color;
}

// Shares of light reflected once that scale with the reflectance along the normal and at grazing angles.
template <class T>
struct GgxShares {
  T normal, grazing;
};
template <class T>
GgxShares<T> ggx_shares(T alpha, T cos_viewer) {
  const GgxCell<T> row = ggx_row(alpha), column = ggx_column(cos_viewer);
  return {ggx_between(row, column, [](const std::uint16_t(&e)[2]) { return e[0]; }),
          ggx_between(row, column, [](const std::uint16_t(&e)[2]) { return e[1]; })};
}
template <class T>
Vec3T<T> ggx_albedo_once(const GgxShares<T>& shares, const Vec3T<T>& specular, T grazing) {
  return specular * shares.normal + Vec3T<T>{1, 1, 1} * (grazing * shares.grazing);
}

inline BrdfAlbedo ggx_albedo(float alpha, const Vec3& specular, float grazing, float cos_viewer) {
  const GgxShares<float> shares = ggx_shares(alpha, cos_viewer);
  return {ggx_albedo_once(shares, specular, grazing),
          ggx_scattered_color(ggx_row(alpha), specular, grazing) * (1 - shares.normal - shares.grazing)};
}

}  // namespace pocketray
