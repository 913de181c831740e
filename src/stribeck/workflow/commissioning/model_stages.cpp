#include <fmt/format.h>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include <stribeck/core/number_text.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/circle_logs.hpp>
#include <stribeck/workflow/commissioning/originals.hpp>
#include <stribeck/workflow/commissioning/parts.hpp>
#include <stribeck/workflow/stages/stages.hpp>

namespace stribeck::workflow::commissioning {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHalFile = "stribeck-commissioned.hal";
constexpr double kTakenOver = 0.3;  // after switching on, until a fault would show [s]

/// Parameters of the model that the controller had before, where the new one does not set them: a controller refuses those of a kind
/// that is not chosen.
std::string reset_lines(Work& work, const RunningAxis& a, const std::string& lines) {
  std::set<std::string> set;
  for (const auto& [name, unused] : setp_lines(lines)) set.insert(name);
  std::string out;
  for (const HalItem& p : work.machine.parameters(a.controller + ".friction.*")) {
    const double initial = work.dialogue.initial_value(p.name.substr(a.controller.size() + 1));
    const double now = number_in(p.value);
    const bool same =
        std::isnan(initial) ? std::isnan(now) : std::abs(now - initial) <= 1e-6 * std::abs(initial);
    if (!same && set.count(p.name) == 0)
      out += fmt::format("setp {} {}  # of the model before\n", p.name, initial);
  }
  return out;
}

/// setp lines of all axes with their new models.
std::string model_lines(Work& work) {
  std::string out;
  for (const RunningAxis& a : work.axes.axes) {
    const std::string lines =
        work.dialogue.controller_lines(work.of("identify", a.name + ".toml"), a.controller,
                                       value_in_hal(work.machine, a.controller + ".omega"));
    out += lines + reset_lines(work, a, lines);
  }
  return out;
}

/// Largest radial error of both directions; the log stays in the folder of the stage.
double drive_circle(Work& work, const CirclePlan& plan, const std::string& log) {
  run_program(work, "approach", plan.approach(), 60.0);
  std::vector<std::pair<AxisRows, AxisRows>> circles;
  for (const bool ccw : {true, false}) {
    const std::string name = ccw ? "circle-ccw" : "circle-cw";
    const std::string raw = work.folder + '/' + name + ".halsampler";
    run_program(work, name, plan.laps(ccw), 4.0 * plan.lap_time(), raw);
    const auto rows = read_record(work.axes, raw);
    circles.push_back(counted_laps(plan, rows[static_cast<std::size_t>(plan.u - work.axes.axes.data())],
                                   rows[static_cast<std::size_t>(plan.v - work.axes.axes.data())]));
  }
  write_circle_log(circles, log);
  CircleOptions o;
  o.logs = {log};
  o.size = fmt::format("{:.9g} mm", 1e3 * plan.radius);
  o.where = {"circle=1", "circle=2"};
  o.maps = {"x=x", "y=y", "rx=rx", "ry=ry"};
  double worst = 0.0;
  for (const auto& c : judge_circles(o).logs.front().circles) worst = std::max(worst, c.max_error);
  return worst;
}

/// One page with both circles.
void write_page_of_circles(Work& work, const CirclePlan& plan) {
  CircleOptions o;
  o.logs = {work.of("before", "circle.csv"), work.folder + "/circle.csv"};
  o.labels = {"before", "after"};
  o.size = fmt::format("{:.9g} mm", 1e3 * plan.radius);
  o.where = {"circle=1", "circle=2"};
  o.maps = {"x=x", "y=y", "rx=rx", "ry=ry"};
  report::CircleReportInput input = judge_circles(o);
  input.title = "Circle before and after: " + work.description.name;
  input.version = work.options.version;
  report::write_circle_report({work.folder + "/page"}, input);
}

/// The circle with the models, which the controllers have.
io::Json judge_models(Work& work, const CirclePlan& plan) {
  work.machine.switch_on();
  work.machine.sleep(kTakenOver);
  if (Trouble why = trouble(work, work.machine.state()); why.any()) {
    if (!why.by_hand) why.why.insert(0, "with the identified models: ");
    stop_for(why);
  }
  if (plan.u == nullptr) return {{"max_um", nullptr}};
  const double before = work.folders.result("before")->value("max_um", kNaN) * 1e-6;
  const double after = drive_circle(work, plan, work.folder + "/circle.csv");
  write_page_of_circles(work, plan);
  const std::string numbers = fmt::format("{} um at most, {} um before", report::decimals(1e6 * after, 2),
                                          report::decimals(1e6 * before, 2));
  if (!(after < before)) throw Stopped("the circle is not better with the models: " + numbers);
  work.found("circle after: " + numbers);
  return {{"max_um", 1e6 * after}};
}

}  // namespace

