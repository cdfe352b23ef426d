#include "desktop/accuracy/csv.h"

#include <cmath>
#include <cstdio>

namespace pocketray {
namespace {

std::string number(double value) {
  if (std::isnan(value)) return "";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string result = "\"";
  for (char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

std::string sweep_csv(const Sweep& sweep) {
  std::string csv =
      "knob,value,ns_per_pixel,ns_per_pixel_low,ns_per_pixel_high,flip_model,rmse,rel_mse,p99,max,bias,psnr,pareto,"
      "flip_before,time_ratio,time_ratio_low,time_ratio_high,instructions_per_pixel,bytes_per_frame,default,missing,"
      "note,flip_truth,flip_rgb565,flip_rgb565_dithered,flip_rgb888,stored_bytes,bake_seconds,indirect\n";
  for (const Measured& m : sweep.measured) {
    bool there = m.missing.empty();
    const double figures[] = {m.ns_per_pixel.value, m.ns_per_pixel.low, m.ns_per_pixel.high, m.model.flip,
                              m.errors.rmse,        m.errors.rel_mse,   m.errors.p99,        m.errors.max,
                              m.errors.bias,        m.errors.psnr};
    csv += csv_field(m.knob) + ',' + csv_field(m.value);
    for (double figure : figures) csv += ',' + (there ? number(figure) : "");
    csv += there ? m.pareto ? ",1" : ",0" : ",";
    const double further[] = {m.flip_before,     m.time_ratio.value,       m.time_ratio.low,
                              m.time_ratio.high, m.instructions_per_pixel, m.bytes_per_frame};
    for (double figure : further) csv += ',' + (there ? number(figure) : "");
    csv += std::string(m.is_default ? ",1," : ",0,") + csv_field(m.missing) + ',' + csv_field(m.note) + ',' +
           (there ? number(m.truth.flip) : "");
    for (double flip : m.flip_as) csv += ',' + (there ? number(flip) : "");
    for (double figure : {m.stored_bytes, m.bake_seconds}) csv += ',' + (there ? number(figure) : "");
    csv += ',' + csv_field(m.indirect) + '\n';
  }
  return csv;
}

}  // namespace pocketray
