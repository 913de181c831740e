#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <apps/cli/commands.hpp>
#include <apps/cli/option_groups.hpp>
#include <apps/cli/shared.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/pages/verify_report.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

struct Options {
  Common common;
  std::vector<std::string> files;  ///< axis files, then the log
  LogArguments log;
  std::string controller;
  std::string force_shift;
};

/// A file of another kind breaks nearly every rule of an axis file, so one message replaces all of them.
template <class T>
T read_one(const std::string& path, const std::string& hint) {
  try {
    return io::read_toml<T>(path);
  } catch (const io::InputError& e) {
    io::Problem first = e.problems().front();
    const std::size_t more = e.problems().size() - 1;
    if (more > 0) {
      first.message += fmt::format("; {} more problem{} ({})", more, more == 1 ? "" : "s", hint);
    } else if (first.message.find("TOML") != std::string::npos) {
      first.message += fmt::format(" ({})", hint);
    }
    throw io::InputError(std::move(first));
  }
}

int verify(const Options& o) {
  if (o.files.size() < 2) {
    refuse_option("AXIS.toml", "missing, expected one or more axis files and then the log");
  }
  const std::string& path = o.files.back();
  std::vector<std::string> inputs = o.files;
  inputs.push_back(o.controller);
  check_distinct(inputs, {o.common.json});
  const OutputFolder page_folder = check_outputs(o.common);
  std::vector<std::pair<std::string, friction::AxisModel>> models;
  for (std::size_t i = 0; i + 1 < o.files.size(); ++i) {
    models.emplace_back(
        o.files[i], read_one<friction::AxisModel>(
                        o.files[i], "expected an axis file as identify -o writes it; the log comes last"));
  }
  std::optional<ident::replay::ReplayController> controller;
  if (!o.controller.empty())
    controller =
        read_one<ident::replay::ReplayController>(o.controller, "expected a controller, kind cascade or pd");

  const LogOptions log_options = o.log.resolved();
  report::VerifyReportInput page;
  page.axis = log_options.axis;
  page.source = path;
  page.command = typed_command();
  page.version = STRIBECK_VERSION;
  const io::Log log = read_log(path, log_options);
  page.warnings = log.notes;
  const ident::log::Conditioned clean = condition_log(log, log_options, &page.warnings);
  for (const ident::log::Finding& f : clean.findings) page.warnings.push_back(f.text);

  std::string why;
  for (const ident::log::Record& record : clean.records) {
    if (record.force_unit != "N" || record.position_unit != "m") {
      refuse_option("--gain",
                    fmt::format("missing: an axis file holds newtons and metres, the log has {} and {}",
                                record.force_unit, record.position_unit));
    }
    ident::replay::ReplayOptions options;
    if (!o.force_shift.empty()) {
      // A held force belongs to the motion half a row later, without any delay (ident/motion.hpp).
      const double shift = option_si("--force-shift", o.force_shift, quantity("s", "ms"));
      constexpr double kMost = 99.0;  // rows; half a row is added
      if (std::abs(shift) > kMost * record.sample_time) {
        refuse_option("--force-shift",
                      fmt::format("got {}, expected at most {:.4g} ms, {:g} rows of this log, either way",
                                  io::in_quotes(o.force_shift), 1e3 * kMost * record.sample_time, kMost));
      }
      options.delay = -shift - 0.5 * record.sample_time;
    }
    report::VerifiedPart part;
    try {
      for (const auto& [name, model] : models) {
        report::VerifiedModel one{name, ident::replay::replay_open_loop(model, record, options), {}};
        if (controller) one.closed = ident::replay::replay_closed_loop(model, *controller, record, options);
        if (const std::size_t outside = one.open.restarted.outside; outside > 0) {
          page.warnings.push_back(
              fmt::format("{}: {} of {} rows are at velocities outside the range of the identified model",
                          name, outside, record.x.size()));
        }
        part.models.push_back(std::move(one));
      }
    } catch (const ident::Refused& e) {
      // A piece of a cut log may be too short or stand still; the other pieces still count.
      if (why.empty()) why = e.what();
      if (clean.records.size() == 1) throw;
      page.warnings.push_back(fmt::format("a part is left out: {}", e.what()));
      continue;
    }
    part.record = record;
    page.parts.push_back(std::move(part));
  }
  if (page.parts.empty()) throw ident::Refused(why.empty() ? path + ": no part can be replayed" : why);

  write_json(o.common.json, report::to_json(page));
  if (!o.common.report.empty()) report::write_verify_report(o.common.report, page);
  say(o.common, report::text_table(page));
  return 0;
}

}  // namespace

void add_verify(CLI::App& app, Action& action) {
  auto* verb = app.add_subcommand(
      "verify",
      "Test identified models on a log that was not used to identify them, in open and closed loop");
  auto o = std::make_shared<Options>();
  verb->add_option("files", o->files, "Axis files written by identify; the last file is the log")
      ->required()
      ->type_name("AXIS.toml... LOG");
  add_log_options(*verb, o->log);
  verb->add_option(
          "--controller", o->controller,
          "TOML file of the position controller that made the log (kind cascade or pd, forces in N): "
          "replays the closed loop as well")
      ->type_name("FILE.toml");
  verb->add_option(
          "--force-shift", o->force_shift,
          "Time by which the force is later in the log than its motion (force_shift of identify); left out: a commanded force that is held over the period")
      ->type_name("TIME");
  add_common(*verb, o->common);
  refuse_empty_options(*verb);
  verb->footer(
      "Example:\n  stribeck verify a.toml b.toml c.toml x-unseen-log.csv --axis x --report report\n"
      "  stribeck verify x.toml log.csv --gain \"35.15 N/V\" --controller controller.toml");
  verb->callback([o, &action] { action = [o] { return verify(*o); }; });
}

}  // namespace stribeck::cli
