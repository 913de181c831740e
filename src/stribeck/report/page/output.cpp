#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stribeck/core/numbers.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/page/output.hpp>
#include <stribeck/report/plot/frame.hpp>
#include <stribeck/report/text.hpp>

namespace stribeck::report {
namespace {

/// "contour-error-at-3-mm-s" of a title.
std::string file_words(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string out;
  for (const char c : clean_text(text)) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    const bool capital = c >= 'A' && c <= 'Z';
    if (letter || capital) {
      out += capital ? static_cast<char>(c - 'A' + 'a') : c;
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
    if (out.size() >= kLongest) break;
  }
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out;
}

std::string numbered(std::string_view kind, std::size_t number, std::string_view title) {
  const std::string words = file_words(title);
  return fmt::format("{}-{:02}{}{}", kind, number, words.empty() ? "" : "-", words);
}

/// A field of a CSV: quoted where it must be, and never a formula of a spreadsheet.
std::string field(std::string_view text) {
  std::string clean = clean_text(text);
  if (clean.find_first_of("\",;") == std::string::npos && clean.find_first_of("=+@") != 0) return clean;
  std::string out = "\"";
  for (const char c : clean) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

std::string head_of(const Column& c) {
  return c.unit.empty() ? c.head : c.head + " [" + printed_unit(c.unit) + "]";
}

std::string text_of(const Cell& c) {
  std::string out = c.text;
  if (!c.spread.empty()) out += " " + c.spread;
  if (!c.note.empty()) out += " (" + c.note + ")";
  return out;
}

std::string in_markdown(std::string_view text) {
  std::string out;
  for (const char c : clean_text(text)) {
    if (c == '|' || c == '\\' || c == '<') out += '\\';
    out += c;
  }
  return out;
}

std::string in_latex(std::string_view text) {
  // What a LaTeX without further packages does not set as it stands.
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 39> kWords{{
      {"\\", "\\textbackslash{}"},
      {"&", "\\&"},
      {"%", "\\%"},
      {"$", "\\$"},
      {"#", "\\#"},
      {"_", "\\_"},
      {"{", "\\{"},
      {"}", "\\}"},
      {"~", "\\textasciitilde{}"},
      {"^", "\\textasciicircum{}"},
      {"|", "\\textbar{}"},
      {"<", "$<$"},
      {">", "$>$"},
      {"±", "$\\pm$"},
      {"×", "$\\times$"},
      {"−", "$-$"},
      {"≤", "$\\le$"},
      {"≥", "$\\ge$"},
      {"→", "$\\to$"},
      {"µ", "\\textmu{}"},
      {"°", "\\textdegree{}"},
      {"²", "$^2$"},
      {"³", "$^3$"},
      {"⁻", "$^-$"},
      {"α", "$\\alpha$"},
      {"β", "$\\beta$"},
      {"γ", "$\\gamma$"},
      {"δ", "$\\delta$"},
      {"ε", "$\\varepsilon$"},
      {"η", "$\\eta$"},
      {"λ", "$\\lambda$"},
      {"μ", "$\\mu$"},
      {"σ", "$\\sigma$"},
      {"τ", "$\\tau$"},
      {"φ", "$\\varphi$"},
      {"ω", "$\\omega$"},
      {"Δ", "$\\Delta$"},
      {"Ω", "$\\Omega$"},
      {"\u2060", ""},
  }};
  const std::string clean = clean_text(text);
  std::string out;
  for (std::size_t i = 0; i < clean.size();) {
    const auto word = std::find_if(kWords.begin(), kWords.end(), [&](const auto& w) {
      return clean.compare(i, w.first.size(), w.first) == 0;
    });
    if (word == kWords.end()) {
      out += clean[i++];
    } else {
      out += word->second;
      i += word->first.size();
    }
  }
  return out;
}

/// The rows of a table, each made of cells that `escape` has treated, between `begin`, `between` and `end`.
template <class Escape>
std::string rows_of_table(const Table& table, std::string_view begin, std::string_view between,
                          std::string_view end, Escape&& escape) {
  std::string out;
  for (const auto& row : table.rows) {
    out += begin;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) out += between;
      out += escape(text_of(row[i]));
    }
    out += end;
  }
  return out;
}

void write_tables(const std::string& folder, const std::vector<Table>& tables) {
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string name = folder + "/" + numbered("table", i + 1, tables[i].caption);
    io::write_atomically(name + ".md", markdown(tables[i]));
    io::write_atomically(name + ".csv", csv(tables[i]));
    io::write_atomically(name + ".tex", latex(tables[i]));
  }
}

/// An SVG of its own: the name space that a drawing inside a page does without, and no facts for the page's script.
std::string standing_alone(std::string svg) {
  const std::size_t facts = svg.find(" data-plot='");
  if (facts != std::string::npos) svg.erase(facts, svg.find('\'', facts + 12) + 1 - facts);
  svg.insert(4, " xmlns=\"http://www.w3.org/2000/svg\"");
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg + "\n";
}

