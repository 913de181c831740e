#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/laps.hpp>
#include <stribeck/ident/circle/minimum_zone.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::circle {
namespace {

constexpr double kTurn = 2.0 * kPi;
constexpr double kWholeTurn = 0.985 * kTurn;  // more than circle_test() asks for
constexpr double kTurnedBack = 10.0 * kPi / 180.0;
constexpr double kSamePlace = 0.25;  ///< of the usual angle from row to row of a table
constexpr double kSectorOfRun = 5.0 * kPi / 180.0;
/// Positions farther off than this share of the radius belong to the approach to the circle.
constexpr double kOffCircle = 0.2;

Centre middle_of_box(std::span<const double> x, std::span<const double> y) {
  const auto [left, right] = std::minmax_element(x.begin(), x.end());
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  return {0.5 * (*left + *right), 0.5 * (*low + *high)};
}

/// `passes` times the least-squares circle of the points near the one about c; absent where there is none.
std::optional<Centre> refined(std::span<const double> x, std::span<const double> y, double radius, Centre c,
                              int passes) {
  for (int k = 0; k < passes; ++k) {
    std::vector<double> near_x;
    std::vector<double> near_y;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (std::abs(std::hypot(x[i] - c.x, y[i] - c.y) - radius) > kOffCircle * radius) continue;
      near_x.push_back(x[i]);
      near_y.push_back(y[i]);
    }
    if (near_x.size() < CircleTest::kFewest) return std::nullopt;
    try {
      const LeastSquaresCircle fitted = least_squares_circle(near_x, near_y);
      c = {fitted.x, fitted.y};
    } catch (const std::invalid_argument&) {
      return std::nullopt;
    }
  }
  return c;
}

/// Of whole circles.
std::optional<Centre> centre_of(std::span<const double> x, std::span<const double> y, double radius) {
  constexpr int kPasses = 3;
  if (x.empty()) return std::nullopt;
  return refined(x, y, radius, middle_of_box(x, y), kPasses);
}

