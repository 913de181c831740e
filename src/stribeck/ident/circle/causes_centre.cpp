#include <Eigen/Cholesky>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>
#include <vector>

namespace stribeck::ident::circle {
namespace {

/// First harmonic of the error over all runs, beside the constant and the second one: how far the centre is off.
Offset first_harmonic(const std::vector<CircleRun>& runs) {
  Eigen::Matrix<double, 5, 5> A = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> b = Eigen::Matrix<double, 5, 1>::Zero();
  for (const CircleRun& run : runs) {
    for (std::size_t i = 0; i < run.angle.size(); ++i) {
      const double a = run.angle[i];
      Eigen::Matrix<double, 5, 1> v;
      v << 1.0, std::cos(a), std::sin(a), std::cos(2.0 * a), std::sin(2.0 * a);
      A.noalias() += v * v.transpose();
      b += run.error[i] * v;
    }
  }
  const Eigen::Matrix<double, 5, 1> c = A.ldlt().solve(b);
  return {c(1), c(2)};
}

/// Whether the angles of a ball-bar are those at which the machine was commanded, which are evenly spaced whatever the offset is, and not
/// those of the positions about the instrument.
bool commanded_angles(const std::vector<CircleRun>& runs, const Offset& d, double radius) {
  double both = 0.0, squares = 0.0;
  for (const CircleRun& run : runs) {
    const std::size_t n = run.angle.size();
    const double mean = std::abs(run.angle.back() - run.angle.front()) / static_cast<double>(n - 1);
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double a = 0.5 * (run.angle[i] + run.angle[i + 1]);
      const double closer = -(d.x * std::cos(a) + d.y * std::sin(a)) / radius;
      both += closer * (std::abs(run.angle[i + 1] - run.angle[i]) / mean - 1.0);
      squares += closer * closer;
    }
  }
  return both < 0.5 * squares;
}

/// The run about a centre that is off by d.
CircleRun seen_from(const CircleRun& run, const Offset& d, double radius, bool commanded) {
  CircleRun out = run;
  for (std::size_t i = 0; i < run.angle.size(); ++i) {
    const double co = std::cos(run.angle[i]), si = std::sin(run.angle[i]);
    const double r = radius + run.error[i];
    if (commanded) {
      // The machine is at this angle about its own centre, and at this distance from the instrument.
      const double across = d.x * si - d.y * co;
      out.error[i] = std::sqrt(r * r - across * across) - (d.x * co + d.y * si) - radius;
      continue;
    }
    const double x = r * co - d.x, y = r * si - d.y;
    out.angle[i] += std::remainder(std::atan2(y, x) - run.angle[i], 2.0 * kPi);
    out.error[i] = std::hypot(x, y) - radius;
  }
  return out;
}

}  // namespace

Offset take_off_centre(CircleMotion& motion) {
  constexpr int kPasses = 4;
  constexpr double kNear = 1e-9;  // of the radius
  if (motion.runs.empty()) return {};
  const std::vector<CircleRun> given = motion.runs;
  Offset d;
  bool commanded = false;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Offset more = first_harmonic(motion.runs);
    if (std::hypot(more.x, more.y) < kNear * motion.radius) break;
    d = {d.x + more.x, d.y + more.y};
    if (pass == 0) commanded = motion.ball_bar && commanded_angles(given, d, motion.radius);
    for (std::size_t i = 0; i < given.size(); ++i)
      motion.runs[i] = seen_from(given[i], d, motion.radius, commanded);
  }
  return d;
}

}  // namespace stribeck::ident::circle
