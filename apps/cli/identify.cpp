#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <apps/cli/commands.hpp>
#include <apps/cli/expected.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/methods/break_away.hpp>
#include <stribeck/ident/methods/equal_speed.hpp>
#include <stribeck/ident/methods/idim_ls.hpp>
#include <stribeck/ident/methods/jog.hpp>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/methods/position_map.hpp>
#include <stribeck/ident/methods/velocity_map.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/report/table.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/inspect.hpp>
#include <stribeck/workflow/log_record.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::vector<std::string> logs;
  LogOptions log;
  std::string model = "auto";
  std::string method = "auto";
  std::string solver = "derivatives";
  std::string output;
  std::string mass;
  std::string cut_off;
  std::string turn;
  int terms = -1;
  bool inspect = false;
};

/// Which options a method takes, beyond those of every method.
struct Method {
  std::string name;
  std::vector<std::string> models;
  bool terms, mass, cut_off, turn, solver;
};

const std::vector<Method>& methods() {
  static const std::vector<Method> all{
      {"auto", {"auto", "conventional", "gaussian"}, true, true, true, false, false},
      {"velocity-map", {"auto", "gaussian"}, true, true, false, false, false},
      {"position-map", {"auto"}, false, true, false, true, false},
      {"jog", {"auto", "conventional", "gaussian"}, true, true, false, false, true},
      {"least-squares", {"auto", "conventional"}, false, false, false, false, true},
      {"idim-ls", {"auto", "conventional", "asymmetric"}, false, false, false, false, false},
      {"break-away", {"auto"}, false, true, false, false, false},
      {"gravity", {"auto"}, false, false, false, false, false},
      {"constant-acceleration", {"auto"}, false, false, false, false, false}};
  return all;
}

/// Every option that the method would ignore is refused.
void check_options(const Options& o, const std::string& method, const std::string& which) {
  const auto m =
      *std::find_if(methods().begin(), methods().end(), [&](const Method& x) { return x.name == method; });
  const auto takes = [&](bool given, bool taken, const char* option) {
    if (given && !taken) refuse_option(option, which + " does not take it");
  };
  takes(o.terms >= 0, m.terms, "--terms");
  takes(!o.mass.empty(), m.mass, "--mass");
  takes(!o.cut_off.empty(), m.cut_off, "--cut-off");
  takes(!o.turn.empty(), m.turn, "--turn");
  takes(o.solver != "derivatives", m.solver, "--solver");
  if (std::find(m.models.begin(), m.models.end(), o.model) == m.models.end()) {
    refuse_option("--model", fmt::format("got {}, which {} cannot give (expected {})", o.model, which,
                                         fmt::join(m.models, ", ")));
  }
  if (o.terms > 0 && o.model == "conventional")
    refuse_option("--terms", fmt::format("got {}, but --model conventional has no Gaussians", o.terms));
}

/// What auto turns out to be.
void check_auto(const Options& o, const char* method, const char* why) {
  check_options(o, method, fmt::format("the method for this log ({}, {})", method, why));
}

/// With --inspect nothing is identified, so nothing but the reading of the log can be asked for.
void check_inspect(const Options& o) {
  const auto none = [](bool given, const char* option) {
    if (given) refuse_option(option, "--inspect does not take it: it identifies nothing");
  };
  none(o.model != "auto", "--model");
  none(o.method != "auto", "--method");
  none(o.terms >= 0, "--terms");
  none(!o.mass.empty(), "--mass");
  none(!o.cut_off.empty(), "--cut-off");
  none(!o.turn.empty(), "--turn");
  none(o.solver != "derivatives", "--solver");
  none(!o.output.empty(), "--output");
  none(!o.common.report.empty(), "--report");
}

/// Everything that is to be said of the logs, and their records.
struct Input {
  std::vector<ident::log::Record> records;
  std::size_t runs = 0;        ///< logged apart from each other
  bool one_direction = false;  ///< all of them move in the same direction
  std::vector<std::string> notes;
  std::string sources;
};

/// A result, and what belongs to one method alone.
struct Identified {
  ident::Result result;
  std::vector<ident::Result> beside;  ///< results that stand beside it: other days
  std::optional<ident::methods::LeastSquaresA> model_a;
  std::optional<ident::methods::IdimResult::Published> published;
  std::string says;  ///< text below the table
};

std::optional<double> optional_si(const std::string& text, const Quantity& quantity, const char* option) {
  if (text.empty()) return std::nullopt;
  return option_si(option, text, quantity);
}