/// Of arcs: the middle of the box round one is far from its centre.
std::optional<Centre> centre_of_arcs(std::span<const double> x, std::span<const double> y, double radius) {
  constexpr int kPasses = 30;
  if (x.size() < CircleTest::kFewest) return std::nullopt;
  try {
    const LeastSquaresCircle all = least_squares_circle(x, y);
    if (auto c = refined(x, y, radius, {all.x, all.y}, kPasses)) return c;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  return refined(x, y, radius, middle_of_box(x, y), kPasses);
}

/// Rows [first, last) in which the angle grows, or falls.
struct Stretch {
  std::size_t first;
  std::size_t last;
};

/// Splits rows on the circle where the angle turns back; `turned` goes on from lap to lap. A row that goes on by less than `step`
/// belongs to the way back.
std::vector<Stretch> one_direction(const std::vector<double>& turned, std::size_t first, std::size_t last,
                                   double step) {
  std::vector<Stretch> out;
  std::size_t begin = first;
  std::size_t lowest = first;
  std::size_t highest = first;
  int direction = 0;
  for (std::size_t i = first; i < last; ++i) {
    if (turned[i] > turned[highest] + step) highest = i;
    if (turned[i] < turned[lowest] - step) lowest = i;
    const bool fell = turned[highest] - turned[i] > kTurnedBack;
    const bool rose = turned[i] - turned[lowest] > kTurnedBack;
    if (direction == 0) {
      if (fell || rose) direction = rose ? 1 : -1;
      continue;
    }
    if (direction > 0 ? !fell : !rose) {
      // In its own direction a run only needs the extreme ahead.
      (direction > 0 ? lowest : highest) = i;
      continue;
    }
    const std::size_t turn = direction > 0 ? highest : lowest;
    out.push_back({begin, turn + 1});
    begin = turn + 1;
    direction = -direction;
    lowest = highest = i;
  }
  if (direction != 0) out.push_back({begin, last});
  return out;
}

/// First row at which each further sector of the stretch has been passed; the last entry is its end.
std::vector<std::size_t> sector_rows(const std::vector<double>& turned, const Stretch& s) {
  std::vector<std::size_t> rows{s.first};
  double passed = kSectorOfRun;
  for (std::size_t i = s.first; i < s.last; ++i) {
    const double angle = std::abs(turned[i] - turned[s.first]);
    if (angle < passed) continue;
    rows.push_back(i);
    passed = (std::floor(angle / kSectorOfRun) + 1.0) * kSectorOfRun;
  }
  return rows;
}

/// The stretch without run-in and run-out.
Stretch at_speed(const std::vector<double>& turned, std::span<const double> time, const Stretch& s) {
  const std::vector<std::size_t> rows = sector_rows(turned, s);
  if (rows.size() < 8) return s;
  const auto when = [&](std::size_t row) { return time.empty() ? static_cast<double>(row) : time[row]; };
  std::vector<double> took;
  for (std::size_t k = 1; k < rows.size(); ++k) took.push_back(when(rows[k]) - when(rows[k - 1]));
  const double usual = stats::median(took);
  // A border of a sector lies between two rows.
  const double per_sector =
      static_cast<double>(rows.back() - rows.front()) / static_cast<double>(took.size());
  const double most = usual * (1.02 + 1.0 / std::max(per_sector, 1.0));
  std::size_t begin = 0;
  while (begin < took.size() && took[begin] > most) ++begin;
  std::size_t end = took.size();
  while (end > begin && took[end - 1] > most) --end;
  if (begin >= end) return s;
  // What is slow after the last whole sector is run-out too.
  const double left = std::abs(turned[s.last - 1] - turned[rows.back()]);
  const bool slow_end = when(s.last - 1) - when(rows.back()) > most * std::max(left / kSectorOfRun, 0.1) &&
                        when(s.last - 1) - when(rows.back()) > 3.0 * usual / std::max(per_sector, 1.0);
  Stretch out = s;
  if (begin > 0) out.first = rows[std::min(begin + 1, rows.size() - 1)];
  if (end < took.size()) {
    out.last = rows[end > 0 ? end - 1 : 0] + 1;
  } else if (slow_end) {
    out.last = rows.back() + 1;
  }
  return out.first < out.last ? out : s;
}

/// Ten usual steps: longer ones are gaps.
double longest_step(std::span<const double> time) {
  if (time.size() < 2) return HUGE_VAL;
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  return 10.0 * stats::median(std::move(steps));
}

/// Rows on the circle, each with the angle that goes on from lap to lap.
struct OnCircle {
  std::vector<double> turned;
  std::vector<Stretch> rows;
  double usual = 0.0;  ///< angle from row to row of a table without times [rad]
};

/// Of a table, whose rows are about equally far apart.
double usual_angle(std::span<const double> x, std::span<const double> y, const Centre& c) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < x.size(); ++i)
    steps.push_back(std::abs(std::remainder(
        std::atan2(y[i] - c.y, x[i] - c.x) - std::atan2(y[i - 1] - c.y, x[i - 1] - c.x), kTurn)));
  return steps.empty() ? 0.0 : stats::median(std::move(steps));
}

OnCircle on_circle(std::span<const double> x, std::span<const double> y, std::span<const double> time,
                   std::span<const int> part, const Centre& c, double radius) {
  constexpr double kJump = 10.0;  // usual steps
  constexpr double kLeastJump = 5.0 * kPi / 180.0;
  // Where there are times, rows may be missing within a run; farther than this is another place, as where records were joined.
  constexpr double kLeastJumpInTime = 30.0 * kPi / 180.0;
  const double longest = longest_step(time);
  const double usual = usual_angle(x, y, c);
  OnCircle out;
  if (time.empty()) out.usual = usual;
  const double widest = std::max(kJump * usual, time.empty() ? kLeastJump : kLeastJumpInTime);
  bool inside = false;
  double before = 0.0;
  double turned = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - c.x;
    const double dy = y[i] - c.y;
    const double angle = std::atan2(dy, dx);
    const double step = std::remainder(angle - before, kTurn);
    turned = inside ? turned + step : angle;
    before = angle;
    out.turned.push_back(turned);
    const bool now = std::abs(std::hypot(dx, dy) - radius) <= kOffCircle * radius;
    const bool late = i > 0 && !time.empty() && !(time[i] > time[i - 1] && time[i] - time[i - 1] <= longest);
    const bool jump = i > 0 && std::abs(step) > widest;
    const bool other = i > 0 && !part.empty() && part[i] != part[i - 1];
    const bool gap = late || jump || other;
    if (now && (!inside || gap)) out.rows.push_back({i, i});
    inside = now;
    if (now) out.rows.back().last = i + 1;
  }
  return out;
}

