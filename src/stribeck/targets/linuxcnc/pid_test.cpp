#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <sstream>
#include <stribeck/targets/steady/test_export.hpp>
#include <vector>

namespace stribeck::test::pid_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

double set_value(const std::string& hal, const std::string& pin) {
  const std::string mark = "setp " + pin + " ";
  const std::size_t at = hal.find(mark);
  EXPECT_NE(at, std::string::npos) << pin;
  return at == std::string::npos ? 0.0 : std::stod(hal.substr(at + mark.size()));
}

/// What pid and lincurve give at a constant velocity [m/s], as their manual pages have it, in the unit of pid.output.
double pid_force(const std::string& hal, double v) {
  const double mm = 1e3 * v;
  std::vector<std::array<double, 2>> points;
  for (int i = 0; i < 16; ++i) {
    const std::string n = (i < 10 ? "0" : "") + std::to_string(i);
    if (hal.find("setp ff.x.x-val-" + n) == std::string::npos) break;
    points.push_back({set_value(hal, "ff.x.x-val-" + n), set_value(hal, "ff.x.y-val-" + n)});
  }
  double table = mm <= points.front()[0] ? points.front()[1] : points.back()[1];
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto& a = points[i - 1];
    const auto& b = points[i];
    if (mm >= a[0] && mm <= b[0]) table = a[1] + (b[1] - a[1]) * (mm - a[0]) / (b[0] - a[0]);
  }
  return set_value(hal, "pid.x.FF1") * mm + table;
}

TEST(Pid, TheHalLinesGiveTheFrictionWithinTheErrorThatIsPrinted) {
  SteadyExport x;
  const std::string hal = x.text("pid");
  const double error = error_of(x.to("pid"));
  const double off = largest_off([&](double v) { return pid_force(hal, v); });
  EXPECT_LE(off, error + 1e-6);
  EXPECT_GT(off, 0.9 * error);  // at a thousand speeds; the printed one holds between them
  EXPECT_LT(error, 0.3);        // of 100 N, with 16 points
  EXPECT_EQ(set_value(hal, "pid.x.FF0"), 0.0);
  EXPECT_EQ(set_value(hal, "pid.x.FF2"), 0.8);  // 800 kg: N per mm/s²
  EXPECT_EQ(set_value(hal, "pid.x.bias"), 30.0);
  // The viscous part of a line through the upper speeds; the rest is in the table.
  EXPECT_NEAR(set_value(hal, "pid.x.FF1"), 0.5, 0.15);
  EXPECT_THAT(hal, HasSubstr("loadrt lincurve names=ff.x personality=16\n"));
  EXPECT_THAT(x.to("pid").text, HasSubstr("not in it: 7.00 N periodic in position."));
}

TEST(Pid, CoulombAndViscousFrictionAreFoundAgain) {
  SteadyExport x(
      "mass = \"800 kg\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"60 N\"\nalpha2 = \"0.5 N s/mm\"\n");
  const std::string hal = x.text("pid");
  EXPECT_NEAR(set_value(hal, "pid.x.FF1"), 0.5, 1e-6);
  EXPECT_NEAR(set_value(hal, "ff.x.y-val-00"), -60.0, 1e-4);
  EXPECT_THAT(hal, HasSubstr("loadrt lincurve names=ff.x personality=4\n"));
}

TEST(Pid, CountsInTheUnitOfItsOutput) {
  SteadyExport x;
  const std::string newton = x.text("pid");
  x.request.gain = "20 N/V";
  const std::string volt = x.text("pid");
  EXPECT_NEAR(set_value(volt, "pid.x.FF2"), 0.04, 1e-9);
  EXPECT_NEAR(20.0 * pid_force(volt, 0.03), pid_force(newton, 0.03), 1e-6);
  EXPECT_THAT(volt, HasSubstr("# V per mm/s: viscous friction"));
}

TEST(Pid, TheDeadbandIsALittleMoreThanHalfAStepOfTheEncoder) {
  SteadyExport x;
  EXPECT_THAT(x.text("pid"), HasSubstr("# setp pid.x.deadband"));
  x.request.resolution = "2 um";
  EXPECT_EQ(set_value(x.text("pid"), "pid.x.deadband"), 0.0011);
  EXPECT_THAT(x.refusal("csv"), HasSubstr("--resolution: applies only to --to pid and --to all"));
  EXPECT_THAT(x.refusal("linuxcnc"), HasSubstr("--resolution: does not apply to --to linuxcnc"));
  EXPECT_THAT(x.refusal("tnc"), HasSubstr("--resolution: does not apply to --to tnc"));
}

