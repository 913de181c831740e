#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stribeck/core/numbers.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/methods/position_map_parts.hpp>
#include <stribeck/ident/refused.hpp>

namespace stribeck::ident::methods::position_map {
namespace {

constexpr int kTermsHeld = 10;

/// Columns of a record at standstill; its time need not be uniform.
void check_held(const log::Record& r) {
  if (r.x.size() != r.f.size() || r.t.size() != r.x.size()) {
    throw Refused(r.source + fmt::format(": columns t, x and f have {}, {} and {} rows, expected one length",
                                         r.t.size(), r.x.size(), r.f.size()));
  }
  for (std::size_t k = 0; k < r.x.size(); ++k) {
    if (!std::isfinite(r.x[k]) || !std::isfinite(r.f[k])) {
      throw Refused(
          r.source +
          fmt::format(": row {}: position or force is not a finite number; repair or cut the log", k));
    }
  }
}

/// Rows without direction; each counts separately.
map::PeriodicRows rows_of(const std::vector<log::Record>& records, double& mean) {
  map::PeriodicRows rows;
  rows.shown = Shown(records.front());
  mean = 0.0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const log::Record& record = records[i];
    check_held(record);
    for (std::size_t k = 0; k < record.x.size(); ++k) {
      rows.x.push_back(record.x[k]);
      rows.e.push_back(record.f[k]);
      rows.direction.push_back(0);
      rows.record.push_back(static_cast<int>(i));
      rows.at.push_back(k);
      mean += record.f[k];
    }
  }
  mean /= std::max(1.0, static_cast<double>(rows.x.size()));
  return rows;
}

void write_terms(const map::PeriodicResult& found, bool whole_turn, Result& r) {
  int number = 0;
  for (const map::PeriodicTerm& t : found.terms) {
    ++number;
    const std::string name = whole_turn ? "harmonic_" + std::to_string(t.harmonic) + "_"
                                        : "eccentric_" + std::to_string(number) + "_";
    const auto half = [](const Interval& i) { return 0.5 * (i.high - i.low); };
    r.parameters.push_back(parameter(name + "amplitude", t.term.amplitude, "N", "N", half(t.amplitude)));
    r.parameters.push_back(parameter(name + "period", t.term.period, "m", "mm", half(t.period)));
    r.parameters.push_back(parameter(name + "phase", t.term.phase, "rad", "rad", half(t.phase)));
    r.parameters.back().identifiable = half(t.phase) < kPi;
    r.friction.eccentric.push_back(t.term);
  }
  if (found.terms.size() > friction::kMaxEccentricTerms) {
    r.warnings.push_back(fmt::format("{} periodic terms found; an axis file holds the largest {}",
                                     found.terms.size(), friction::kMaxEccentricTerms));
  }
  if (!found.terms.empty()) r.warnings.emplace_back(kHoming);
}

/// Residual of mean and terms.
void write_points(const std::vector<log::Record>& records, const map::PeriodicResult& found, double mean,
                  Result& r) {
  const std::size_t step = std::max<std::size_t>(1, r.rows / kPlotted);
  std::size_t at = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const log::Record& record = records[i];
    for (std::size_t k = 0; k < record.x.size(); ++k, ++at) {
      if (at % step != 0) continue;
      double e = record.f[k] - mean;
      for (const map::PeriodicTerm& t : found.terms)
        e -= t.term.amplitude * std::sin(2.0 * kPi * record.x[k] / t.term.period - t.term.phase);
      r.residuals.push_back({record.t[k], record.x[k], 0.0, e, static_cast<int>(i)});
    }
  }
}

}  // namespace

Result identify_held(const std::vector<log::Record>& records, const PositionMapOptions& options) {
  Result r;
  r.method = Method::kPositionMap;
  r.set_steady(SteadyModel::kCogging);
  r.force_unit = records.front().force_unit;
  r.position_unit = records.front().position_unit;
  r.mass = kNaN;
  double mean = 0.0;
  const map::PeriodicRows rows = rows_of(records, mean);
  r.rows = rows.x.size();
  map::PeriodicOptions search;
  search.most = options.most_terms.value_or(kTermsHeld);
  search.turn = options.turn.value_or(r.position_unit == "rad" ? 2.0 * kPi : 0.0);
  const map::PeriodicResult found = map::find_periodic(rows, search);
  r.spectrum = found.spectrum;
  r.warnings = found.notes;
  r.cannot_tell = found.cannot_tell;
  if (found.terms.empty()) {
    r.cannot_tell.emplace_back("periodic terms: none is above the noise");
  }
  write_terms(found, search.turn > 0.0, r);
  r.cannot_tell.emplace_back("mass, Coulomb and viscous friction: the axis is held at standstill");
  r.cannot_tell.push_back(
      fmt::format("load: the mean force of {:.4g} may also be static friction that holds the axis; move in "
                  "both directions",
                  mean));
  write_points(records, found, mean, r);
  return r;
}

}  // namespace stribeck::ident::methods::position_map