/// From a milligram, in whatever unit of force, to more than any table.
std::optional<double> given_mass(const Options& o) {
  return optional_si(o.mass, quantity("kg", "N s2/mm").at_least(1e-6).at_most(1e9), "--mass");
}

/// Between one period of the log and half the sampling frequency.
double given_cut_off(const Options& o, const std::vector<ident::log::Record>& records) {
  const auto f = optional_si(o.cut_off, quantity("Hz", "Hz").positive(), "--cut-off");
  if (!f) return 0.0;
  double least = 0.0, most = std::numeric_limits<double>::infinity();
  for (const ident::log::Record& r : records) {
    least = std::max(least, 1.0 / (r.t.back() - r.t.front()));
    most = std::min(most, 0.5 / r.sample_time);
  }
  if (!(*f > least) || !(*f < most)) {
    refuse_option("--cut-off",
                  fmt::format("got {}, expected above {:.4g} Hz, one period of the log, and below {:.6g} "
                              "Hz, half of its sampling frequency",
                              io::in_quotes(o.cut_off), least, most));
  }
  return *f;
}

/// Runs of constant speed, each logged by itself: the speeds of a jog as many controls export them.
bool steady_speeds(const std::vector<ident::log::Record>& records, std::size_t runs) {
  constexpr std::size_t kFewestRuns = 4;
  if (runs < kFewestRuns) return false;
  std::size_t steady = 0;
  std::vector<char> seen(records.size(), 0);
  try {
    for (const ident::map::SteadyRun& run : ident::map::find_steady_runs(records).runs) {
      if (!seen[run.record]) ++steady;
      seen[run.record] = 1;
    }
  } catch (const ident::Refused&) {
    return false;
  }
  return 10 * steady >= 7 * records.size();
}

Identified by_jog(const Options& o, const std::vector<ident::log::Record>& records) {
  ident::methods::JogOptions options;
  options.solver =
      o.solver == "simplex" ? ident::methods::Solver::kSimplex : ident::methods::Solver::kDerivatives;
  if (o.terms >= 0) options.terms = o.terms;
  options.gaussians = o.model != "conventional";
  options.mass = given_mass(o);
  ident::methods::Jog jog = ident::methods::identify_jog(records, options);
  return {std::move(jog.result), std::move(jog.groups), {}, {}, {}};
}

Identified by_position(const Options& o, const std::vector<ident::log::Record>& records) {
  ident::methods::PositionMapOptions options;
  options.mass = given_mass(o);
  options.turn = optional_si(
      o.turn,
      (records.front().position_unit == "rad" ? quantity("rad", "rad") : quantity("m", "mm")).positive(),
      "--turn");
  if (options.turn) {
    // Parts of a much longer turn lie closer together than this way can tell apart; a shorter one is not seen.
    constexpr double kLongest = 20.0, kShortest = 1.0 / 2000.0;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const ident::log::Record& r : records) {
      const auto [a, b] = std::minmax_element(r.x.begin(), r.x.end());
      low = std::min(low, *a), high = std::max(high, *b);
    }
    if (!(*options.turn <= kLongest * (high - low)) || !(*options.turn >= kShortest * (high - low))) {
      const bool turns = records.front().position_unit == "rad";
      const double shown = turns ? 1.0 : 1e3;
      refuse_option(
          "--turn",
          fmt::format("got {}, expected between {:.4g} and {:.4g} {} for the travel of {:.4g} {} in this log",
                      io::in_quotes(o.turn), shown * kShortest * (high - low),
                      shown * kLongest * (high - low), turns ? "rad" : "mm", shown * (high - low),
                      turns ? "rad" : "mm"));
    }
  }
  return {ident::methods::identify_position_map(records, options), {}, {}, {}, {}};
}

Identified by_least_squares(const Options& o, const std::vector<ident::log::Record>& records) {
  // Pulses are driven in open loop, jogs follow a position: without pulses everything is taken for them.
  std::vector<ident::log::Record> pulses, jogs;
  for (const ident::log::Record& r : records) (r.r.empty() ? pulses : jogs).push_back(r);
  if (pulses.empty()) std::swap(pulses, jogs);
  ident::methods::LeastSquaresAOptions options;
  options.solver =
      o.solver == "simplex" ? ident::methods::Solver::kSimplex : ident::methods::Solver::kDerivatives;
  ident::methods::LeastSquaresA a = jogs.empty()
                                        ? ident::methods::identify_least_squares_a(pulses, options)
                                        : ident::methods::identify_least_squares_a(pulses, jogs, options);
  ident::Result result = a.result;
  return {std::move(result), {}, std::move(a), {}, {}};
}

