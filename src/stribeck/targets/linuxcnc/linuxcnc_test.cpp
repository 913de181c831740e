#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/targets/target.hpp>
#include <string>
#include <vector>

namespace stribeck::test::linuxcnc_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kMachines = std::string(STRIBECK_SOURCE_DIR) + "/machines/";
const std::string kSteady =
    "mass = \"1000 kg\"\n[friction]\nsteady = { kind = \"conventional\", alpha0 = \"20 N\", alpha2 = \"4 N s/mm\" }\n";

struct HalExport {
  Folder folder;
  targets::ExportRequest request;

  /// The folder is that of a configuration; a name with .hal is one file.
  explicit HalExport(std::vector<std::string> files, const std::string& output = "out.hal") {
    request.files = std::move(files);
    request.output = folder / output;
    request.command = "test";
  }
  std::string text() {
    static_cast<void>(targets::find_target("linuxcnc")->write(request));
    return text_of(request.output);
  }
  std::string refusal() {
    try {
      static_cast<void>(targets::find_target("linuxcnc")->write(request));
    } catch (const io::InputError& e) {
      return e.problems().front().text();
    }
    return "accepted";
  }
};

TEST(LinuxCnc, TheFileOfAnotherAxisIsRefused) {
  HalExport x({kMachines + "biaxial-table.toml"}, "folder");
  x.request.parameters = "commissioning";
  const auto with = [&](const std::string& head) {
    const std::string file = x.folder.write("given.toml", (head + kSteady).c_str());
    x.request.axis_files = {"x=" + file};
    const std::string refusal = x.refusal();
    return refusal.starts_with(file) ? refusal.substr(file.size()) : refusal;
  };
  EXPECT_THAT(with("axis = \"y\"\n"),
              HasSubstr("axis: the file is of axis \"y\", expected one of axis x of "));
  EXPECT_THAT(with("rotary = true\n"), HasSubstr("rotary: the file is of a rotary axis, but axis x of "));
  EXPECT_EQ(with("axis = \"X\"\n"), "accepted");
  EXPECT_EQ(with(""), "accepted");
}

// The weight of a vertical axis is known before anything is identified; without it the axis sagged by 1.6 mm.
TEST(LinuxCnc, RoughValuesHoldTheLoad) {
  HalExport x({std::string(STRIBECK_SOURCE_DIR) + "/examples/own-machine/gantry-virtual.toml"}, "folder");
  x.request.parameters = "commissioning";
  static_cast<void>(targets::find_target("linuxcnc")->write(x.request));
  EXPECT_THAT(text_of(x.request.output + "/control-axis.hal"), HasSubstr("setp ax.z.load 176\n"));
  EXPECT_THAT(text_of(x.request.output + "/control-contour.hal"), HasSubstr("setp ct.2.load 176\n"));
}

// Virtual drives count in periods: whoever takes the files to a machine finds the line.
TEST(LinuxCnc, AConfigurationNamesTheLineForLateCycles) {
  HalExport x({kMachines + "biaxial-table.toml"}, "folder");
  x.request.parameters = "commissioning";
  static_cast<void>(targets::find_target("linuxcnc")->write(x.request));
  for (const char* line : {"# setp ax.x.watch-lateness 1\n", "# setp ax.y.watch-lateness 1\n"})
    EXPECT_THAT(text_of(x.request.output + "/control-axis.hal"), HasSubstr(line));
  EXPECT_THAT(text_of(x.request.output + "/control-contour.hal"), HasSubstr("# setp ct.watch-lateness 1\n"));
}

// LinuxCNC counts a, b and c in degrees, whatever a file says of them.
TEST(LinuxCnc, ALetterOfARotaryAxisHasItsUnit) {
  HalExport mill({kMachines + "five-axis-mill.toml"});
  const std::string drives = mill.text();
  for (const char* line : {"setp pl.a.position-unit 0.0017453", "setp pl.c.position-unit 0.0017453"})
    EXPECT_THAT(drives, HasSubstr(line));
  EXPECT_THAT(drives, Not(HasSubstr("pl.x.position-unit")));

  HalExport axis({});
  const auto of = [&](const std::string& head) {
    axis.request.files = {axis.folder.write("a.toml", (head + kSteady).c_str())};
    return axis.text();
  };
  EXPECT_THAT(of("axis = \"A\"\n"), HasSubstr("setp ax.a.position-unit 0.0017453"));
  EXPECT_THAT(of("axis = \"a\"\nrotary = true\n"), HasSubstr("setp ax.a.position-unit 0.017453"));
  EXPECT_THAT(of("axis = \"x\"\n"), Not(HasSubstr("position-unit")));

  // 1.7453 m/s are 1000 deg/s on an arc of 100 mm.
  axis.request.lincurve = true;
  axis.request.speed = "1745.3293 mm/s";
  const std::string table = of("axis = \"a\"\n");
  EXPECT_THAT(table, HasSubstr("from -1000 to 1000 deg/s"));
  EXPECT_THAT(table, HasSubstr("x-val-00 -1000"));
}

}  // namespace
}  // namespace stribeck::test::linuxcnc_test
