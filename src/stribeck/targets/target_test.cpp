#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/targets/target.hpp>
#include <string>

namespace stribeck::test::target_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kAxis =
    "mass = \"800 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"15 N\"\nalpha2 = \"3 N s/mm\"\n";

TEST(Target, EveryOneSaysWhatItTakesWritesAndLoses) {
  std::set<std::string_view> names;
  for (const targets::Target& t : targets::all_targets()) {
    EXPECT_TRUE(names.insert(t.name).second) << t.name;
    EXPECT_FALSE(t.takes.empty() || t.writes.empty() || t.error.empty()) << t.name;
    EXPECT_TRUE(t.write) << t.name;
    EXPECT_EQ(targets::find_target(t.name), &t);
  }
  EXPECT_EQ(targets::find_target("none"), nullptr);
}

// The axis that the file names, not the one whose turn it is.
TEST(Target, AxesOfAControlGoByTheirNames) {
  using Numbers = std::vector<std::size_t>;
  EXPECT_EQ(targets::axis_numbers({"y"}), (Numbers{1}));
  EXPECT_EQ(targets::axis_numbers({"y", "X"}), (Numbers{1, 0}));
  EXPECT_EQ(targets::axis_numbers({"z", "c"}), (Numbers{2, 5}));
  for (const auto& names : {std::vector<std::string>{"X1", "x"}, {"y", "y"}, {"", "y"}})
    EXPECT_EQ(targets::axis_numbers(names), (Numbers{0, 1}));
  const Folder folder;
  targets::ExportRequest request;
  request.files = {folder.write("1.toml", std::string("axis = \"y\"\n") + kAxis),
                   folder.write("2.toml", std::string("axis = \"x\"\n") + kAxis)};
  request.output = folder / "pid.hal";
  request.speed = "100 mm/s";
  static_cast<void>(targets::find_target("pid")->write(request));
  EXPECT_THAT(text_of(request.output), HasSubstr("joint.1.vel-cmd => ff.y.in"));
  EXPECT_THAT(text_of(request.output), HasSubstr("joint.0.vel-cmd => ff.x.in"));
  request.files = {folder.write(
      "3.toml", std::string("axis = \"y\"\n") + kAxis +
                    "[friction.dynamics]\nkind = \"lugre\"\nsigma0 = \"8000 N/mm\"\nsigma1 = \"80 N s/mm\"\n"
                    "damping_velocity = \"0.05 mm/s\"\n")};
  request.speed = "10 mm/s";
  request.controller = "cascade";
  request.period = "5 ms";
  for (const auto& [target, place] :
       {std::pair{"sinumerik", "[AX2]="}, {"tnc", "MP711.1"}, {"fanuc", "Y stage 1"}}) {
    static_cast<void>(targets::find_target(target)->write(request));
    EXPECT_THAT(text_of(request.output), HasSubstr(place)) << target;
  }
}

TEST(Target, LinuxCncWritesControllersOfAxisFiles) {
  const Folder folder;
  targets::ExportRequest request;
  request.files = {folder.write("x.toml", kAxis)};
  request.output = folder / "axes.hal";
  request.command = "test";
  const targets::Exported written = targets::find_target("linuxcnc")->write(request);
  const std::string hal = text_of(request.output);
  EXPECT_THAT(hal, HasSubstr("# Written by: test\n"));
  EXPECT_THAT(hal, HasSubstr("setp ax.x.mass 800\n"));
  EXPECT_EQ(written.json["file"], request.output);
  EXPECT_THAT(written.text, HasSubstr("lines of HAL in"));
}

TEST(Target, TheTableTellsItsError) {
  const Folder folder;
  targets::ExportRequest request;
  request.files = {folder.write("x.toml", kAxis)};
  request.output = folder / "table.hal";
  request.lincurve = true;
  request.speed = "100 mm/s";
  const targets::Exported written = targets::find_target("linuxcnc")->write(request);
  // Coulomb and viscous friction are straight lines: what is left is where the search for the table ends, 1e-7 of 300 N.
  EXPECT_LT(written.json["lincurve"][0]["max_error_N"], 3e-4);
  EXPECT_THAT(text_of(request.output), HasSubstr("largest deviation from the steady curve"));
}

