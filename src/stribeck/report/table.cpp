#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/report/text.hpp>
#include <vector>

namespace stribeck::report {
namespace {

/// A column with its heads; wide enough for its longest entry.
struct TextColumn {
  std::string head;
  std::string unit;
  std::vector<std::string> entries;
  bool number = true;
  std::string group = {};  ///< above the head
  std::size_t most = kTableWidth;

  [[nodiscard]] std::size_t width() const {
    std::size_t w = std::max({text_width(group), text_width(head), text_width(unit)});
    for (const std::string& e : entries) w = std::max(w, text_width(e));
    return std::min(w, most);
  }
};

std::string lay_out(std::vector<TextColumn> columns) {
  std::size_t total = 0;
  for (const TextColumn& c : columns) total += c.width() + 2;
  // What does not fit is taken from the text columns, longest first.
  while (total > kTableWidth + 2) {
    auto longest = columns.end();
    for (auto c = columns.begin(); c != columns.end(); ++c) {
      if (!c->number && (longest == columns.end() || c->width() > longest->width())) longest = c;
    }
    if (longest == columns.end() || longest->width() < 8) break;
    longest->most = longest->width() - 1;
    --total;
  }
  const auto row = [&](auto&& entry) {
    std::string text;
    for (const TextColumn& c : columns) {
      if (!text.empty()) text += "  ";
      const std::string e = entry(c);
      text += c.number ? right_aligned(e, c.width()) : left_aligned(e, c.width());
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + '\n';
  };
  std::string out;
  for (const auto member : {&TextColumn::group, &TextColumn::head, &TextColumn::unit}) {
    const bool needed = std::any_of(columns.begin(), columns.end(),
                                    [&](const TextColumn& c) { return !(c.*member).empty(); });
    if (needed) out += row([&](const TextColumn& c) { return c.*member; });
  }
  for (std::size_t i = 0; i < columns.front().entries.size(); ++i) {
    out += row([i](const TextColumn& c) { return c.entries[i]; });
  }
  return out;
}

std::string micrometres(double metres) { return decimals(metres * 1e6, 2); }

std::string with_spread(double mean, double spread) {
  return std::isfinite(spread) ? micrometres(mean) + " ±" + micrometres(spread) : micrometres(mean);
}

}  // namespace

std::vector<std::string> status_warnings(const sim::CompareResult& result) {
  std::vector<std::string> all;
  for (const sim::CompareRow& r : result.rows) {
    for (const Status s : {Status::kNotFinite, Status::kOutputLimited, Status::kOutsideVelocityRange}) {
      if (r.status.count(s) == 0) continue;
      all.push_back(fmt::format("({}) at {:.6g} mm/s: {} ({} times in {} trial{})", r.controller.id,
                                r.speed * 1e3, describe(s), r.status.count(s), result.spec.trials,
                                result.spec.trials == 1 ? "" : "s"));
    }
  }
  return all;
}

std::string text_table(const sim::CompareResult& result, std::span<const PrintedTable> printed) {
  std::vector<double> speeds;
  for (const sim::CompareRow& r : result.rows) {
    if (std::find(speeds.begin(), speeds.end(), r.speed) == speeds.end()) speeds.push_back(r.speed);
  }
  std::string out;
  for (const double speed : speeds) {
    const PrintedTable* print = find_printed(printed, speed);
    TextColumn id{"", "", {}, false};
    TextColumn label{"controller", "", {}, false};
    TextColumn max{"max", "µm", {}};
    TextColumn glitch{"glitch", "µm", {}};
    TextColumn rms{"RMS", "µm", {}};
    TextColumn mean{"mean |ε|", "µm", {}};
    TextColumn sd{"SD", "µm", {}};
    TextColumn variation{"mean |Δu|", "V", {}};
    TextColumn print_max{"max", "µm", {}, true, "print"};
    TextColumn print_glitch{"glitch", "µm", {}, true, "print"};
    TextColumn print_rms{"RMS", "µm", {}, true, "print"};
    for (const sim::CompareRow& r : result.rows) {
      if (r.speed != speed) continue;
      id.entries.push_back(clean_text(r.controller.id));
      label.entries.push_back(clean_text(r.controller.label));
      max.entries.push_back(with_spread(r.mean.max_contour_error, r.spread.max_contour_error));
      glitch.entries.push_back(micrometres(r.mean.quadrant_glitch));
      rms.entries.push_back(with_spread(r.mean.rms, r.spread.rms));
      mean.entries.push_back(micrometres(r.mean.mean_abs));
      sd.entries.push_back(micrometres(r.mean.sd));
      variation.entries.push_back(significant(r.mean.input_variation, 3));
      const PrintedRow* p = print != nullptr ? print->find(r.controller.id) : nullptr;
      print_max.entries.push_back(p != nullptr ? decimals(p->max_contour_error_um, 2) : "");
      print_glitch.entries.push_back(p != nullptr ? decimals(p->quadrant_glitch_um, 2) : "");
      print_rms.entries.push_back(p != nullptr ? decimals(p->rms_um, 2) : "");
    }
    if (!out.empty()) out += '\n';
    out +=
        fmt::format("{} mm/s, contour error, mean of {} trial{}", short_number(speed * 1e3),
                    result.spec.trials, result.spec.trials == 1 ? "" : "s ± standard deviation between them");
    if (print != nullptr) out += fmt::format("; printed: {}", print->source);
    out += "\n";
    if (print != nullptr) {
      out += lay_out({id, label, max, glitch, rms, mean, print_max, print_glitch, print_rms});
    } else {
      out += lay_out({id, label, max, glitch, rms, mean, sd, variation});
    }
  }
  return out;
}

std::string text_table(const ident::Result& result, std::string_view axis) {
  std::string out = fmt::format("{}{} model by {}, {} rows",
                                axis.empty() ? std::string() : "axis " + clean_text(axis) + ": ",
                                clean_text(result.model), clean_text(result.method), result.rows);
  if (std::isfinite(result.held_out_rms)) {
    out += fmt::format(", {} N RMS on held-out motion", significant(result.held_out_rms, 3));
  }
  out += '\n';
  TextColumn name{"parameter", "", {}, false};
  TextColumn value{"value", "", {}};
  TextColumn low{"95 % from", "", {}};
  TextColumn high{"to", "", {}};
  TextColumn unit{"unit", "", {}, false};
  TextColumn remark{"", "", {}, false};
  for (const ident::Parameter& p : result.parameters) {
    const ShownParameter s = shown(p);
    name.entries.push_back(clean_text(p.name));
    value.entries.push_back(shown_number(s.value, s.low, s.high));
    low.entries.push_back(shown_number(s.low, s.low, s.high));
    high.entries.push_back(shown_number(s.high, s.low, s.high));
    unit.entries.push_back(clean_text(s.unit));
    remark.entries.push_back(p.identifiable ? "" : "not determined by the data");
  }
  out += lay_out({name, value, low, high, unit, remark});
  if (!result.models.empty()) {
    TextColumn model{"model", "", {}, false};
    TextColumn held{"held-out RMS", "N", {}};
    TextColumn error{"± from best", "N", {}};
    TextColumn chosen{"", "", {}, false};
    for (const ident::Candidate& c : result.models) {
      model.entries.push_back(clean_text(c.name));
      held.entries.push_back(decimals(c.held_out_rms, 2));
      error.entries.push_back(decimals(c.standard_error, 2));
      chosen.entries.push_back(c.chosen ? "chosen" : "");
    }
    out += '\n' + lay_out({model, held, error, chosen});
  }
  for (const std::string& w : result.warnings) out += "warning: " + clean_text(w) + '\n';
  return out;
}

}  // namespace stribeck::report
