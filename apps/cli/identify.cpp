#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include <apps/cli/commands.hpp>
#include <apps/cli/learn.hpp>
#include <apps/cli/log_record.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/ident/idim_ls.hpp>
#include <stribeck/ident/least_squares_a.hpp>
#include <stribeck/ident/velocity_map.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/identify_report.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/table.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::vector<std::string> logs;
  LogOptions log;
  std::string model = "auto";
  std::string method = "auto";
  std::string output;
  int terms = -1;
};

/// The method that gives a kind of model, where the user left it open.
std::string method_of(const Options& o) {
  if (o.method != "auto") return o.method;
  if (o.model == "conventional") return "least-squares";
  return "velocity-map";
}

void refuse_pair(const std::string& method, const std::string& model, const std::string& expected) {
  refuse_option("--model",
                fmt::format("got {}, which --method {} cannot give (expected {})", model, method, expected));
}

/// A result, and what a published protocol prints beside it.
struct Identified {
  ident::Result result;
  std::optional<ident::LeastSquaresA> model_a;
  std::optional<ident::IdimResult::Published> published;
};

Identified identify_records(const Options& o, const std::vector<ident::Record>& records) {
  const std::string method = method_of(o);
  if (method == "idim-ls" && records.size() > 1) {
    refuse_option("LOG", fmt::format("{} logs, but --method {} takes one", records.size(), method));
  }
  if (method == "idim-ls") {
    if (o.model == "gaussian") refuse_pair(method, o.model, "auto, conventional or asymmetric");
    ident::IdimOptions options;
    options.by_direction = o.model == "asymmetric";
    ident::IdimResult idim = ident::identify_idim_ls(records.front(), options);
    return {std::move(idim.result), {}, std::move(idim.published)};
  }
  if (method == "least-squares") {
    if (o.model != "auto" && o.model != "conventional") refuse_pair(method, o.model, "auto or conventional");
    ident::LeastSquaresA a = ident::identify_least_squares_a(records);
    ident::Result result = a.result;
    return {std::move(result), std::move(a), {}};
  }
  if (o.model != "auto" && o.model != "gaussian") refuse_pair(method, o.model, "auto or gaussian");
  ident::VelocityMapOptions options;
  if (o.terms >= 0) options.terms = o.terms;
  return {ident::identify_velocity_map(records, options), {}, {}};
}

/// Names and SI units in the order of the law.
std::vector<std::pair<std::string, std::string>> published_names(bool by_direction) {
  if (by_direction) return {{"M", "kg"}, {"Fv+", "N s/m"}, {"Fc+", "N"}, {"Fv-", "N s/m"}, {"Fc-", "N"}};
  return {{"M", "kg"}, {"Fv", "N s/m"}, {"Fc", "N"}, {"offset", "N"}};
}

nlohmann::ordered_json published_json(const ident::IdimResult::Published& p, bool by_direction) {
  nlohmann::ordered_json json;
  const auto names = published_names(by_direction);
  for (std::size_t i = 0; i < names.size(); ++i) {
    json["parameters"].push_back(
        {{"name", names[i].first}, {"value", p.value[i]}, {"sd", p.deviation[i]}, {"unit", names[i].second}});
  }
  json["error_norm_N"] = p.error_norm;
  json["relative_error_percent"] = 100.0 * p.relative_error;
  json["error_sd_N"] = p.error_deviation;
  json["condition"] = p.condition;
  return json;
}

/// The figures as papers print them; their deviations take the residuals for white.
std::string published_text(const ident::IdimResult::Published& p, bool by_direction) {
  std::string out = "\nAs the published protocol prints it (standard deviations for white residuals):\n";
  const auto names = published_names(by_direction);
  for (std::size_t i = 0; i < names.size(); ++i) {
    out += fmt::format("  {:<7}{:10.4f} ({:.4f}) {}\n", names[i].first, p.value[i], p.deviation[i],
                       names[i].second);
  }
  return out +
         fmt::format(
             "  error: norm {:.4f} N, relative {:.4f} %, standard deviation {:.4f} N; condition {:.4f}\n",
             p.error_norm, 100.0 * p.relative_error, p.error_deviation, p.condition);
}

/// What the logs themselves say about how far the result can be trusted.
void warn_of_records(const std::vector<ident::Record>& records, const std::string& method,
                     std::vector<std::string>& warnings) {
  for (const ident::Record& r : records) {
    if (method == "least-squares" && !r.r.empty()) {
      warnings.push_back(r.source +
                         ": least squares is made for pulses in open loop; in a closed-loop log the force "
                         "reacts to the noise, "
                         "and mass and interval can be far off (use --method velocity-map)");
    }
    // A controller's force that stays at its extreme is cut off; programmed pulses have flat tops of their own.
    if (r.r.empty()) continue;
    const auto [low, high] = std::minmax_element(r.f.begin(), r.f.end());
    std::size_t cut = 0;
    std::size_t first = 0;
    for (std::size_t k = 1; k < r.f.size(); ++k) {
      if ((r.f[k] == *low || r.f[k] == *high) && r.f[k] == r.f[k - 1] && cut++ == 0) first = k;
    }
    constexpr double kFew = 0.005;
    if (static_cast<double>(cut) > kFew * static_cast<double>(r.f.size())) {
      warnings.push_back(
          fmt::format("{}: the force stands at its largest value in {} rows, first in row {}: the drive was "
                      "at its limit or "
                      "the channel is cut off, and the result is biased",
                      r.source, cut, first + 1));
    }
  }
}

