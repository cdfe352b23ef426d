#include "desktop/accuracy/page_tables.h"

#include <cmath>

#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

std::string cell(const std::string& text, const char* kind = "") {
  return *kind ? "<td class=\"" + std::string(kind) + "\">" + text + "</td>" : "<td>" + text + "</td>";
}
std::string headings(const std::vector<std::string>& names) {
  std::string row = "<thead><tr>";
  for (const std::string& name : names) row += "<th>" + name + "</th>";
  return row + "</tr></thead>\n";
}
std::string boxed(const std::string& head, const std::string& rows) {
  return "<div class=\"box\"><table>\n" + head + "<tbody>\n" + rows + "</tbody></table></div>\n";
}

// Marks numbers too small to claim.
std::string claimed_cell(const std::string& text, bool claimed) {
  return claimed ? cell(text) : cell("<i>" + text + "</i>", "weak");
}
// Marks an RMSE that is mostly the reference's own.
std::string rmse_cell(const Sweep& sweep, const Measured& m) {
  return claimed_cell(figure(m.errors.rmse), !(m.errors.rmse < kClaimFactor * sweep.model.rmse));
}
std::string ms_text(const Sweep& sweep, const Interval& ns) {
  std::string text = figure(ms_of(sweep, ns.value));
  if (std::isfinite(ns.low) && std::isfinite(ns.high) && ns.low < ns.high)
    text += " <small>" + figure(ms_of(sweep, ns.low)) + "–" + figure(ms_of(sweep, ns.high)) + "</small>";
  return text;
}
std::string ratio_text(const Interval& ratio) {
  if (!(ratio.value > 0)) return "–";
  std::string text = figure(ratio.value);
  if (ratio.low < ratio.high) text += " <small>" + figure(ratio.low) + "–" + figure(ratio.high) + "</small>";
  return text;
}
std::string name_of(const Measured& m) {
  if (m.knob == "baseline") return "baseline";
  return escaped(m.knob == "several" ? m.value : m.knob + " " + m.value);
}

std::string bytes_text(double bytes) { return std::isfinite(bytes) ? format("%.0f", bytes) : "–"; }

std::string stored_text(double bytes) { return std::isfinite(bytes) ? format("%.2f MiB", bytes / (1 << 20)) : "–"; }

std::string end_text(const Sweep& sweep, const KnobFigures& knob, const Measured* m, bool in_bytes) {
  if (!m) return cell("–");
  std::string price =
      in_bytes ? bytes_text(m->bytes_per_frame) + " bytes" : figure(ms_of(sweep, m->ns_per_pixel.value)) + " ms";
  if (knob.is_baked) price += ", " + stored_text(m->stored_bytes);
  return cell("<b>" + escaped(m->value) + "</b><br /><small>" +
              row_link(sweep, *m, price + ", FLIP " + figure(flip_by(knob, *m))) + "</small>");
}

std::string price_text(double price) {
  if (!std::isfinite(price)) return "–";
  return price > 0 ? figure(price) : "free";
}

}  // namespace

std::string row_link(const Sweep& sweep, const Measured& m, const std::string& text) {
  return "<a href=\"accuracy.csv#row=" + std::to_string(&m - sweep.measured.data() + 2) + "\">" + text + "</a>";
}

std::string price_table(const Sweep& sweep) {
  std::string rows;
  for (const KnobFigures* knob : knobs_by_price(sweep)) {
    KnobEnds ends = ends_of(sweep, knob->name);
    bool claimed = gain_claimed(*knob, ends), in_bytes = is_paid_in_bytes(ends);
    rows += claimed ? "<tr>" : "<tr class=\"weak\">";
    rows += "<th><a href=\"#" + file_word(knob->name) + "\">" + escaped(knob->name) + "</a><br /><small>" +
            escaped(knob->effect) + "</small></th>" +
            cell("<b>" + (in_bytes ? "bytes" : price_text(knob->ms_per_flip)) + "</b>", "key") +
            cell(figure(gain_of(*knob, ends))) + cell(knob->judge == Judge::truth ? "truth" : "model") +
            end_text(sweep, *knob, ends.worst, in_bytes) + end_text(sweep, *knob, ends.standard, in_bytes) +
            end_text(sweep, *knob, ends.best, in_bytes) + "</tr>\n";
  }
  return boxed(headings({"knob", "ms per .01 FLIP", "FLIP gained", "judged by", "worst end", "baseline", "best end"}),
               rows);
}