TEST(Target, AxesInHalAreCalledAsTheirFilesSay) {
  const Folder folder;
  targets::ExportRequest request;
  request.files = {folder.write("a.toml", std::string("axis = \"z\"\n") + kAxis),
                   folder.write("b.toml", std::string("axis = \"x\"\n") + kAxis)};
  request.output = folder / "axes.hal";
  static_cast<void>(targets::find_target("linuxcnc")->write(request));
  EXPECT_THAT(text_of(request.output), HasSubstr("setp ax.z.mass 800\n"));
  // As axis files of a machine with capital names have them.
  request.files[1] = folder.write("d.toml", std::string("axis = \"C\"\n") + kAxis);
  request.lincurve = true;
  request.speed = "100 mm/s";
  static_cast<void>(targets::find_target("linuxcnc")->write(request));
  EXPECT_THAT(text_of(request.output), HasSubstr("names=ff.z,ff.c "));
  request.lincurve = false;
  request.speed.clear();
  // Two of one name: counted.
  request.files[1] = folder.write("c.toml", std::string("axis = \"z\"\n") + kAxis);
  static_cast<void>(targets::find_target("linuxcnc")->write(request));
  EXPECT_THAT(text_of(request.output), HasSubstr("setp ax.y.mass 800\n"));
}

// 100 mm/s of arc at a radius of 1 m are 5.73 deg/s.
TEST(Target, ATableOfARotaryAxisIsInDegrees) {
  const Folder folder;
  targets::ExportRequest request;
  request.files = {folder.write("c.toml", std::string("axis = \"c\"\nrotary = true\n") + kAxis)};
  request.output = folder / "table.hal";
  request.lincurve = true;
  request.speed = "100 mm/s";
  const targets::Exported written = targets::find_target("linuxcnc")->write(request);
  EXPECT_LT(written.json["lincurve"][0]["max_error_N"], 3e-4);
  EXPECT_NEAR(written.json["lincurve"][0]["points_deg_per_s_N"].back()[0].get<double>(), 5.7296, 1e-3);
  EXPECT_THAT(text_of(request.output), HasSubstr("A rotary axis: its velocities are in deg/s"));
  EXPECT_THAT(targets::axis_notes(request), HasSubstr("N stands for N m"));
}

// The largest contour error of a worn axis must not be lost on the way.
TEST(Target, ABacklashIsNamed) {
  const Folder folder;
  targets::ExportRequest request;
  request.files = {folder.write("z.toml", std::string(kAxis) + "\n[lost_motion]\nbacklash = \"45.4 um\"\n"),
                   folder.write("x.toml", kAxis)};
  const std::string notes = targets::axis_notes(request);
  EXPECT_THAT(notes, HasSubstr("z.toml has a backlash of 45.4 um between motor and table"));
  EXPECT_EQ(notes.find("x.toml"), std::string::npos);
  // 2·30 N over 12 N/um.
  request.files = {folder.write(
      "y.toml",
      std::string(kAxis) +
          "\n[lost_motion]\nbacklash = \"0 um\"\nstiffness = \"12 N/um\"\ntable_friction = \"30 N\"\n"
          "table_mass = \"20 kg\"\n")};
  const std::string wound = targets::axis_notes(request);
  EXPECT_THAT(wound, HasSubstr("y.toml has a wind-up of 5 um between motor and table"));
  EXPECT_EQ(wound.find("has a backlash"), std::string::npos);
}

TEST(Target, TheEndsOfASpringAreNamed) {
  const Folder folder;
  targets::ExportRequest request;
  const std::string spring = "\n[friction.spring]\nstiffness = \"2 N/mm\"\nzero_at = \"10 mm\"\n";
  request.files = {folder.write("x.toml", kAxis + spring + "from = \"-100 mm\"\nto = \"120 mm\"\n"),
                   folder.write("y.toml", kAxis + spring)};
  EXPECT_THAT(targets::axis_notes(request),
              testing::EndsWith(
                  "x.toml has a spring that is known from -100 mm to 120 mm; beyond, its force stays.\n"));
}

TEST(Target, OptionsWithoutEffectAreRefused) {
  const Folder folder;
  targets::ExportRequest request;
  request.files = {folder.write("x.toml", kAxis)};
  request.output = folder / "axes.hal";
  request.speed = "100 mm/s";
  try {
    static_cast<void>(targets::find_target("linuxcnc")->write(request));
    ADD_FAILURE() << "accepted";
  } catch (const io::InputError& e) {
    EXPECT_EQ(e.problems().front().text(), "--speed: does not apply to anything but --lincurve");
  }
}

}  // namespace
}  // namespace stribeck::test::target_test