double turn_of(const std::vector<double>& turned, const Stretch& s) {
  return std::abs(turned[s.last - 1] - turned[s.first]);
}

CircleRun run_of(const std::vector<double>& turned, std::span<const double> time, const Stretch& s,
                 double radius) {
  CircleRun run;
  run.first = s.first;
  run.last = s.last;
  run.counter_clockwise = turned[s.last - 1] > turned[s.first];
  run.revolutions = turn_of(turned, s) / kTurn;
  run.feed = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = s.first; i < s.last; ++i) {
    run.lap.push_back(static_cast<int>(std::max(0.0, std::abs(turned[i] - turned[s.first]) / kTurn)));
    if (!time.empty()) run.time.push_back(time[i]);
  }
  if (!time.empty()) {
    const double lasted = run.time.back() - run.time.front();
    if (lasted > 0.0) run.feed = run.revolutions * kTurn * radius / lasted;
  }
  return run;
}

/// The stretch without the rows at both ends whose guide is off the circle: an approach along a line or an arc, at full speed too.
Stretch without_approach(const std::vector<double>& radii, bool commanded, double radius, const Stretch& s) {
  constexpr double kScatter = 6.0;
  // A command has its own rounding alone; positions have the errors of the machine.
  const double least = (commanded ? 1e-5 : 1e-3) * radius;
  std::vector<double> r(radii.begin() + static_cast<std::ptrdiff_t>(s.first),
                        radii.begin() + static_cast<std::ptrdiff_t>(s.last));
  const double usual = stats::median(r);
  for (double& one : r) one = std::abs(one - usual);
  const double most = std::max(kScatter * stats::median(r), least);
  const auto off = [&](std::size_t i) { return std::abs(radii[i] - usual) > most; };
  Stretch out = s;
  while (out.first + 1 < out.last && off(out.first)) ++out.first;
  while (out.last > out.first + 1 && off(out.last - 1)) --out.last;
  return out;
}

/// The stretch without what stands at both its ends while the angle stays: a stop, an approach along the radius.
Stretch without_rest(const std::vector<double>& turned, const Stretch& s) {
  constexpr double kSameAngle = 0.2 * kPi / 180.0;
  Stretch out = s;
  for (std::size_t i = s.first; i < s.last; ++i) {
    if (std::abs(turned[i] - turned[s.first]) <= kSameAngle) out.first = i;
    if (std::abs(turned[i] - turned[s.last - 1]) <= kSameAngle) {
      out.last = i + 1;
      break;
    }
  }
  return out.first < out.last ? out : s;
}

/// The stretch without up to 15 degrees at both ends that it has beyond whole laps: there the drives still settle behind the approach.
Stretch settled(const std::vector<double>& turned, const Stretch& s) {
  constexpr double kSettles = 15.0 * kPi / 180.0;
  const double turn = turn_of(turned, s);
  const double off = std::min(kSettles, 0.5 * (turn - whole_laps(turn)));
  Stretch out = s;
  // A row farther would take away more than that where rows are far apart.
  while (out.first + 1 < out.last && std::abs(turned[out.first + 1] - turned[s.first]) <= off) ++out.first;
  while (out.last > out.first + 1 && std::abs(turned[out.last - 2] - turned[s.last - 1]) <= off) --out.last;
  return out;
}

/// Whole revolutions farther off than an approach is.
void note_other_circles(const CircleSamples& s, const std::vector<double>& turned,
                        const std::vector<double>& radii, double radius, std::vector<std::string>& notes) {
  const auto off = [&](std::size_t i) { return std::abs(radii[i] - radius) > kOffCircle * radius; };
  for (std::size_t first = 0; first < radii.size();) {
    std::size_t last = first;
    while (last < radii.size() && off(last) == off(first)) ++last;
    double turn = 0.0;
    for (std::size_t i = first + 1; i < last; ++i) turn += std::remainder(turned[i] - turned[i - 1], kTurn);
    if (off(first) && std::abs(turn) >= kWholeTurn) {
      const std::vector<double> all(radii.begin() + static_cast<std::ptrdiff_t>(first),
                                    radii.begin() + static_cast<std::ptrdiff_t>(last));
      notes.push_back(fmt::format(
          "rows {} to {}: a circle of {:.4g} mm is left out, the radius is {:.4g} mm (--size chooses it)",
          s.row_of(first), s.row_of(last - 1), 1e3 * stats::median(all), 1e3 * radius));
    }
    first = last;
  }
}