constexpr const char* kVelocityDrive =
    "[drive_loop]\nmode = \"velocity\"\ngain = \"20 N s/mm\"\nintegral_time = \"10 ms\"\n";

/// The force [N] of a drive with a velocity loop whose motor follows the velocity that is meant: a PI element of 20 N s/mm and 10 ms on the
/// rest of its command [mm/s], in small steps.
class VelocityLoop {
 public:
  double force(double ahead, double period) {
    constexpr int kSteps = 100;
    double now = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      integral_ += ahead * period / kSteps;
      now = 20.0 * (ahead + integral_ / 10e-3);
    }
    return now;
  }

 private:
  double integral_ = 0.0;
};

TEST(Pid, ADriveThatTakesAVelocityMakesTheFrictionOfIt) {
  SteadyExport x("control_period = \"0.5 ms\"\n" + std::string(kSteadyAxis) + kVelocityDrive);
  const std::string hal = x.text("pid");
  EXPECT_EQ(set_value(hal, "pid.x.FF1"), 1.0);
  EXPECT_EQ(set_value(hal, "pid.x.FF2"), 0.0);
  EXPECT_EQ(set_value(hal, "sum.x.gain0"), 0.04);  // 800 kg: 0.8 N per mm/s2, at 20 N per mm/s
  EXPECT_EQ(set_value(hal, "sum.x.offset"), 1.5);  // 30 N
  // Forward and back: what lincurve, sum2 and lowpass make of it, as their manual pages have it.
  VelocityLoop drive;
  double lag = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const double v = (k / 500) % 2 == 0 ? 0.03 : -0.05;
    const double sum =
        pid_force(hal, v) - 1e3 * v * set_value(hal, "pid.x.FF1") + set_value(hal, "sum.x.offset");
    lag += (sum - lag) * set_value(hal, "lag.x.gain");
    const double force = drive.force(sum + lag * set_value(hal, "lead.x.gain1"), 0.5e-3);
    EXPECT_NEAR(force, 30.0 + friction_of(v), 3.0) << k;
  }
  EXPECT_THAT(hal, HasSubstr("loadrt sum2 names=sum.x,lead.x,cmd.x\nloadrt lowpass names=lag.x\n"));
  EXPECT_THAT(x.to("pid").text, HasSubstr("put cmd.NAME.out there"));
  x.request.gain = "20 N/V";
  EXPECT_THAT(x.refusal("pid"), HasSubstr("--gain: does not apply to axis x"));
}

TEST(Pid, WithoutAnIntegralPartNothingIsTakenOff) {
  SteadyExport x(std::string(kSteadyAxis) + "[drive_loop]\nmode = \"velocity\"\ngain = \"20 N s/mm\"\n");
  const std::string hal = x.text("pid");
  EXPECT_THAT(hal, HasSubstr("loadrt sum2 names=sum.x,cmd.x\n"));
  EXPECT_THAT(hal, Not(HasSubstr("lowpass names")));
  EXPECT_THAT(hal, HasSubstr("net x-offset sum.x.out => cmd.x.in1\n"));
}

TEST(Pid, ADriveThatTakesAPositionIsRefusedWithAWayOut) {
  SteadyExport x(
      std::string(kSteadyAxis) +
      "[drive_loop]\nmode = \"position\"\ngain = \"20 N s/mm\"\nposition_gain = \"60 1/s\"\nvelocity_feedforward = 1\n");
  EXPECT_THAT(x.refusal("pid"), HasSubstr("drive_loop.mode: is position"));
  EXPECT_THAT(x.refusal("pid"), HasSubstr("choose --to linuxcnc"));
}

TEST(Pid, EveryComponentIsLoadedOnceForAllAxes) {
  SteadyExport x;
  x.request.files.push_back(x.folder.write("y.toml", kSteadyAxis));
  const std::string hal = x.text("pid");
  EXPECT_THAT(hal, HasSubstr("loadrt lincurve names=ff.x,ff.y personality=16,16\n"));
  EXPECT_THAT(hal, HasSubstr("loadrt sum2 names=sum.x,sum.y\n"));
  EXPECT_THAT(hal, HasSubstr("net y-friction-speed joint.1.vel-cmd => ff.y.in\n"));
}

