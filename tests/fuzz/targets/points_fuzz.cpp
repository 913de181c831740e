// Points of a path: a spline that is finite everywhere and no farther from its points than it says, or an InputError with the file.
#include <cmath>
#include <stribeck/workflow/path/path_file.hpp>
#include <tests/fuzz/targets/log_checks.hpp>

namespace stribeck::fuzz {

std::vector<std::string> seeds() {
  std::string circle = "\1x [mm],y [mm]\n";
  for (int i = 0; i <= 40; ++i)
    circle += std::to_string(10.0 * std::cos(i * 0.157079632679)) + "," +
              std::to_string(10.0 * std::sin(i * 0.157079632679)) + "\n";
  return {circle, std::string(1, '\0') + "x [mm],y [mm]\n0,0\n1,0\n1,1\n0,1\n0,0\n",
          std::string(1, '\2') + "y [m];x [in]\n0;0\n0,5;1\n0,5;1\n3;4\n"};
}

std::vector<std::string> words() {
  return {"x [mm]", "y [mm]", "[m]", "[in]", "[deg]", "0,0\n", "1e-9", "1e9", "1e-300", "\n0,0\n0,0\n"};
}

void one(std::string_view input) {
  const double tolerance = 1e-5 * (mode_of(input) % 4);
  try {
    const auto points = workflow::path_points<2>(io::parse_csv(input, "fuzz.csv"), {"x", "y"});
    const auto spline = workflow::make_spline(points, tolerance);
    demand(std::isfinite(spline.deviation) && spline.deviation >= 0.0, "a deviation that is not finite");
    const double length = spline.curve.period();
    demand(std::isfinite(length) && length > 0.0, "a range that is not finite");
    for (const auto& piece : spline.curve.segments()) {
      for (const auto& c : piece.c)
        demand(std::isfinite(c[0]) && std::isfinite(c[1]), "a coefficient that is not finite");
    }
  } catch (const io::InputError& e) {
    check(e, "fuzz.csv");
  }
}

}  // namespace stribeck::fuzz