Identified by_break_away(const Options& o, const std::vector<ident::log::Record>& records) {
  ident::methods::BreakAwayOptions options;
  options.mass = given_mass(o);
  return {ident::methods::identify_break_away(records, options).result, {}, {}, {}, {}};
}

Identified identify_records(const Options& o, const Input& in) {
  const std::vector<ident::log::Record>& records = in.records;
  if (o.method == "idim-ls") {
    if (records.size() > 1) {
      refuse_option("LOG",
                    fmt::format("{} records, but --method idim-ls takes one without gaps", records.size()));
    }
    ident::methods::IdimOptions options;
    options.by_direction = o.model == "asymmetric";
    ident::methods::IdimResult idim = ident::methods::identify_idim_ls(records.front(), options);
    return {std::move(idim.result), {}, {}, std::move(idim.published), {}};
  }
  if (o.method == "least-squares") return by_least_squares(o, records);
  if (o.method == "break-away") return by_break_away(o, records);
  if (o.method == "gravity") return {ident::methods::identify_gravity(records), {}, {}, {}, {}};
  if (o.method == "constant-acceleration")
    return {ident::methods::identify_constant_acceleration(records), {}, {}, {}, {}};
  if (o.method == "position-map") return by_position(o, records);
  if (o.method == "jog") return by_jog(o, records);
  if (o.method == "velocity-map") {
    ident::methods::VelocityMapOptions options;
    if (o.terms >= 0) options.terms = o.terms;
    options.mass = given_mass(o);
    return {ident::methods::identify_velocity_map(records, options), {}, {}, {}, {}};
  }
  if (ident::methods::held_at_standstill(records)) {
    check_auto(o, "position-map", "the axis is held at standstill");
    return by_position(o, records);
  }
  if (steady_speeds(records, in.runs)) {
    check_auto(o, "jog", "runs of constant speed");
    return by_jog(o, records);
  }
  if (in.one_direction) {
    check_auto(o, "position-map", "the axis moves in one direction only");
    Identified identified = by_position(o, records);
    identified.result.warnings.insert(
        identified.result.warnings.begin(),
        "one direction only: mass, and friction of that direction including any load; add the motion back for the rest");
    return identified;
  }
  ident::drive::DriveFitOptions options;
  if (o.terms >= 0) options.terms = o.terms;
  if (o.model == "conventional") options.most_terms = 0;
  if (o.model == "gaussian") options.symmetric = false;
  options.mass = given_mass(o);
  options.cut_off = given_cut_off(o, records);
  std::vector<ident::log::Record> with_positions;
  for (const ident::log::Record& r : records) with_positions.push_back(ident::map::with_positions(r));
  return {ident::drive::identify_drive(with_positions, options), {}, {}, {}, {}};
}

/// Names and SI units in the order of the law.
std::vector<std::pair<std::string, std::string>> published_names(bool by_direction) {
  if (by_direction) return {{"M", "kg"}, {"Fv+", "N s/m"}, {"Fc+", "N"}, {"Fv-", "N s/m"}, {"Fc-", "N"}};
  return {{"M", "kg"}, {"Fv", "N s/m"}, {"Fc", "N"}, {"offset", "N"}};
}

