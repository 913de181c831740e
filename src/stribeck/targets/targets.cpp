#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <vector>

#include <stribeck/ident/shown.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/targets/all.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/steady/steady_target.hpp>
#include <stribeck/targets/target.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets {

// A target with a writer of its own: its name here and in all_targets(). One that holds the steady friction: its name here and in
// kSteady; one with a pulse at the reversal: in kPulses.
extern const Target kLinuxCnc, kMoteus;
extern const PulseTarget kSinumerik, kTnc, kFanuc;
extern const SteadyTarget kCsv, kJson, kC, kStructuredText, kPid, kRos2Control, kCia402, kIsg, kAx8000, kKeba,
    kMitsubishi, kPmac, kIndraDrive, kMujoco, kModelica, kSimscape, kFmu;

namespace {

constexpr std::array<const SteadyTarget*, 17> kSteady{
    &kCsv,  &kJson,       &kC,    &kStructuredText, &kPid,    &kRos2Control, &kCia402,   &kIsg, &kAx8000,
    &kKeba, &kMitsubishi, &kPmac, &kIndraDrive,     &kMujoco, &kModelica,    &kSimscape, &kFmu};

constexpr std::array<const PulseTarget*, 3> kPulses{&kSinumerik, &kTnc, &kFanuc};

std::vector<Target> made() {
  std::vector<Target> out{kLinuxCnc};
  for (const SteadyTarget* t : kSteady) {
    out.push_back(
        {t->name, "axis files of identify", t->what,
         "nearest to the friction in the form of the target; the largest and the RMS error are printed",
         [t](const ExportRequest& o) { return write_steady(*t, o); }});
  }
  for (const PulseTarget* t : kPulses) {
    out.push_back({t->name, "axis files of identify", t->what,
                   "the form of the pulse; the contour error that remains on a circle is printed",
                   [t](const ExportRequest& o) { return write_pulse(*t, o); }});
  }
  out.push_back(kMoteus);
  out.push_back(
      {"all", "axis files of identify",
       "a folder with every export except linuxcnc, each if the options that it needs are given (a pulse needs --controller), "
       "and a table of their errors",
       "that of each is printed", write_all});
  return out;
}

bool is_rotary(const std::string& axis_file) {
  const io::Node content = io::load_toml(axis_file);
  const io::Node* rotary = content.find("rotary");
  return rotary != nullptr && rotary->flag;
}

}  // namespace

std::span<const SteadyTarget* const> steady_targets() { return kSteady; }

std::span<const PulseTarget* const> pulse_targets() { return kPulses; }

std::span<const Target> all_targets() {
  static const std::vector<Target> all = made();
  return all;
}

std::vector<std::string> inputs_of(const ExportRequest& o) {
  std::vector<std::string> inputs = o.files;
  for (const std::string& text : o.axis_files) inputs.push_back(workflow::axis_and_file(text).second);
  if (!o.machine.empty()) inputs.push_back(o.machine);
  if (!o.controller.empty()) inputs.push_back(o.controller);
  return inputs;
}

std::vector<std::size_t> axis_numbers(const std::vector<std::string>& names) {
  constexpr std::string_view kUpper = "XYZABCUVW";
  std::vector<std::size_t> numbers, order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (const std::string& name : names) {
    const std::size_t at =
        name.size() == 1 ? std::min(kAxisLetters.find(name), kUpper.find(name)) : std::string::npos;
    if (at == std::string::npos || std::find(numbers.begin(), numbers.end(), at) != numbers.end())
      return order;
    numbers.push_back(at);
  }
  return numbers;
}

std::vector<std::string> axes_in_files(const ExportRequest& request) {
  std::vector<std::string> names;
  for (const std::string& file : request.files) {
    const io::Node content = io::load_toml(file);
    const io::Node* axis = content.find("axis");
    names.push_back(axis == nullptr ? std::string() : axis->text);
  }
  return names;
}

bool any_rotary(const ExportRequest& request) {
  return std::any_of(request.files.begin(), request.files.end(), is_rotary);
}

namespace {

/// What is lost between motor and table is in no export: it belongs where the control compensates backlash.
std::string words_of_lost_motion(const std::string& file, const control::LostMotionParams& p,
                                 const ident::Shown& shown) {
  const double wind_up = p.stiffness ? 2.0 * p.table_friction / *p.stiffness : 0.0;
  std::string words;
  if (p.backlash > 0.0 || p.backlash_slope != 0.0) {
    words = fmt::format("{} has a backlash of {} between motor and table", file, shown.length(p.backlash));
    if (p.backlash_slope != 0.0)
      words +=
          fmt::format(" at position 0, which changes by {} in every metre", shown.length(p.backlash_slope));
    words += ". It is not in what was written: type it in where the control compensates backlash.\n";
  }
  if (wind_up > 0.0)
    words += fmt::format(
        "{} has a wind-up of {} between motor and table, from one direction to the other. It is not in what was written, and no backlash: "
        "a backlash compensation that takes it out as well does so only at the friction of today.\n",
        file, shown.length(wind_up));
  return words;
}

}  // namespace

std::string axis_notes(const ExportRequest& request) {
  std::string notes;
  std::map<std::string, std::string> first_of;  // file of each axis
  for (const std::string& file : request.files) {
    if (is_rotary(file)) notes += fmt::format("{} is of {}.\n", file, workflow::kRotaryAsLinear);
    if (io::load_toml(file).find("axes") != nullptr) continue;
    const auto axis = workflow::read_axis_file(file);
    const std::string name = axis.axis.value_or("");
    if (const auto other = first_of.try_emplace(name, file); !name.empty() && !other.second)
      notes += fmt::format(
          "{} and {} both say that they are of axis {}: the names follow the order of the files.\n",
          other.first->second, file, name);
    const ident::Shown shown("m", "N", axis.rotary.value_or(false));
    if (const auto& spring = axis.model.friction.spring; spring && (spring->from || spring->to))
      notes += fmt::format("{} has a spring that is known from {} to {}; beyond, its force stays.\n", file,
                           spring->from ? shown.length(*spring->from) : "the beginning",
                           spring->to ? shown.length(*spring->to) : "the end");
    if (axis.lost_motion) notes += words_of_lost_motion(file, *axis.lost_motion, shown);
  }
  return notes;
}

const Target* find_target(std::string_view name) {
  const auto all = all_targets();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Target& t) { return t.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace stribeck::targets