std::string front_table(const Sweep& sweep, Judge judge) {
  std::string rows;
  int number = 0;
  for (const Measured* m : front_of(sweep, judge))
    rows += "<tr>" + cell(std::to_string(++number), "key") + "<th class=\"name\"><span>" +
            row_link(sweep, *m, name_of(*m)) + "</span></th>" + cell(ms_text(sweep, m->ns_per_pixel)) +
            cell(ratio_text(m->time_ratio)) + cell(figure(distance_to(*m, judge).flip)) + "</tr>\n";
  return boxed(headings({"", "setting", "ms per frame", "× baseline", "FLIP"}), rows);
}

std::string method_table(const Sweep& sweep) {
  std::string rows;
  for (const std::string& method : methods_of(sweep))
    for (const Measured* m : method_front(sweep, method))
      rows += "<tr><th>" + escaped(method) + "</th><td class=\"name\"><span>" +
              row_link(sweep, *m, own_settings(*m).empty() ? "baseline" : escaped(own_settings(*m))) + "</span></td>" +
              cell(ms_text(sweep, m->ns_per_pixel)) + cell(figure(m->truth.flip)) + "</tr>\n";
  return boxed(headings({"method", "settings", "ms per frame", "FLIP"}), rows);
}

std::string value_table(const Sweep& sweep, const std::string& knob) {
  std::vector<const Measured*> values = values_of(sweep, knob);
  bool counted = false, sent = is_paid_in_bytes(ends_of(sweep, knob));
  bool baked = false;
  for (const KnobFigures& k : sweep.knobs) baked = baked || (k.is_baked && k.name == knob);
  for (const Measured* m : values) counted = counted || std::isfinite(m->instructions_per_pixel);
  std::vector<std::string> names = {"value", "ms per frame", "× baseline", "FLIP to truth", "to model", "before output",
                                    "RMSE",  "rel. MSE",     "p99",        "max",           "bias",     "PSNR, dB"};
  if (counted) names.push_back("instructions per pixel");
  if (sent) names.push_back("bytes per frame");
  if (baked) names.insert(names.end(), {"stored", "baked in, s"});
  std::string rows;
  for (const Measured* m : values) {
    rows += m->is_default ? "<tr class=\"standard\">" : "<tr>";
    rows += "<th>" + row_link(sweep, *m, escaped(m->value) + (m->is_default ? "*" : "")) +
            (m->note.empty() ? "" : "<br /><small>" + escaped(m->note) + "</small>") + "</th>";
    if (!m->missing.empty()) {
      rows += "<td class=\"missing\" colspan=\"" + std::to_string(names.size() - 1) +
              "\">not measured: " + escaped(m->missing) + "</td></tr>\n";
      continue;
    }
    const PictureErrors& e = m->errors;
    rows += cell(ms_text(sweep, m->ns_per_pixel)) + cell(ratio_text(m->time_ratio)) + cell(figure(m->truth.flip)) +
            cell(figure(m->model.flip)) + cell(figure(m->flip_before)) + rmse_cell(sweep, *m);
    bool claimed = !(e.rmse < kClaimFactor * sweep.model.rmse);  // otherwise mostly the reference's own error
    for (const std::string& text : {figure(e.rel_mse), figure(e.p99), figure(e.max), figure(e.bias),
                                    std::isfinite(e.psnr) ? format("%.1f", e.psnr) : figure(e.psnr)})
      rows += claimed_cell(text, claimed);
    if (counted) rows += cell(figure(m->instructions_per_pixel, 4));
    if (sent) rows += cell(bytes_text(m->bytes_per_frame));
    if (baked) rows += cell(stored_text(m->stored_bytes)) + cell(figure(m->bake_seconds, 2));
    rows += "</tr>\n";
  }
  return boxed(headings(names), rows);
}

}  // namespace pocketray