namespace stribeck::ident::methods {

namespace {

/// Rests and motion of records: rests between two counts of the encoder in one direction are slow motion.
class Rests {
 public:
  explicit Rests(const std::vector<log::Record>& records) {
    double high = -kInfinity, count = kInfinity;
    for (const log::Record& r : records) {
      for (std::size_t k = 0; k < r.x.size(); ++k) {
        low_ = std::min(low_, r.x[k]);
        high = std::max(high, r.x[k]);
        const double d = k > 0 ? std::abs(r.x[k] - r.x[k - 1]) : 0.0;
        if (d > 0.0) count = std::min(count, d);
      }
    }
    travel_ = high - low_;
    if (!(travel_ > 0.0)) return;
    count_ = std::max(count, 1e-6 * travel_);
    for (const log::Record& r : records) add(r);
  }

  [[nodiscard]] bool hold_the_axis() const {
    constexpr double kAtRest = 0.4;
    constexpr double kLongSteps = 0.3;
    const auto places = std::count(place_.begin(), place_.end(), true);
    return travel_ > 0.0 && rest_ > kAtRest * (rest_ + moving_) && far_ > kLongSteps * moving_ &&
           4 * places >= 3 * kPlaces;
  }

 private:
  static constexpr int kPlaces = 64;

  [[nodiscard]] bool is_count(double step) const { return std::abs(step) <= 1.5 * count_; }

  /// Rows that stand, and the steps before and behind them.
  struct Rest {
    double x = 0.0, rows = 0.0, before = 0.0, behind = 0.0;
  };

  void add(const log::Record& r) {
    std::vector<Rest> rests;
    std::size_t begin = 0;  // of the rows that stand
    double before = 0.0;
    for (std::size_t k = 1; k < r.x.size(); ++k) {
      const double d = r.x[k] - r.x[k - 1];
      if (d == 0.0) continue;
      rests.push_back({r.x[k - 1], static_cast<double>(k - 1 - begin), before, d});
      // A step alone between rests is a count, also where the counts are not all of one size (three digits of a number).
      const bool alone = (k < 2 || r.x[k - 1] == r.x[k - 2]) && (k + 1 >= r.x.size() || r.x[k + 1] == r.x[k]);
      moving_ += 1.0;
      if (!is_count(d) && !alone) far_ += 1.0;
      begin = k;
      before = d;
    }
    if (!r.x.empty()) rests.push_back({r.x.back(), static_cast<double>(r.x.size() - 1 - begin), before, 0.0});
    for (std::size_t i = 0; i < rests.size(); ++i) {
      // Counts come evenly in slow motion; a ramp that ends in a rest has single counts too.
      constexpr double kEvenly = 4.0;
      const double beside =
          std::max(i > 0 ? rests[i - 1].rows : 0.0, i + 1 < rests.size() ? rests[i + 1].rows : 0.0);
      const Rest& rest = rests[i];
      if (is_count(rest.before) && is_count(rest.behind) && rest.before * rest.behind > 0.0 &&
          rest.rows <= kEvenly * (1.0 + beside)) {
        moving_ += rest.rows;
      } else if (rest.rows > 0.0) {
        rest_ += rest.rows;
        const int at = static_cast<int>((rest.x - low_) / travel_ * kPlaces);
        place_[static_cast<std::size_t>(std::clamp(at, 0, kPlaces - 1))] = true;
      }
    }
  }

  double low_ = kInfinity, travel_ = 0.0, count_ = 0.0;
  double rest_ = 0.0, moving_ = 0.0, far_ = 0.0;  // rows
  std::vector<bool> place_ = std::vector<bool>(kPlaces, false);
};

}  // namespace

// Rests over the whole travel, and steps between them that are longer than a count of the encoder. (A slow jog on a coarse encoder rests
// too, but moves by single counts; stops between motions occur at few places.)
bool held_at_standstill(const std::vector<log::Record>& records) { return Rests(records).hold_the_axis(); }

}  // namespace stribeck::ident::methods