void write_figures(const std::string& folder, const std::vector<Plot>& plots) {
  const std::vector<std::string> svg = render(plots);
  const std::vector<std::string> pdf = render(plots, Format::kPdf);
  const std::vector<std::string> png = render(plots, Format::kPng);
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const Plot& p = plots[i];
    const std::string_view words = !p.title.empty()         ? p.title
                                   : !p.description.empty() ? p.description
                                                            : p.y_label;
    const std::string name = folder + "/" + numbered("figure", i + 1, words);
    io::write_atomically(name + ".svg", standing_alone(svg[i]));
    io::write_atomically(name + ".pdf", pdf[i]);
    io::write_atomically(name + ".png", png[i]);
    io::write_atomically(name + ".csv", data_csv(p));
  }
}

}  // namespace

void write_page(const Page& page, const PageFolders& folders) {
  if (!folders.page.empty()) {
    const std::string html = page.html();
    io::make_directory(folders.page);
    io::write_atomically(folders.page + "/index.html", html);
  }
  if (folders.plots.empty()) return;
  io::make_directory(folders.plots);
  write_figures(folders.plots, page.plots());
  write_tables(folders.plots, page.tables());
}

nlohmann::ordered_json to_json(const Made& made) {
  nlohmann::ordered_json out{{"command", made.command}, {"version", made.version}};
  out["inputs"] = nlohmann::ordered_json::array();
  for (const InputFile& f : made.inputs) out["inputs"].push_back({{"file", f.file}, {"sha256", f.sha256}});
  return out;
}

namespace {

/// Angle and radial error of a point that is drawn around a circle; empty fields for a line of the scale.
std::string around(const Ring& ring, const Series& s, std::size_t i) {
  const bool drawn = s.scale == ScaleLine::kNone && i < s.y.size();
  const double x = s.x[i] - ring.x, y = drawn ? s.y[i] - ring.y : kNaN;
  if (!std::isfinite(x) || !std::isfinite(y)) return ",";
  const double degrees = std::atan2(y, x) * 180.0 / kPi;
  return fmt::format("{:.9g},{:.9g}", degrees < 0.0 ? degrees + 360.0 : degrees,
                     (std::hypot(x, y) - ring.radius) * ring.error_per_unit);
}

}  // namespace

std::string data_csv(const Plot& p) {
  const auto label = [](const std::string& text, std::string_view otherwise) {
    return field(text.empty() ? otherwise : std::string_view(text));
  };
  std::string out =
      fmt::format("curve,{},{},low,high{}\n", label(p.x_label, p.ring ? "x as drawn" : "x"),
                  label(p.y_label, p.ring ? "y as drawn" : "y"), p.ring ? ",angle [deg],error [µm]" : "");
  std::size_t unnamed = 0;
  for (const Series& s : p.series) {
    const auto tic = std::find_if(p.x_tics.begin(), p.x_tics.end(),
                                  [&](const Tic& t) { return s.x.size() == 1 && t.at == s.x.front(); });
    std::string name = s.label;
    if (name.empty() && s.scale != ScaleLine::kNone) name = "scale";
    if (name.empty() && tic != p.x_tics.end()) name = tic->label;
    if (name.empty()) name = fmt::format("curve {}", ++unnamed);
    name = field(name);
    const auto value = [](const std::vector<double>& v, std::size_t i) {
      return i < v.size() && std::isfinite(v[i]) ? fmt::format("{:.9g}", v[i]) : std::string();
    };
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      out += fmt::format("{},{},{},{},{}", name, value(s.x, i), value(s.y, i), value(s.y_low, i),
                         value(s.y_high, i));
      if (p.ring) out += "," + around(*p.ring, s, i);
      out += '\n';
    }
  }
  return out;
}

std::string markdown(const Table& table) {
  std::string out;
  if (!table.caption.empty()) out += in_markdown(table.caption) + "\n\n";
  std::string rule = "|";
  out += "|";
  for (const Column& c : table.columns) {
    out += " " + in_markdown(head_of(c)) + " |";
    rule += c.number ? "---:|" : "---|";
  }
  return out + "\n" + rule + "\n" + rows_of_table(table, "| ", " | ", " |\n", in_markdown);
}

std::string csv(const Table& table) {
  std::string out;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    out += (i > 0 ? "," : "") + field(head_of(table.columns[i]));
  return out + "\n" + rows_of_table(table, "", ",", "\n", field);
}

std::string latex(const Table& table) {
  std::string columns;
  std::string heads;
  for (const Column& c : table.columns) {
    columns += c.number ? 'r' : 'l';
    heads += (heads.empty() && columns.size() == 1 ? "" : " & ") + in_latex(head_of(c));
  }
  std::string out = table.caption.empty() ? "" : "% " + clean_text(table.caption) + "\n";
  out += fmt::format("\\begin{{tabular}}{{{}}}\n\\hline\n{} \\\\\n\\hline\n", columns, heads);
  return out + rows_of_table(table, "", " & ", " \\\\\n", in_latex) + "\\hline\n\\end{tabular}\n";
}

}  // namespace stribeck::report