nlohmann::ordered_json published_json(const ident::methods::IdimResult::Published& p, bool by_direction) {
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
std::string published_text(const ident::methods::IdimResult::Published& p, bool by_direction) {
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

std::string model_a_text(const ident::methods::LeastSquaresA& a) {
  std::string out = fmt::format(
      "\nMass by the printed forward Euler form: {:.4g} N s2/mm; by simple least squares, without Coulomb "
      "friction: {:.4g} N s2/mm.\n",
      a.mass_euler * 1e-3, a.simple_mass * 1e-3);
  const auto line = [&](const char* name, const std::optional<ident::methods::ViscousCorrection>& c) {
    if (!c) return;
    out += fmt::format(
        "Viscous coefficient corrected by jogging, {}: {:.5g} N s/mm (95 %: {:.5g} … {:.5g}), Coulomb "
        "{:.5g} and {:.5g} N",
        name, c->alpha2 * 1e-3, c->alpha2_interval.low * 1e-3, c->alpha2_interval.high * 1e-3,
        c->alpha0_positive, c->alpha0_negative);
    if (c->stribeck)
      out += fmt::format(", static {:.5g} N, v0 {:.3g} mm/s", c->stribeck->alpha1, c->stribeck->v0 * 1e3);
    out += ".\n";
  };
  line("disturbance observer", a.observer);
  line("Kalman", a.kalman);
  return out;
}

/// What the logs themselves say about how far the result can be trusted.
void warn_of_records(const std::vector<ident::log::Record>& records, const std::string& method,
                     std::vector<std::string>& warnings) {
  if (method != "least-squares") return;
  bool open = false;
  for (const ident::log::Record& r : records) open = open || r.r.empty();
  if (open) return;
  warnings.push_back(
      records.front().source +
      ": least squares is made for pulses in open loop; in a closed-loop log the force reacts to the "
      "noise, and mass and interval can be far off (use --method velocity-map)");
}

Input read_logs(const Options& o) {
  Input in;
  const LogOptions log_options = with_map_file(o.log);
  constexpr double kFewForward = 0.002;  // of the moving rows: noise at standstill
  bool forward = false, backward = false;
  for (const std::string& path : o.logs) {
    const io::Log log = read_log(path, log_options);
    std::vector<std::string> notes;
    // Gaps are found again, with their repair, when the log is cleaned.
    for (const std::string& note : log.notes) {
      if (!note.starts_with("time has")) notes.push_back(note);
    }
    ident::log::Conditioned clean = condition_log(log, log_options, &notes);
    for (const ident::log::Finding& f : clean.findings) notes.push_back(f.text);
    for (std::string& note : notes) {
      in.notes.push_back(note.starts_with(path) ? std::move(note) : fmt::format("{}: {}", path, note));
    }
    forward = forward || clean.coverage.forward > kFewForward;
    backward = backward || clean.coverage.forward < 1.0 - kFewForward;
    in.runs += clean.run.empty() ? 1 : 1 + *std::max_element(clean.run.begin(), clean.run.end());
    for (ident::log::Record& r : clean.records) in.records.push_back(std::move(r));
    in.sources += (in.sources.empty() ? "" : ", ") + path;
  }
  in.one_direction = forward != backward;
  return in;
}

int inspect_logs(const Options& o) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool usable = true;
  const LogOptions log_options = with_map_file(o.log);
  for (const std::string& path : o.logs) {
    const Inspection found = inspect(read_log(path, log_options), log_options);
    say(o.common, found.text);
    json.push_back(found.json);
    usable = usable && found.usable;
  }
  write_json(o.common.json, json.size() == 1 ? json.front() : json);
  return usable ? 0 : 1;
}

int identify(const Options& o) {
  check_options(o, o.method, "--method " + o.method);
  if (o.inspect) check_inspect(o);
  std::vector<std::filesystem::path> seen;
  for (const std::string& log : o.logs) {
    std::error_code ignored;
    seen.push_back(std::filesystem::weakly_canonical(log, ignored));
    if (std::find(seen.begin(), seen.end() - 1, seen.back()) != seen.end() - 1) {
      refuse_option("LOG", fmt::format("{} is given twice: it would count as two runs", log));
    }
  }
  check_distinct(o.logs, {o.output, page_of(o.common), o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  io::check_writable(o.output);
  if (o.inspect) return inspect_logs(o);
  const Input in = read_logs(o);
  Identified identified = identify_records(o, in);
  ident::Result& result = identified.result;
  // Constant speeds, standstill and ramps say nothing about the mass; the result says so.
  const bool without_mass = result.method == "jog" || result.method == "position-map" ||
                            result.method == "break-away" || result.method == "gravity";
  if (!without_mass || std::isfinite(result.mass)) require_determined(result, in.sources);
  warn_of_records(in.records, o.method, result.warnings);
  result.warnings.insert(result.warnings.begin(), in.notes.begin(), in.notes.end());
  const std::string& axis = o.log.axis;
  if (!o.output.empty()) {
    if (result.force_unit != "N" || result.position_unit != "m") {
      refuse_option(
          "--output",
          fmt::format("an axis file holds newtons and metres, but this log was identified in {} and {}; "
                      "give --gain{}",
                      result.force_unit, result.position_unit,
                      result.position_unit == "m" ? "" : " and --lead"));
    }
    if (result.friction.eccentric.size() > 0 && result.model == "cogging") {
      refuse_option("--output",
                    "an axis file needs mass and friction, which a log at standstill does not determine");
    }
    if (in.one_direction) {
      refuse_option(
          "--output",
          "an axis file holds friction of both directions, but the axis moves in one only; add the motion back");
    }
    if (!(result.mass > 0.0)) {
      refuse_option(
          "--output",
          "an axis file needs the mass, which this log does not determine; give --mass or add a log "
          "with acceleration");
    }
    io::write_atomically(
        o.output,
        io::write_toml(as_model(result), fmt::format("{}{}, identified from {} by stribeck {} ({}).",
                                                     axis.empty() ? "" : "Axis " + axis + ": ", result.model,
                                                     in.sources, STRIBECK_VERSION, result.method)));
  }
  auto json = report::to_json(result, axis);
  if (identified.published)
    json["published"] = published_json(*identified.published, o.model == "asymmetric");
  if (result.peaks) json["peaks"] = {{"positive", (*result.peaks)[0]}, {"negative", (*result.peaks)[1]}};
  if (identified.model_a) {
    json["forward_euler_mass_kg"] = identified.model_a->mass_euler;
    json["simple_least_squares_mass_kg"] = identified.model_a->simple_mass;
  }
  for (const ident::Result& other : identified.beside) json["beside"].push_back(report::to_json(other, axis));
  write_json(o.common.json, json);
  std::vector<ident::Result> shown{result};
  shown.insert(shown.end(), identified.beside.begin(), identified.beside.end());
  if (!o.common.report.empty()) {
    report::write_identify_report(o.common.report,
                                  {axis, shown, in.sources, typed_command(), STRIBECK_VERSION});
  }
  for (const ident::Result& r : shown) say(o.common, report::text_table(r, axis));
  if (result.peaks && o.method == "velocity-map") {
    say(o.common, fmt::format("\nPeaks of the smoothed map, by which the thesis chooses the number of "
                              "terms: {} for v > 0, {} for v < 0.\n",
                              (*result.peaks)[0], (*result.peaks)[1]));
  }
  if (identified.model_a) say(o.common, model_a_text(*identified.model_a));
  if (identified.published) say(o.common, published_text(*identified.published, o.model == "asymmetric"));
  return 0;
}

}  // namespace

void add_identify(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "identify", "Identify mass and friction of an axis from its logs, with 95 % confidence intervals");
  auto o = std::make_shared<Options>();
  verb->add_option("log", o->logs, "Logs of one axis; several are fitted together")
      ->required()
      ->type_name("LOG");
  verb->add_flag("--inspect", o->inspect,
                 "Only print what the logs contain and what can be identified from them");
  verb->add_option(
          "--model", o->model,
          "Friction model: auto, conventional, gaussian, or asymmetric (idim-ls only: friction by direction)")
      ->check(one_of({"auto", "gaussian", "conventional", "asymmetric"}))
      ->capture_default_str();
  verb->add_option(
          "--method", o->method,
          "Method: auto (any motion), or by name: velocity-map (Model C), position-map (Model D, or cogging at "
          "standstill), jog (Model B, constant speeds), least-squares (Model A, pulses, and jogs for the "
          "viscous correction), break-away (slow ramps), gravity (both directions at equal speed), "
          "constant-acceleration (mass), idim-ls (published protocol)")
      ->check(one_of({"auto", "velocity-map", "position-map", "jog", "least-squares", "break-away", "gravity",
                      "constant-acceleration", "idim-ls"}))
      ->capture_default_str();
  verb->add_option("--terms", o->terms,
                   "Number of Gaussians in each direction; left out: chosen by the error on held-out motion")
      ->check(whole_from(0, 6));
  verb->add_option("--mass", o->mass, "Known equivalent mass, e.g. \"57.65 N s2/mm\"; left out: identified")
      ->type_name("MASS");
  verb->add_option("--cut-off", o->cut_off,
                   "Low-pass filter at this frequency; left out: chosen from the noise")
      ->type_name("HZ");
  verb->add_option(
          "--turn", o->turn,
          "Known travel per turn of the screw: periodic terms are searched at this period and its integer fractions (position-map)")
      ->type_name("TURN");
  verb->add_option("--solver", o->solver, "derivatives, or simplex (Nelder-Mead, as in published methods)")
      ->check(one_of({"derivatives", "simplex"}))
      ->capture_default_str();
  add_log_options(*verb, o->log);
  verb->add_option("-o,--output", o->output, "Axis file to write")->type_name("AXIS.toml");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck identify x-pulses-log.csv x-sine-log.csv --axis x -o x.toml --report report");
  verb->callback([o, &action] { action = [o] { return identify(*o); }; });
}

}  // namespace stribeck::cli
