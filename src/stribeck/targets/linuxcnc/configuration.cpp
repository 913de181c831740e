#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <stribeck/io/error.hpp>
#include <stribeck/targets/linuxcnc/configuration.hpp>
#include <stribeck/targets/linuxcnc/hal_lines.hpp>
#include <stribeck/targets/linuxcnc/lincurve.hpp>

namespace stribeck::targets::linuxcnc {

namespace {

std::string about(const Configuration& c) {
  std::string out = fmt::format(
      "LinuxCNC configuration of the virtual machine \"{}\".\n{}\n\n"
      "  linuxcnc machine.ini        with the AXIS screen: F1, F2, home all (Ctrl-Home), R\n"
      "  linuxcnc -r headless.ini    plays demo.ngc without a screen, records run.log; STRIBECK_PROGRAM "
      "and STRIBECK_LOG name others\n\n"
      "The components stribeck_*.so must stand in LinuxCNC's module folder (docs/guides/linuxcnc.md of "
      "Stribeck).\n\n",
      c.name, c.made);
  out +=
      "motion.hal            motion and signals\n"
      "control-axis.hal      one stribeck_axis for each joint; the one that both INI files name\n";
  if (has_contour(c)) out += "control-contour.hal   one stribeck_contour for all joints\n";
  out +=
      "control-pid.hal       stock pid at the same gains\n"
      "control-lincurve.hal  the same with the steady friction in the 16 points of lincurve\n"
      "record.hal            halsampler; run.log.toml names its columns\n"
      "drives.hal            the virtual drives; left out on a real machine\n"
      "demo.ngc              a small program within the travel\n"
      "identify.ngc          motion from whose log axis files are made, for each axis:\n"
      "                      stribeck identify run.log ";
  if (records_command(c)) out += "--map r=x-cmd ";
  out +=
      "--map x=x-fb --map force=x-force -o x.toml\n"
      "play.py               what headless.ini has for a screen\n"
      "tool.tbl              LinuxCNC's tool table, empty\n"
      "written.txt           by which export knows files that were edited since; it does not write over "
      "them\n"
      "\nChoices of your own, such as law, belong in a HAL file of yours that the INI files name after the "
      "control file: the last setp\n"
      "counts, and a new export writes over neither.\n"
      "\nWhat a run without a screen leaves:\n"
      "run.log               the record; positions in machine units, forces in N. Where rows were lost it "
      "is run.log.incomplete\n"
      "run.log.clocks        median time of each function of the servo thread, in clocks of the processor\n"
      "machine.var           LinuxCNC's own variables\n";
  for (const HalAxis& a : c.axes) {
    if (angular(a)) {
      out += fmt::format(
          "\nAxis {}: one degree is {:.6g} mm of the machine file, which holds rotary axes at a radius of "
          "{:g} mm.\n",
          capital(a), 1e3 * unit_of(a), 1e3 * a.radius);
    }
  }
  return out;
}

}  // namespace

/// Whether one stribeck_contour can control all axes.
bool has_contour(const Configuration& c) {
  return (c.axes.size() == 2 || c.axes.size() == 3) && std::none_of(c.axes.begin(), c.axes.end(), angular);
}

std::vector<std::string> linuxcnc_letters(const sim::Machine& machine, const std::string& file) {
  std::vector<std::string> letters;
  for (const auto& [name, unused] : machine.axes) {
    std::string letter = name;
    if (letter.size() == 1 && letter.front() >= 'A' && letter.front() <= 'Z')
      letter.front() = static_cast<char>(letter.front() - 'A' + 'a');
    if (letter.size() != 1 || letter.find_first_of("xyzabcuvw") == std::string::npos) {
      throw io::InputError(
          {file, 0, "axes." + name,
           "expected one of LinuxCNC's letters x, y, z, a, b, c, u, v, w (rename the axis)"});
    }
    if (std::find(letters.begin(), letters.end(), letter) != letters.end()) {
      throw io::InputError(
          {file, 0, "axes." + name,
           fmt::format(
               "there is a second axis {}: LinuxCNC does not distinguish small and capital letters (rename one)",
               letter)});
    }
    letters.push_back(letter);
  }
  return letters;
}

NamedTexts configuration_files(const Configuration& c) {
  NamedTexts files{{"README", about(c)},
                   {"motion.hal", motion(c)},
                   {"control-axis.hal", axis_control(c)},
                   {"control-pid.hal", pid_control(c, false)},
                   {"control-lincurve.hal", pid_control(c, true)},
                   {"record.hal", record(c)},
                   {"run.log.toml", record_names(c)},
                   {"drives.hal", drives(c)},
                   {"demo.ngc", demo(c)},
                   {"identify.ngc", identify(c)},
                   {"play.py", std::string(kPlay)},
                   {"tool.tbl", ";\n"}};
  if (has_contour(c)) files.emplace_back("control-contour.hal", contour_control(c));
  // Written last: with this file the configuration is complete.
  files.emplace_back("headless.ini", ini(c, false));
  files.emplace_back("machine.ini", ini(c, true));
  return files;
}

}  // namespace stribeck::targets::linuxcnc