/// The revolutions of a record about a centre.
struct Found {
  std::vector<double> turned;
  std::vector<Stretch> scored;
  std::vector<std::string> notes;
  double longest = 0.0;  ///< arc in one direction [rad]
};

/// `least`: a whole turn, or the least arc.
Found revolutions(const CircleSamples& s, std::span<const double> time, bool commanded, const Centre& c,
                  double radius, double least) {
  const std::span<const double> x = commanded ? s.command_x : s.x, y = commanded ? s.command_y : s.y;
  OnCircle on = on_circle(x, y, time, s.part, c, radius);
  std::vector<double> radii;
  for (std::size_t i = 0; i < x.size(); ++i) radii.push_back(std::hypot(x[i] - c.x, y[i] - c.y));
  Found out;
  note_other_circles(s, on.turned, radii, radius, out.notes);
  for (const Stretch& rows : on.rows) {
    for (const Stretch& way : one_direction(on.turned, rows.first, rows.last, kSamePlace * on.usual)) {
      const Stretch whole = without_rest(on.turned, way);
      Stretch one = without_approach(radii, commanded, radius, whole);
      const std::string shorter =
          least < kWholeTurn ? fmt::format("{:.0f} deg", least * 180.0 / kPi) : std::string("one revolution");
      if (turn_of(on.turned, one) < least && turn_of(on.turned, whole) >= least) {
        out.notes.push_back(fmt::format(
            "rows {} to {}: both ends are off the circle and scored too: without them less than {} is left",
            s.row_of(whole.first), s.row_of(whole.last - 1), shorter));
        one = whole;
      }
      const double turn = turn_of(on.turned, one);
      out.longest = std::max(out.longest, turn);
      if (turn < least) {
        if (turn > 2.0 * kTurnedBack)
          out.notes.push_back(
              fmt::format("rows {} to {}: an arc of {:.0f} deg is left out, it is shorter than {}",
                          s.row_of(one.first), s.row_of(one.last - 1), turn * 180.0 / kPi, shorter));
        continue;
      }
      Stretch scored = at_speed(on.turned, time, one);
      if (turn_of(on.turned, scored) < least) {
        out.notes.push_back(
            fmt::format("rows {} to {}: run-in and run-out are scored too: without them less than {} is left",
                        s.row_of(one.first), s.row_of(one.last - 1), shorter));
        scored = one;
      }
      out.scored.push_back(time.empty() ? scored : settled(on.turned, scored));
    }
  }
  out.turned = std::move(on.turned);
  return out;
}

/// Least-squares circle of whole laps of the rows that are scored.
LeastSquaresCircle circle_of_scored(std::span<const double> x, std::span<const double> y,
                                    const std::vector<double>& turned, const std::vector<Stretch>& scored) {
  std::vector<double> some_x, some_y;
  for (const Stretch& s : scored) {
    const double whole = whole_laps(turn_of(turned, s));
    for (std::size_t i = s.first; i < s.last && std::abs(turned[i] - turned[s.first]) <= whole; ++i) {
      some_x.push_back(x[i]);
      some_y.push_back(y[i]);
    }
  }
  return least_squares_circle(some_x, some_y);
}

/// An intended radius that is not that of the command is mostly a slip, and would be taken for an error of the scales.
void note_other_radius(double commanded, double radius, std::vector<std::string>& notes) {
  const double most = std::max(1e-5 * radius, 2e-6);
  if (!(std::abs(commanded - radius) > most)) return;
  notes.push_back(fmt::format(
      "the commanded circle has a radius of {0:.7g} mm, and {1:.7g} mm were given: the radius that is found holds the difference "
      "of {2:.4g} um (give --size \"{0:.7g} mm\")",
      1e3 * commanded, 1e3 * radius, 1e6 * (commanded - radius)));
}

