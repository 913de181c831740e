#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include <apps/cli/commands.hpp>
#include <apps/cli/service/commission_linuxcnc.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/targets/linuxcnc/hal_lines.hpp>
#include <stribeck/targets/target.hpp>
#include <stribeck/workflow/commissioning/running_linuxcnc.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::cli {
namespace {

namespace commissioning = workflow::commissioning;

/// Said at once: the person reads it while the machine moves.
void say_now(const Common& common, const std::string& text) {
  say(common, io::printable_lines(text) + '\n');
  std::fflush(stdout);
}

/// On standard error: the JSON may go to standard output. With --quiet the motion has not been said yet.
bool ask_on_terminal(const Common& common, const std::string& motion) {
  if (common.quiet || common.json == kStandardOutput)
    std::fputs((io::printable_lines(motion) + '\n').c_str(), stderr);
  std::fputs("Begin? [y/N] ", stderr);
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "Y" || answer == "yes";
}

/// The setp lines of the target linuxcnc for one controller.
std::string controller_lines(const std::string& axis_file, const std::string& prefix, double omega,
                             const std::string& folder) {
  targets::ExportRequest request;
  request.files = {axis_file};
  request.names = {prefix};
  request.omega = fmt::format("{:.9g} rad/s", omega);
  request.output = folder + "/.lines.hal";
  request.command = typed_command();
  static_cast<void>(targets::find_target("linuxcnc")->write(request));
  std::string text = io::read_text(request.output);
  static_cast<void>(std::remove(request.output.c_str()));
  return text;
}

nlohmann::ordered_json to_json(const commissioning::Outcome& o) {
  nlohmann::ordered_json json;
  json["schema"] = "stribeck.commission-linuxcnc/1";
  json["stages"] = nlohmann::ordered_json::array();
  for (const auto& s : o.stages)
    json["stages"].push_back({{"stage", s.stage}, {"earlier", s.earlier}, {"says", s.says}});
  const auto micrometres = [](const std::optional<double>& m) {
    return m ? nlohmann::ordered_json(1e6 * *m) : nlohmann::ordered_json(nullptr);
  };
  json["circle_before_um"] = micrometres(o.before);
  json["circle_after_um"] = micrometres(o.after);
  json["page"] = o.page.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(o.page);
  json["files"] = o.files;
  return json;
}

int undo_all(const Common& common, const RunningArguments& a) {
  std::unique_ptr<commissioning::RunningMachine> machine;
  try {
    machine = commissioning::running_linuxcnc(a.what.ini);
  } catch (const commissioning::MachineError&) {
    say(common, "LinuxCNC does not run: only files are given back.\n");
  }
  const auto done = commissioning::undo(machine.get(), a.what.output);
  for (const std::string& line : done) say_now(common, line);
  if (done.empty()) say(common, "Nothing was changed.\n");
  return 0;
}

}  // namespace

int commission_running(const Common& common, const RunningArguments& a) {
  try {
    if (a.undo) return undo_all(common, a);
    if (!a.yes && ::isatty(STDIN_FILENO) == 0)
      refuse_option("--yes", "is missing: there is no terminal to ask before the machine moves");
    commissioning::Dialogue dialogue;
    dialogue.say = [&](const std::string& text) { say_now(common, text); };
    dialogue.agree = [&](const std::string& motion) { return a.yes || ask_on_terminal(common, motion); };
    dialogue.controller_lines = [&](const std::string& file, const std::string& prefix, double omega) {
      return controller_lines(file, prefix, omega, a.what.output);
    };
    dialogue.initial_value = [](const std::string& name) { return targets::linuxcnc::initial_value(name); };
    const auto machine = commissioning::running_linuxcnc(a.what.ini);
    const commissioning::Outcome done = commissioning::run(*machine, a.what, dialogue);
    write_json(common.json, to_json(done), made_from({a.what.machine, a.what.ini}));
    if (!done.page.empty()) say(common, fmt::format("Circles: {}\n", done.page));
    return 0;
  } catch (const commissioning::Stopped& e) {
    std::fputs(fmt::format("stribeck: stopped: {}\n", io::printable(e.what())).c_str(), stderr);
    return 1;
  } catch (const commissioning::MachineError& e) {
    std::fputs(fmt::format("stribeck: {}: {}\n", a.what.ini, io::printable(e.what())).c_str(), stderr);
    return 2;
  }
}

}  // namespace stribeck::cli