/// Runs HAL lines under LinuxCNC's own halrun, in namespaces of its own; what it prints. Empty where that is not possible.
std::string halrun(const Folder& folder, const std::string& lines) {
  const std::string out = folder / "halrun.txt";
  const std::string in = folder.write("run.hal", lines);
  const std::string run =
      "env RTAPI_UID=65534 RTAPI_FIFO_PATH=/tmp/rtapi-fifo HOME=/tmp timeout 30 unshare -m -i -p -n -f --mount-proc "
      "sh -c 'mount -t tmpfs -o mode=1777 tmpfs /tmp && cat > /tmp/run.hal && chmod 644 /tmp/run.hal && (ip link set lo up; "
      "exec halrun -f /tmp/run.hal)' < '" +
      in + "' > '" + out + "' 2> /dev/null";
  return std::system(run.c_str()) == 0 ? text_of(out) : std::string();
}

// The lines in LinuxCNC itself, where it is installed and namespaces are permitted: pid, lincurve and sum2 at constant velocities.
TEST(Pid, LinuxCncsOwnComponentsGiveTheForce) {
  SteadyExport x;
  std::string hal = x.text("pid");
  const double error = error_of(x.to("pid"));
  // The velocity comes from motion, which is not here.
  const std::string source = "joint.0.vel-cmd =>";
  hal.replace(hal.find(source), source.size(), "pid.x.command-deriv");
  std::string lines =
      "loadrt threads name1=servo-thread period1=1000000\nloadrt pid names=pid.x\naddf pid.x.do-pid-calcs servo-thread\n" +
      hal + "setp pid.x.enable 1\nstart\n";
  const std::vector<double> speeds{-80.0, -3.0, 0.5, 40.0};
  for (const double mm : speeds)
    lines += "sets x-friction-speed " + std::to_string(mm) + "\nloadusr -w sleep 0.2\ngetp sum.x.out\n";
  const std::string said = halrun(x.folder, lines);
  if (said.empty()) GTEST_SKIP() << "no halrun here, or no namespaces";
  std::istringstream values(said);
  for (const double mm : speeds) {
    double force = 0.0;
    ASSERT_TRUE(values >> force) << said;
    EXPECT_NEAR(force, 30.0 + friction_of(1e-3 * mm), error + 1e-3) << mm;  // halcmd prints seven digits
  }
}

TEST(Pid, LinuxCncsOwnComponentsMakeTheCommandOfAVelocityDrive) {
  SteadyExport x("control_period = \"1 ms\"\n" + std::string(kSteadyAxis) + kVelocityDrive);
  std::string hal = x.text("pid");
  for (const auto& [source, stand_in] : {std::pair{"joint.0.vel-cmd =>", "pid.x.command-deriv"},
                                         std::pair{"joint.0.acc-cmd =>", "pid.x.feedback-deriv"}}) {
    const std::string from = source;
    hal.replace(hal.find(from), from.size(), stand_in);
  }
  const std::string lines =
      "loadrt threads name1=servo-thread period1=1000000\nloadrt pid names=pid.x\naddf pid.x.do-pid-calcs servo-thread\n" +
      hal +
      "setp pid.x.enable 1\nstart\nsets x-friction-speed 40\nloadusr -w sleep 0.5\ngetp sum.x.out\ngetp cmd.x.out\n";
  const std::string said = halrun(x.folder, lines);
  if (said.empty()) GTEST_SKIP() << "no halrun here, or no namespaces";
  std::istringstream values(said);
  double ahead = 0.0, command = 0.0;
  ASSERT_TRUE(values >> ahead >> command) << said;
  EXPECT_NEAR(20.0 * ahead, 30.0 + friction_of(0.04), 0.3);
  EXPECT_NEAR(command, 40.0, 1e-3);  // the integral part of the drive holds the rest
}

// LinuxCNC counts the joints of a, b and c in degrees; the numbers of pid are in mm.
TEST(Pid, AnAxisThatIsCountedInDegreesIsRefused) {
  SteadyExport a(std::string("axis = \"a\"\n") + kSteadyAxis);
  EXPECT_THAT(a.refusal("pid"), HasSubstr("axis: is a, which LinuxCNC counts in degrees"));
  SteadyExport u(std::string("axis = \"u\"\n") + kSteadyAxis);
  EXPECT_EQ(u.refusal("pid"), "accepted");
}

}  // namespace
}  // namespace stribeck::test::pid_test