/// Rows that stand out of their neighbours by more than all others together: a fault of the record.
void note_outliers(const CircleSamples& s, const CircleRun& run, std::vector<std::string>& notes) {
  constexpr double kOfSpan = 0.3;
  constexpr double kScatter = 30.0;
  constexpr std::size_t kMost = 3;
  constexpr double kOfReversal = 3.0 * kPi / 180.0;  // a spike may be as narrow as a row of a coarse table
  const std::size_t n = run.error.size();
  if (n < CircleTest::kFewest) return;
  std::vector<double> apart(n, 0.0);
  for (std::size_t i = 2; i + 2 < n; ++i) {
    const double before = 0.5 * (run.error[i - 2] + run.error[i - 1]);
    const double behind = 0.5 * (run.error[i + 1] + run.error[i + 2]);
    if (std::abs(std::remainder(run.angle[i], 0.5 * kPi)) < kOfReversal) continue;
    apart[i] = std::min(std::abs(run.error[i] - before), std::abs(run.error[i] - behind));
  }
  const auto [low, high] = std::minmax_element(run.error.begin(), run.error.end());
  const double most = std::max(kOfSpan * (*high - *low), kScatter * stats::median(apart));
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < n && out.size() <= kMost; ++i) {
    if (apart[i] > most) out.push_back(i);
  }
  if (out.empty() || out.size() > kMost) return;
  for (const std::size_t i : out)
    notes.push_back(fmt::format(
        "row {} stands out of its neighbours by {:.3g} um, and the largest error or G may be those of this row (if the "
        "record is at fault there, take the row out)",
        s.row_of(run.first + i), apart[i] * 1e6));
}

}  // namespace

double whole_laps(double arc) {
  constexpr double kAlmost = 0.02;  // of a lap
  const double whole = kTurn * std::floor(arc / kTurn + kAlmost);
  return whole > 0.0 ? whole : arc;
}

CircleMotion circle_motion(const CircleSamples& s, std::span<const double> time, double radius) {
  CircleMotion out;
  out.radius = radius;
  out.commanded = !s.command_x.empty();
  const std::span<const double> guide_x = out.commanded ? s.command_x : s.x;
  const std::span<const double> guide_y = out.commanded ? s.command_y : s.y;
  auto centre = centre_of(guide_x, guide_y, radius);
  double least = kWholeTurn;
  Found found;
  if (centre) found = revolutions(s, time, out.commanded, *centre, radius, least);
  if (found.scored.empty()) {
    const auto of_arcs = centre_of_arcs(guide_x, guide_y, radius);
    Found arcs = of_arcs ? revolutions(s, time, out.commanded, *of_arcs, radius, kLeastArc) : Found{};
    if (!arcs.scored.empty() || !centre) {
      out.arcs = !arcs.scored.empty();
      least = kLeastArc;
      centre = of_arcs;
      found = std::move(arcs);
    }
  }
  if (!centre) return out;
  // The approach moves the centre, which tells what belongs to the approach.
  constexpr int kMostPasses = 12;
  double guide_radius = radius;
  for (int k = 0; k < kMostPasses && !found.scored.empty(); ++k) {
    const Centre before = *centre;
    const LeastSquaresCircle guide = circle_of_scored(guide_x, guide_y, found.turned, found.scored);
    centre = {guide.x, guide.y};
    guide_radius = guide.radius;
    if (std::hypot(centre->x - before.x, centre->y - before.y) <= 1e-9 * radius) break;
    found = revolutions(s, time, out.commanded, *centre, radius, least);
  }
  if (!out.commanded && !found.scored.empty()) {
    const LeastSquaresCircle own = circle_of_scored(s.x, s.y, found.turned, found.scored);
    centre = {own.x, own.y};
  }
  out.notes = std::move(found.notes);
  if (out.commanded) note_other_radius(guide_radius, radius, out.notes);
  out.longest_arc = found.longest;
  out.centre_x = centre->x;
  out.centre_y = centre->y;
  for (const Stretch& scored : found.scored) {
    CircleRun run = run_of(found.turned, time, scored, radius);
    for (std::size_t i = run.first; i < run.last; ++i) {
      const double x = s.x[i] - out.centre_x;
      const double y = s.y[i] - out.centre_y;
      const double angle = std::atan2(y, x);
      run.angle.push_back(
          i == run.first ? angle : run.angle.back() + std::remainder(angle - run.angle.back(), kTurn));
      run.error.push_back(std::hypot(x, y) - radius);
    }
    note_outliers(s, run, out.notes);
    out.runs.push_back(std::move(run));
  }
  return out;
}

}  // namespace stribeck::ident::circle
