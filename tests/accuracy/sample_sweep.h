// A made-up sweep that looks like a real one.
#pragma once
#include <cmath>

#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/result.h"

namespace pocketray {

inline Levels sample_picture(std::uint32_t width, std::uint32_t height, int shift) {
  Levels picture = {width, height, {}};
  for (std::uint32_t i = 0; i < 3 * width * height; ++i)
    picture.rgb.push_back(static_cast<std::uint8_t>((i * 7 + static_cast<std::uint32_t>(shift)) % 251));
  return picture;
}

inline Measured sample_measured(const std::string& knob, const std::string& value, double ns_per_pixel, double flip) {
  Measured m;
  m.knob = knob, m.value = value;
  m.ns_per_pixel = {ns_per_pixel, 0.97 * ns_per_pixel, 1.04 * ns_per_pixel};
  m.time_ratio = {ns_per_pixel / 40, 0.97 * ns_per_pixel / 40, 1.04 * ns_per_pixel / 40};
  m.model.flip = flip, m.truth.flip = flip, m.flip_before = 0.9 * flip;
  m.errors = {0.8 * flip, 2 * flip,    4 * flip,
              9 * flip,   -0.1 * flip, flip > 0 ? -20 * std::log10(0.8 * flip) : INFINITY};
  return m;
}

// Makes the standard error of the difference against the model that large.
inline void set_noise(double error, Measured* a, Measured* b) {
  const auto half = static_cast<float>(error);
  a->model.one = {half}, a->model.other = {-half};
  b->model.one = b->model.other = {0};
}

// Likewise between all configurations, which get a block each for noise of their own.
inline void set_noise(double error, Sweep* sweep) {
  for (std::size_t i = 0; i < sweep->measured.size(); ++i) {
    std::vector<float> one(sweep->measured.size()), other(one.size());
    one[i] = static_cast<float>(error * static_cast<double>(one.size()) / std::sqrt(2.0)), other[i] = -one[i];
    sweep->measured[i].model.one = one, sweep->measured[i].model.other = other;
  }
}

inline StripRow sample_row(const std::string& label, const Levels& reference, int shift) {
  std::vector<float> map(std::size_t{reference.width} * reference.height);
  for (std::size_t i = 0; i < map.size(); ++i) map[i] = static_cast<float>(i) / static_cast<float>(map.size() - 1);
  return {label, 3.1, 0.0421, sample_picture(reference.width, reference.height, shift), map};
}

// Adds a knob with `values` values; errors fall as time rises.
inline void add_knob(Sweep* sweep, const std::string& name, int values, double ms_per_flip) {
  KnobFigures knob;
  knob.name = name, knob.what = "what " + name + " turns", knob.effect = "shadow", knob.ms_per_flip = ms_per_flip;
  Strip strip = {name, {}};
  for (int i = 0; i < values; ++i) {
    Measured m = sample_measured(name, std::to_string(1 << i), 40 << i, 0.08 / (1 << i));
    m.is_default = i == 0;
    sweep->measured.push_back(m);
    strip.rows.push_back(sample_row(name + " " + m.value, sweep->reference_picture, 3 * i));
  }
  if (values >= 3) knob.has_slope = true, knob.slope = {-0.5, -0.6, -0.4}, knob.theory = "Monte Carlo -1/2";
  sweep->knobs.push_back(knob);
  sweep->strips.push_back(strip);
}

// Adds the knob of rows from render servers, which costs no time.
inline void add_sent_knob(Sweep* sweep) {
  add_knob(sweep, "near-lossless", 2, kNotMeasured);
  Measured *on = &sweep->measured[sweep->measured.size() - 2], *off = &sweep->measured.back();
  const double time = sweep->measured.front().ns_per_pixel.value;
  *on = sample_measured("near-lossless", "on", time, 0.09), on->bytes_per_frame = 2500;
  *off = sample_measured("near-lossless", "off", time, 0.08), off->bytes_per_frame = 4000, off->is_default = true;
}

// Gives each configuration a method of indirect light in turn, and errors against the truth that differ.
inline void add_methods(Sweep* sweep) {
  constexpr const char* kMethods[] = {"radiosity", "none", "instant-radiosity"};
  for (std::size_t i = 0; i < sweep->measured.size(); ++i) {
    Measured* m = &sweep->measured[i];
    m->indirect = kMethods[i % 3], m->truth.flip = 0.1 + 0.5 * m->model.flip;
  }
}

inline void mark_front(Sweep* sweep) {
  for (const Measured* m : front_of(*sweep, sweep->judge))
    sweep->measured[static_cast<std::size_t>(m - sweep->measured.data())].pareto = true;
}

inline Sweep empty_sweep() {
  Sweep sweep;
  sweep.scene = "cornell", sweep.machine = "2 threads, avx2", sweep.output = "rgb565 dithered";
  sweep.width = 32, sweep.height = 24, sweep.rounds = 15, sweep.pixels_per_degree = 23.6;
  sweep.model = {4096, 0.0003, 0.0004}, sweep.truth = {256, 0.02, 0.03};
  sweep.reference_picture = sample_picture(32, 24, 0);
  sweep.measured = {sample_measured("baseline", "", 40, 0.08)};
  return sweep;
}

inline Sweep sample_sweep() {
  Sweep sweep = empty_sweep();
  add_knob(&sweep, "samples", 5, 2.4);
  add_knob(&sweep, "area-lights", 4, 0.7);
  add_knob(&sweep, "normals", 2, -0.2);
  sweep.measured.push_back(sample_measured("several", "samples 2, normals 2", 90, 0.03));
  sweep.measured.back().instructions_per_pixel = 512;
  mark_front(&sweep);
  return sweep;
}

}  // namespace pocketray