int identify(const Options& o) {
  check_distinct(o.logs, {o.output, o.common.json});
  check_outputs(o.common);
  check_writable(o.output);
  std::vector<ident::Record> records;
  std::vector<std::string> notes;
  std::string sources;
  for (const std::string& path : o.logs) {
    const io::Log log = io::read_csv(path);
    for (const std::string& note : log.notes) notes.push_back(path + ": " + note);
    records.push_back(make_record(log, o.log));
    sources += (sources.empty() ? "" : ", ") + path;
  }
  Identified identified = identify_records(o, records);
  ident::Result& result = identified.result;
  refuse_nonsense(result, sources);
  warn_of_records(records, method_of(o), result.warnings);
  result.warnings.insert(result.warnings.begin(), notes.begin(), notes.end());
  const std::string& axis = o.log.axis;
  if (!o.output.empty()) {
    io::write_atomically(
        o.output,
        io::write_toml(as_model(result), fmt::format("{}{}, identified from {} by stribeck {} ({}).",
                                                     axis.empty() ? "" : "Axis " + axis + ": ", result.model,
                                                     sources, STRIBECK_VERSION, result.method)));
  }
  auto json = report::to_json(result, axis);
  if (identified.published)
    json["published"] = published_json(*identified.published, o.model == "asymmetric");
  if (result.peaks) json["peaks"] = {{"positive", (*result.peaks)[0]}, {"negative", (*result.peaks)[1]}};
  if (identified.model_a) {
    json["forward_euler_mass_kg"] = identified.model_a->mass_euler;
    json["simple_least_squares_mass_kg"] = identified.model_a->simple_mass;
  }
  write_json(o.common.json, json);
  if (!o.common.report.empty()) {
    report::write_identify_report(o.common.report,
                                  {axis, {result}, sources, typed_command(), STRIBECK_VERSION});
  }
  say(o.common, report::text_table(result, axis));
  if (result.peaks) {
    say(o.common, fmt::format("\nPeaks of the smoothed map, by which the thesis chooses the number of terms: "
                              "{} for v > 0, {} for v < 0.\n",
                              (*result.peaks)[0], (*result.peaks)[1]));
  }
  if (identified.model_a) {
    say(o.common, fmt::format("\nMass by the printed forward Euler form: {:.4g} N s2/mm; by simple least "
                              "squares, without Coulomb friction: "
                              "{:.4g} N s2/mm.\n",
                              identified.model_a->mass_euler * 1e-3, identified.model_a->simple_mass * 1e-3));
  }
  if (identified.published) say(o.common, published_text(*identified.published, o.model == "asymmetric"));
  return 0;
}

}  // namespace

void add_identify(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand("identify", "Mass and friction of an axis from logs, with 95 % intervals");
  auto o = std::make_shared<Options>();
  verb->add_option("log", o->logs, "Logs of one axis; several are fitted together")
      ->required()
      ->type_name("LOG");
  verb->add_option("--axis", o->log.axis, "Name of the axis; a log of several axes has columns like x_NAME")
      ->type_name("NAME");
  verb->add_option("--model", o->model,
                   "auto, gaussian, conventional, or asymmetric (idim-ls, friction by direction)")
      ->check(CLI::IsMember({"auto", "gaussian", "conventional", "asymmetric"}))
      ->capture_default_str();
  verb->add_option("--method", o->method,
                   "auto, velocity-map (continuous velocity-friction map), least-squares (unbiased, from "
                   "pulses), or idim-ls (the "
                   "published EMPS protocol)")
      ->check(CLI::IsMember({"auto", "velocity-map", "least-squares", "idim-ls"}))
      ->capture_default_str();
  verb->add_option("--terms", o->terms, "Gaussians of each direction; left out: chosen by held-out motion")
      ->check(CLI::Range(0, 6));
  verb->add_option("--map", o->log.maps,
                   "Which column is what, repeatable: quantity=\"column unit\", e.g. x=\"Istposition mm\"")
      ->type_name("MAP");
  verb->add_option("--gain", o->log.gain,
                   "Force per volt, ampere, newton metre or percent, e.g. \"1048 N/V\"")
      ->type_name("GAIN");
  verb->add_option("-o,--output", o->output, "Axis file to write")->type_name("AXIS.toml");
  add_common(*verb, o->common);
  verb->footer(
      "Example:\n  stribeck identify x-pulses-log.csv x-sine-log.csv --axis x -o x.toml --report report");
  verb->callback([o, &action] { action = [o] { return identify(*o); }; });
}

}  // namespace stribeck::cli
