#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include <stribeck/ident/digits.hpp>
#include <stribeck/workflow/judge/untested.hpp>

namespace stribeck::workflow {
namespace {

constexpr double kSpan = 0.01;        // of a second difference, to either side [s]
constexpr double kMostUnseen = 30.0;  // error of the mass that a log has to show [%]
constexpr double kOneWay = 0.02;      // of the way, backwards

double rms_of_acceleration(const ident::log::Record& r) {
  const auto n = static_cast<std::size_t>(std::max(2.0, std::round(kSpan / r.sample_time)));
  if (r.x.size() < 4 * n) return NAN;
  const double h = static_cast<double>(n) * r.sample_time;
  double sum = 0.0;
  for (std::size_t k = n; k + n < r.x.size(); ++k)
    sum += std::pow((r.x[k + n] - 2.0 * r.x[k] + r.x[k - n]) / (h * h), 2);
  return std::sqrt(sum / static_cast<double>(r.x.size() - 2 * n));
}

std::string of_mass(const std::string& file, const friction::AxisModel& model, const ident::log::Record& r,
                    double good) {
  double squares = 0.0;
  for (const double f : r.f) squares += (f - model.load) * (f - model.load);
  const double force = std::sqrt(squares / static_cast<double>(r.f.size()));
  const double inertial = model.mass * rms_of_acceleration(r);
  if (!std::isfinite(inertial) || !(force > 0.0)) return {};
  const double unseen = inertial > 0.0 ? good * force / inertial : INFINITY;
  if (!(unseen > kMostUnseen)) return {};
  return fmt::format(
      "{}: {} hardly tests the mass: {} of it would change the force by no more than {:g} %, because the force of acceleration is only {} % "
      "of all (constant-acceleration or a faster sine tests the mass)",
      file, r.source,
      unseen < 100.0 ? fmt::format("an error of {} %", ident::digits(unseen, 2)) : "an error of 100 %", good,
      ident::digits(100.0 * inertial / force, 2));
}

std::string of_direction(const std::string& file, const ident::log::Record& r) {
  const auto n = static_cast<std::size_t>(std::max(1.0, std::round(kSpan / r.sample_time)));
  double forward = 0.0, backward = 0.0;
  for (std::size_t k = n; k < r.x.size(); k += n) {
    const double way = r.x[k] - r.x[k - n];
    (way > 0.0 ? forward : backward) += std::abs(way);
  }
  const bool up = forward > backward;
  if (std::min(forward, backward) > kOneWay * (forward + backward) || forward + backward == 0.0) return {};
  return fmt::format(
      "{}: {} moves towards {} alone: friction towards {} is not tested (verify with a motion there and back)",
      file, r.source, up ? '+' : '-', up ? '-' : '+');
}

}  // namespace

std::vector<std::string> untested_in_words(const std::string& file, const friction::AxisModel& model,
                                           const ident::log::Record& record, double good) {
  std::vector<std::string> all;
  if (record.x.size() < 2 || record.x.size() != record.f.size()) return all;
  for (std::string text : {of_mass(file, model, record, good), of_direction(file, record)})
    if (!text.empty()) all.push_back(std::move(text));
  return all;
}

}  // namespace stribeck::workflow