io::Json identify_axes(Work& work) {
  StageOptions o;
  o.machine = work.options.machine;
  o.folder = work.of("record", "logs");
  o.output = work.folder;
  o.log.axis = work.options.axis;
  o.limits = work.options.limits;
  o.version = work.options.version;
  const report::CommissionReportInput found = commission_from_logs(o);
  std::string refused;
  for (const auto& a : found.axes) {
    work.found(fmt::format(
        "axis {}: {}{}{}", a.axis, report::name_of(a.stage),
        a.mass > 0.0 ? fmt::format(", mass {} kg (95 %: {} to {})", report::significant(a.mass, 4),
                                   report::significant(a.mass_low, 4), report::significant(a.mass_high, 4))
                     : "",
        a.verdict.empty()
            ? ""
            : fmt::format(", force error on {} {} %: {}", fs::path(a.held_out).filename().string(),
                          report::decimals(a.force_error, 1), a.verdict)));
    for (const std::string& text : a.warnings) work.found(fmt::format("axis {}: warning: {}", a.axis, text));
    if (a.stage == report::CommissionStage::kReady) continue;
    for (const std::string& text : a.open) work.found(fmt::format("axis {}: open: {}", a.axis, text));
    refused += (refused.empty() ? "" : ", ") + a.axis;
  }
  if (!refused.empty())
    throw Stopped(fmt::format("no axis file was written: axis {} is not ready (record again: --stage record)",
                              refused));
  return report::to_json(found);
}

io::Json circle_before(Work& work) {
  require_ready(work);
  const CirclePlan plan = plan_circle(work.axes);
  if (plan.u == nullptr) {
    work.found("no circle: it needs two axes of X, Y and Z");
    return {{"max_um", nullptr}};
  }
  work.ask("Moves " + plan.words() + ", with the controllers as they are.");
  const double worst = drive_circle(work, plan, work.folder + "/circle.csv");
  work.found(fmt::format("circle before: {} um at most", report::decimals(1e6 * worst, 2)));
  return {{"max_um", 1e6 * worst}};
}

io::Json circle_after(Work& work) {
  require_ready(work);
  const std::string lines = model_lines(work);
  io::write_atomically(work.folder + '/' + kHalFile, lines);
  const CirclePlan plan = plan_circle(work.axes);
  std::string motion =
      "Switches the machine off, gives the controllers the identified models, and switches it on.";
  if (plan.u != nullptr) motion += " Then moves " + plan.words() + ".";
  work.ask(motion);
  work.machine.switch_off();
  ChangedValues changed(work.machine, work.folders.path(kModelValues));
  changed.set(setp_lines(lines));
  try {
    return judge_models(work, plan);
  } catch (...) {
    // Whatever went wrong, the machine must not go on with models that were not judged.
    if (end_safely(work.machine, work.folders.path(kModelValues)))
      work.dialogue.say("The models are taken out again; the machine is off.");
    throw;
  }
}

io::Json write_configuration(Work& work) {
  const std::string ini = fs::absolute(work.options.ini).string();
  const std::string hal = (fs::path(ini).parent_path() / kHalFile).string();
  const std::string text = with_halfile(io::read_text(ini), kHalFile);
  if (text.empty())
    throw io::InputError(
        {work.options.ini, 0, "[HAL]HALFILE", "is missing: the models have no place (add one HALFILE line)"});
  const std::string lines = io::read_text(work.of("after", kHalFile));
  const std::string head =
      "# Written by: stribeck commission --linuxcnc. The models of the axes, for the controllers that were loaded before.\n";
  std::vector<std::pair<std::string, std::string>> files{{hal, head + lines}};
  if (text != io::read_text(ini)) files.emplace_back(ini, text);
  replace_files(work.options.output, files);
  io::Json written = io::Json::array();
  for (const auto& [path, unused] : files) {
    written.push_back(path);
    work.found("written: " + path);
  }
  work.found("The originals are in " + work.folders.path("originals") + "; --undo gives them back.");
  return {{"files", written}};
}

}  // namespace stribeck::workflow::commissioning
