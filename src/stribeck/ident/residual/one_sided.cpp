#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stribeck/ident/log/motion.hpp>
#include <stribeck/ident/residual/residual_parts.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::ident::residual {
namespace {

using Eigen::Index;

constexpr std::size_t kHats = 13;         // over the travel
constexpr std::size_t kStrips = 60;       // over the travel, to find where the force begins and ends
constexpr double kOfBoth = 0.85;          // of the square that a force in both directions leaves
constexpr double kOfNone = 0.6;           // of the square without a force of the place
constexpr double kWorthAForce = 0.15;     // of friction
constexpr double kBegins = 0.15;          // of the force: where it is taken to act
constexpr double kPassed = 0.8;           // of the strips must have been passed in the other direction
constexpr double kMostOfTravel = 0.9;     // some of the travel must be free of it
constexpr std::size_t kFewestLeft = 200;  // rows of the direction that are free of it

enum class Acts { kNot, kInOneDirection, kAgainstBoth, kTheSameInBoth, kSmoothly };

double hat(const Rows& rows, const Row& r, std::size_t i) {
  const double at = std::clamp(0.5 * (rows.along(r) + 1.0), 0.0, 1.0) * static_cast<double>(kHats - 1);
  return std::max(0.0, 1.0 - std::abs(at - static_cast<double>(i)));
}

/// The whole force on the columns of the model, friction that drifts over the rows, and a force of the place, 0 at the lowest place.
Fit with_places(const Rows& rows, Acts acts, double direction) {
  Columns columns = model_columns(rows);
  // By strokes, which are counted over all records.
  const double strokes = std::max(1, rows.rows.back().stretch);
  const auto time = [strokes](const Row& r) { return 2.0 * r.stretch / strokes - 1.0; };
  columns.emplace_back([time](const Row& r) { return r.sign * time(r); });
  columns.emplace_back([time](const Row& r) { return r.sign * time(r) * time(r); });
  if (acts == Acts::kSmoothly) {
    // A spring beside friction that grows along the travel is nothing in one direction.
    for (const bool against : {false, true}) {
      for (const int power : {1, 2, 3}) {
        columns.emplace_back([&rows, against, power](const Row& r) {
          return (against ? r.sign : 1.0) * std::pow(rows.along(r), power);
        });
      }
    }
  }
  if (acts == Acts::kNot || acts == Acts::kSmoothly) return fit(rows, columns, &Row::f);
  for (std::size_t i = 1; i < kHats; ++i) {
    columns.emplace_back([&rows, acts, direction, i](const Row& r) {
      if (acts == Acts::kInOneDirection && r.sign != direction) return 0.0;
      return (acts == Acts::kAgainstBoth ? r.sign : 1.0) * hat(rows, r, i);
    });
  }
  return fit(rows, columns, &Row::f);
}

/// Force against the motion in each strip, its rows in this direction, and whether the other one passed there.
struct Strips {
  std::array<double, kStrips> sum{}, rows{}, other{};

  Strips(const Rows& all, const Fit& f, double direction) {
    const auto places = static_cast<Index>(kHats - 1);
    for (std::size_t i = 0; i < all.rows.size(); ++i) {
      const Row& r = all.rows[i];
      const auto s = static_cast<std::size_t>(std::clamp(0.5 * (all.along(r) + 1.0), 0.0, 1.0 - 1e-9) *
                                              static_cast<double>(kStrips));
      if (r.sign != direction) {
        other[s] += 1.0;
        continue;
      }
      const auto row = static_cast<Index>(i);
      sum[s] += direction * (f.left(row) + f.X.row(row).tail(places).dot(f.theta.tail(places)));
      rows[s] += 1.0;
    }
  }
  [[nodiscard]] bool seen(std::size_t s) const { return rows[s] > 0.0; }
  [[nodiscard]] double mean(std::size_t s) const { return sum[s] / rows[s]; }
};

/// Whether the force acts in at least three strokes and in half of those that pass its place: one that acts once is another thing.
bool comes_again(const Rows& rows, const Fit& f, const OneSided& force, double free) {
  constexpr double kOfForce = 0.4;
  constexpr double kFewestStrokes = 3.0;
  const auto places = static_cast<Index>(kHats - 1);
  double strokes = 0.0, with = 0.0, sum = 0.0, count = 0.0;
  const auto end_stroke = [&] {
    if (count > 2.0) strokes += 1.0, with += sum / count > kOfForce * force.force ? 1.0 : 0.0;
    sum = count = 0.0;
  };
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const Row& r = rows.rows[i];
    if (i > 0 && r.stretch != rows.rows[i - 1].stretch) end_stroke();
    if (r.sign != force.direction || !force.holds(r.x)) continue;
    const auto row = static_cast<Index>(i);
    sum += force.direction * (f.left(row) + f.X.row(row).tail(places).dot(f.theta.tail(places))) - free;
    count += 1.0;
  }
  end_stroke();
  return with >= kFewestStrokes && 2.0 * with >= strokes;
}

