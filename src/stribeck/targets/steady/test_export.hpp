#pragma once
/// An export of one axis to a target that holds the steady friction, for the tests of these targets.

#include <algorithm>
#include <cmath>
#include <functional>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/targets/target.hpp>
#include <string>

namespace stribeck::test {

inline constexpr const char* kSteadyAxis =
    "mass = \"800 kg\"\nload = \"30 N\"\n[friction.steady]\nkind = \"conventional\"\nalpha0 = \"60 N\"\nalpha2 = \"0.5 N s/mm\"\n"
    "stribeck = { alpha1 = \"100 N\", v0 = \"5 mm/s\", delta = 1 }\n"
    "[[friction.eccentric]]\namplitude = \"7 N\"\nperiod = \"5 mm\"\nphase = \"0.4 rad\"\nform = \"proportional\"\n";

/// To be written behind kSteadyAxis.
inline constexpr const char* kItsSpring =
    "[friction.spring]\nstiffness = \"1.5 N/mm\"\nzero_at = \"4 mm\"\nfrom = \"-12 mm\"\nto = \"15 mm\"\n";
/// Truth of kItsSpring at a position [m], in N.
inline double spring_of(double x) { return x < -12e-3 ? -24.0 : x > 15e-3 ? 16.5 : 1500.0 * x - 6.0; }

/// Truth of kSteadyAxis, written down once more: level by Stribeck's law and viscous part [N]. Without load and periodic term.
inline double friction_of(double v) {
  const double s = std::abs(v);
  const double f = 60.0 + 40.0 * std::exp(-s / 5e-3) + 500.0 * s;
  return v < 0.0 ? -f : f;
}

struct SteadyExport {
  Folder folder;
  targets::ExportRequest request;

  explicit SteadyExport(const std::string& axis = kSteadyAxis) {
    request.files = {folder.write("x.toml", axis)};
    request.output = folder / "out.txt";
    request.speed = "100 mm/s";
    request.command = "test";
  }
  targets::Exported to(const char* name) { return targets::find_target(name)->write(request); }
  std::string text(const char* name) {
    static_cast<void>(to(name));
    return text_of(request.output);
  }
  std::string refusal(const char* name) {
    try {
      static_cast<void>(to(name));
    } catch (const io::InputError& e) {
      return e.problems().front().text();
    }
    return "accepted";
  }
};

inline double error_of(const targets::Exported& e) { return e.json["axes"][0]["max_error_N"].get<double>(); }

/// Largest difference between a friction of either direction and that of kSteadyAxis over the speeds of the export, from the slowest one [m/s].
inline double largest_off(const std::function<double(double)>& at, double slowest = 1e-4) {
  double largest = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const double v = slowest + (0.1 - slowest) * i / 1000.0;
    largest = std::max({largest, std::abs(at(v) - friction_of(v)), std::abs(at(-v) - friction_of(-v))});
  }
  return largest;
}

}  // namespace stribeck::test
