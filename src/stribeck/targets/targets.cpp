#include <algorithm>
#include <array>
#include <vector>

#include <stribeck/targets/all.hpp>
#include <stribeck/targets/pulse/pulse_target.hpp>
#include <stribeck/targets/steady/steady_target.hpp>
#include <stribeck/targets/target.hpp>

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

}  // namespace

std::span<const SteadyTarget* const> steady_targets() { return kSteady; }

std::span<const PulseTarget* const> pulse_targets() { return kPulses; }

std::span<const Target> all_targets() {
  static const std::vector<Target> all = made();
  return all;
}

const Target* find_target(std::string_view name) {
  const auto all = all_targets();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Target& t) { return t.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace stribeck::targets