std::optional<OneSided> in_direction(const Rows& rows, const Fit& f, double direction) {
  const Strips strips(rows, f, direction);
  std::vector<double> means;
  for (std::size_t s = 0; s < kStrips; ++s) {
    if (strips.seen(s)) means.push_back(strips.mean(s));
  }
  if (means.size() < kStrips / 2) return std::nullopt;
  std::sort(means.begin(), means.end());
  // What a few strips have more or less than the others decides nothing.
  const double free = means[means.size() / 20], most = means[means.size() - 1 - means.size() / 20];
  if (most - free < kWorthAForce * rows.friction) return std::nullopt;
  std::size_t first = kStrips, last = 0;
  double sum = 0.0, count = 0.0, acting = 0.0, passed = 0.0;
  for (std::size_t s = 0; s < kStrips; ++s) {
    if (!strips.seen(s) || strips.mean(s) - free < kBegins * (most - free)) continue;
    first = std::min(first, s), last = s;
    sum += strips.sum[s] - free * strips.rows[s], count += strips.rows[s];
    acting += 1.0, passed += strips.other[s] > 0.0 ? 1.0 : 0.0;
  }
  if (first == kStrips || passed < kPassed * acting) return std::nullopt;
  // The low-pass smears the ends.
  first = first > 0 ? first - 1 : 0, last = std::min(last + 1, kStrips - 1);
  if (static_cast<double>(last + 1 - first) > kMostOfTravel * kStrips) return std::nullopt;
  const auto place = [&](std::size_t s) {
    return rows.low + (rows.high - rows.low) * static_cast<double>(s) / static_cast<double>(kStrips);
  };
  OneSided out{direction, sum / count, place(first), place(last + 1), first == 0, last + 1 == kStrips};
  if (!comes_again(rows, f, out, free)) return std::nullopt;
  const auto left = std::count_if(rows.rows.begin(), rows.rows.end(),
                                  [&](const Row& r) { return r.sign == direction && !out.holds(r.x); });
  out.enough_left = static_cast<std::size_t>(left) >= kFewestLeft;
  return out;
}

}  // namespace

void find_one_sided(const Rows& rows, Diagnosis& out) {
  const double none = with_places(rows, Acts::kNot, 0.0).square;
  const std::pair<Fit, double> up{with_places(rows, Acts::kInOneDirection, 1.0), 1.0};
  const std::pair<Fit, double> down{with_places(rows, Acts::kInOneDirection, -1.0), -1.0};
  const auto& [better, direction] = up.first.square < down.first.square ? up : down;
  if (better.square > kOfNone * none) return;
  for (const Acts other : {Acts::kAgainstBoth, Acts::kTheSameInBoth, Acts::kSmoothly}) {
    if (better.square > kOfBoth * with_places(rows, other, 0.0).square) return;
  }
  out.one_sided = in_direction(rows, better, direction);
}

void leave_out(const OneSided& force, log::Record& record) {
  const log::Motion m = log::reconstruct(record, {});
  record.skip.resize(record.x.size(), 0);
  for (std::size_t k = 0; k < record.skip.size(); ++k) {
    if (force.holds(record.x[k]) && (!m.valid(k) || m.v[k] * force.direction >= 0.0)) record.skip[k] = 1;
  }
}

std::string in_words(const OneSided& force, const Shown& shown) {
  return fmt::format(
      "motion in {} direction needs {} more between {} and {}, and motion in the other direction does not: a process force (cutting, "
      "pressing), or something that drags in one direction",
      force.direction > 0.0 ? "positive" : "negative", shown.force(force.force), shown.length(force.from),
      shown.length(force.to));
}

}  // namespace stribeck::ident::residual
