// A log of a circle: finite figures and causes, or an InputError in one line.
#include <cmath>
#include <stribeck/workflow/circle_logs.hpp>
#include <tests/fuzz/targets/log_checks.hpp>

namespace stribeck::fuzz {
namespace {

/// Both directions of a ball-bar: `head` names the columns of angle and radius, `more` is what stands behind them in each direction.
std::string table(const std::string& head, double radius, double per_mm, const std::string& more_ccw = "",
                  const std::string& more_cw = "") {
  std::string text = head + "\n";
  for (int i = 0; i <= 400; ++i) {
    const double turn = 0.0314159265358979 * (i <= 200 ? i : 400 - i);
    text += std::to_string(turn * 57.29577951308232) + "," +
            std::to_string(radius + per_mm * (0.003 * std::cos(2 * turn) + (i <= 200 ? 0.002 : 0.0))) +
            (i <= 200 ? more_ccw : more_cw) + "\n";
  }
  return text;
}

}  // namespace

std::vector<std::string> seeds() {
  std::string positions(1, '\0');
  positions += "t [s],x [mm],y [mm]\n";
  for (int i = 0; i <= 200; ++i)
    positions += std::to_string(0.01 * i) + "," + std::to_string(10.0 * std::cos(0.0314159265 * i)) + "," +
                 std::to_string(10.0 * std::sin(0.0314159265 * i)) + "\n";
  return {positions, '\1' + table("angle [deg],radius [mm]", 100.0, 1.0),
          '\2' + table("# radius: 100 mm\n# feed: 1000 mm/min\nWinkel (deg),Abweichung [um],Richtung", 0.0,
                       1e3, ",ccw", ",cw"),
          '\1' + table("angle [deg],deviation ccw [um],deviation cw [um]", 0.0, 1e3, ",1.5", ",2.5")};
}

std::vector<std::string> words() {
  return {"angle [deg]", "[rad]",  "radius [mm]", "deviation [um]",      "direction",
          "ccw",         "cw",     "G3",          "nominal radius [mm]", "# radius: ",
          "# feed: ",    "100 mm", "0 mm",        "\n0,100\n",           "1e9",
          "-1",          "x [mm]"};
}

void one(std::string_view input) {
  workflow::CircleOptions o;
  const int mode = mode_of(input) % 3;
  if (mode == 1) o.size = "100 mm";
  o.logs = {"fuzz.csv"};
  try {
    const auto judged =
        workflow::judge_circles(o, {io::parse_log(input, "fuzz.csv", {.times_needed = false})});
    demand(judged.logs.size() == 1, "another number of logs");
    for (const auto& c : judged.logs[0].circles) {
      demand(std::isfinite(c.max_error) && std::isfinite(c.rms), "a radial error that is not finite");
      demand(std::isfinite(c.circular_deviation), "a circular deviation that is not finite");
    }
    if (!judged.logs[0].diagnosis) return;
    for (const auto& cause : judged.logs[0].diagnosis->causes)
      demand(!cause.found || std::isfinite(cause.size), "a cause whose size is not finite");
  } catch (const io::InputError& e) {
    check(e);
  }
}

}  // namespace stribeck::fuzz
