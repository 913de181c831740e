#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stribeck/ident/drive/describe.hpp>
#include <stribeck/ident/drive/shift.hpp>
#include <stribeck/ident/drive/steady_rows.hpp>
#include <stribeck/ident/drive/summary.hpp>
#include <stribeck/ident/drive/text.hpp>
#include <string>

namespace stribeck::ident::drive {
namespace {

constexpr std::size_t kShownResiduals = 4000;
constexpr double kMostHalf = 1e12;    ///< in SI: a wider interval is none
constexpr double kVagueShift = 0.3;   ///< [rows] half width of a shift that is worth a word
constexpr double kApart = 0.05;       ///< of friction: difference of the directions that is worth a word
constexpr double kClearRise = 0.06;   // of the Coulomb force: a smaller one may be the foot of a steeper rise
constexpr double kWorthRise = 0.005;  // of the Coulomb force: less is rounding, and has no Stribeck speed
constexpr double kMostOfStribeckSpeed =
    0.5;  ///< share of the Stribeck speed: rows this slow show four fifths of the rise
constexpr double kUsualStribeckSpeed = 2e-3;  ///< [m/s] guides and screws have 1 to 10 mm/s
constexpr double kFastStribeckSpeed = 0.05;   ///< [m/s]
constexpr double kNoStribeckSpeed = 0.3;  ///< [m/s] faster than any Stribeck effect: a curved viscous part
constexpr double kSlowOfTop = 0.01;       ///< of the top speed: for angles in place of kUsualStribeckSpeed
constexpr double kWorthSlow = 0.02;       ///< of the top speed: a curve that begins below it needs no word
constexpr double kMostUnseen =
    0.1;  ///< share of a parameter in directions without data that leaves it identifiable

class Description {
 public:
  Description(const Found& found, const DriveFitOptions& options, Notes& notes)
      : found_(found),
        options_(options),
        notes_(notes),
        terms_(found.intervals.linear),
        drift_(found.may_drift
                   ? LevelDrift(found.log, found.rows, found.choice.map.fit, found.intervals.residual)
                   : LevelDrift()) {}

  Result write() {
    write_head();
    for (int s = 0; s < map::kSides; ++s) write_summary(s);
    for (int s = 0; s < map::kSides; ++s) write_speeds(s);
    if (const auto rise = one_sided_rise(map(), found_.rows.grid, Shown(found_.log.records.front())))
      notes_.warn(*rise);
    write_shift();
    write_map();
    add_periodic(result_, found_, notes_);
    for (int s = map::kSides - 1; s >= 0; --s) write_curve(s);
    write_points();
    return std::move(result_);
  }

 private:
  [[nodiscard]] const map::StaticFit& map() const { return found_.choice.map.fit; }
  /// Whether speeds are those of a linear axis: of an angle nothing is usual.
  [[nodiscard]] bool metres() const {
    return result_.position_unit == "m" && !found_.log.records.front().turns();
  }
  /// The texts "N" and "m" stand for the units of the log.
  [[nodiscard]] std::string in_units(std::string unit) const {
    if (result_.force_unit != "N" && unit.starts_with("N")) unit = result_.force_unit + unit.substr(1);
    return unit;
  }
  void add(std::string name, double value, const std::string& unit, const std::string& shown, double error,
           bool seen) {
    const double known = found_.intervals.factor * error;
    const double half = known < kMostHalf ? known : std::numeric_limits<double>::infinity();
    Parameter p;
    p.name = std::move(name);
    p.value = value;
    p.unit = in_units(unit);
    p.shown = in_units(shown);
    p.ci_low = value - half;
    p.ci_high = value + half;
    p.identifiable = seen && std::isfinite(error) && half < std::abs(value);
    result_.parameters.push_back(std::move(p));
  }
  /// Standard error of a parameter of the map.
  [[nodiscard]] double map_error(std::size_t i) const { return found_.intervals.error_at(terms_ + i); }
  [[nodiscard]] bool seen(std::size_t i) const { return found_.intervals.unseen[i] < kMostUnseen; }
  [[nodiscard]] Index at(std::size_t map_parameter) const {
    return static_cast<Index>(terms_ + map_parameter);
  }

  void write_head();
  void write_summary(int s);
  bool slow_enough(int s, const std::optional<double>& stribeck_speed);
  [[nodiscard]] std::optional<double> stribeck_speed_of(const Summary& summary, int s) const;
  void write_speeds(int s);
  /// Standard error of a figure of one direction.
  [[nodiscard]] double error_of(const Figure& figure, int s) const;
  void write_shift();
  void write_map();
  void write_symmetric();
  void write_load();
  void note_load();
  std::size_t write_branch(std::size_t s, friction::GaussianBranch<double>& branch);
  void write_curve(int s);
  void keep_told(std::vector<CurvePoint>& points);
  [[nodiscard]] double model_spread(int s, double speed) const {
    return spread_of_friction(found_.choice, s, speed);
  }
  /// Standard error of the load where friction is what the load leaves.
  [[nodiscard]] double load_error() const { return found_.load ? found_.load->error : 0.0; }
  /// Standard error of a level of friction.
  [[nodiscard]] double level_error(const Figure& figure, int s) const {
    return std::hypot(error_of(figure, s), load_error());
  }
  /// Standard error of the friction at a speed.
  [[nodiscard]] double curve_error(const Figure& figure, int s, double speed) const {
    const double noise =
        std::hypot(level_error(figure, s), model_spread(s, speed), found_.intervals.misfit.at(s, speed));
    // Drift is not noise: its full size is added to the half width.
    const double unsure = found_.taken_out != nullptr ? found_.taken_out->unsure(s, speed) : 0.0;
    return noise + std::abs(figure.value) * std::hypot(drift_.at(s, speed), unsure) / found_.intervals.factor;
  }
  void write_points();

  const Found& found_;
  const DriveFitOptions& options_;
  Notes& notes_;
  std::size_t terms_;
  LevelDrift drift_;
  std::array<bool, map::kSides> at_rest_seen_{};  ///< by the rows of each direction
  bool said_slowest_ = false;
  Result result_;
};

void Description::write_head() {
  const LinearFit& fit = found_.fit;
  const bool known = found_.terms.known_mass.has_value();
  result_.method = Method::kAuto;
  result_.force_unit = found_.log.records.front().force_unit;
  result_.position_unit = found_.log.records.front().position_unit;
  result_.mass = fit.mass;
  result_.plain_mass = known ? std::numeric_limits<double>::quiet_NaN() : fit.plain_mass;
  const double error = known ? 0.0 : found_.intervals.error_at(0);
  const double half = found_.intervals.factor * error;
  result_.mass_interval = {fit.mass - half, fit.mass + half};
  result_.velocity_range = {-found_.rows.grid[1].high, found_.rows.grid[0].high};
  result_.rows = found_.rows.size();
  result_.peaks = {map::peaks_of(fit.curve[0]), map::peaks_of(fit.curve[1])};
  result_.load = map().load;
  result_.held_out_rms = found_.choice.map.held_out_rms;
  result_.models = found_.choice.map.candidates;
  const bool newton = result_.force_unit == "N";
  add("mass", fit.mass, newton ? "kg" : "N s2/m", newton ? "N s2/mm" : "N s2/m", error, true);
  if (!result_.parameters.back().identifiable) {
    notes_.warn("the mass cannot be determined from this log; run a sine or pulses, or give the mass");
  }
}

double Description::error_of(const Figure& figure, int s) const {
  VectorXd h = found_.intervals.zero();
  h.segment(at(map().span(s).first), figure.slope.size()) = figure.slope;
  return found_.intervals.error_of(h);
}

/// The speed of a clear rise towards standstill that is that of mixed lubrication, and not a wide bend of the map that may stand beside one:
/// at speeds far above those of guides and screws it must be a good part of friction.
std::optional<double> Description::stribeck_speed_of(const Summary& summary, int s) const {
  constexpr double kGoodPart = 0.1;
  const double rise = summary.rise.value, coulomb = std::abs(summary.coulomb.value);
  if (!summary.stribeck_speed || !(rise > kClearRise * coulomb) ||
      !(rise > found_.intervals.factor * error_of(summary.rise, s)))
    return {};
  const double speed = summary.stribeck_speed->value;
  const bool usual =
      !metres() || speed <= kFastStribeckSpeed || (rise > kGoodPart * coulomb && speed < kNoStribeckSpeed);
  return usual ? std::optional<double>(speed) : std::nullopt;
}

void Description::write_summary(int s) {
  const auto side = static_cast<std::size_t>(s);
  const Summary summary = summary_of(map(), s, found_.rows.grid[side]);
  const std::string tail = std::string("_") + map::kSideName[side];
  const double d = map::kDirection[side];
  const LineSpread rivals = spread_of_line(found_.choice, s, found_.rows.grid[side]);
  add("coulomb" + tail, d * summary.coulomb.value, "N", "N",
      std::hypot(level_error(summary.coulomb, s), rivals.coulomb), summary.line_seen);
  const bool rises = summary.rise.value > found_.intervals.factor * error_of(summary.rise, s) &&
                     summary.rise.value > kWorthRise * std::abs(summary.coulomb.value);
  std::optional<double> speed = stribeck_speed_of(summary, s);
  // A rise that was seen in the other direction alone lies below the slowest rows of this one.
  if (!speed && found_.rows.grid[1 - side].high > 0.0)
    speed = stribeck_speed_of(summary_of(map(), 1 - s, found_.rows.grid[1 - side]), 1 - s);
  const bool seen_at_rest = slow_enough(s, speed);
  at_rest_seen_[side] = seen_at_rest;
  add("static" + tail, d * summary.at_rest.value, "N", "N", curve_error(summary.at_rest, s, 0.0),
      seen_at_rest);
  if (rises && summary.stribeck_speed) {
    add("stribeck_speed" + tail, summary.stribeck_speed->value, "m/s", "mm/s",
        error_of(*summary.stribeck_speed, s), seen_at_rest);
  }
  add("viscous" + tail, summary.viscous.value, "N s/m", "N s/mm",
      std::hypot(error_of(summary.viscous, s), rivals.viscous), summary.line_seen);
}

/// Whether the slowest rows show the friction at rest: where a Stribeck part was found, most of its rise; where none was, speeds at
/// which there usually is one. The first direction that does not is noted.
bool Description::slow_enough(int s, const std::optional<double>& stribeck_speed) {
  const map::Grid& grid = found_.rows.grid[static_cast<std::size_t>(s)];
  const double slow = stribeck_speed ? kMostOfStribeckSpeed * *stribeck_speed
                      : metres()     ? kUsualStribeckSpeed
                                     : kSlowOfTop * grid.high;
  if (grid.low <= slow) return true;
  if (said_slowest_) return false;
  said_slowest_ = true;
  const Shown shown(found_.log.records.front());
  notes_.cannot_tell.push_back(
      text("static friction: nothing slower than %s was used, and the friction may rise below it: ",
           shown.speed(grid.low).c_str()) +
      (asked_slower(found_.log.records, map::kDirection[static_cast<std::size_t>(s)],
                    kMostOfStribeckSpeed * grid.low)
           ? std::string(
                 "slower motion was asked for, but the axis sticks and slips there, or turns before friction has "
                 "settled; jog over a longer distance, with a stiffer loop")
           : text("add jogs at %.2g %s/s and slower", 0.2 * grid.low * shown.scale(),
                  shown.length_unit().c_str())));
  return false;
}

void Description::write_speeds(int s) {
  const auto side = static_cast<std::size_t>(s);
  const double d = map::kDirection[side];
  const bool turns = found_.log.records.front().rotary;
  for (const double speed : shown_speeds(found_.rows.grid[side])) {
    const Figure f = friction_at(map(), s, speed);
    add(text("friction_at_%+.3g_%s",
             d * speed *
                 (turns      ? 180.0 / kPi
                  : metres() ? 1e3
                             : 1.0),
             turns      ? "deg_per_s"
             : metres() ? "mm_per_s"
                        : "rad_per_s"),
        d * f.value, "N", "N", curve_error(f, s, speed), true);
  }
}

void Description::write_shift() {
  const log::Record& record = found_.log.records.front();
  const double T = record.sample_time;
  const double hold = log::hold_of(options_.control_period, T);
  const auto tell_delay = [&](double shift, double open) {
    if (!record.measured) result_.delay = delay_of(shift, open, T, hold);
  };
  const double half = found_.intervals.factor * found_.intervals.shift_error;
  const auto say = [&](const char* what) {
    notes_.cannot_tell.push_back(text(
        "the shift between force and motion: %s any from %.2g ms earlier to %.2g ms later is possible; the "
        "intervals of mass, friction and pre-sliding allow for it; %s, or give --force-shift",
        what, 1e3 * half * T, 1e3 * half * T,
        record.r.empty() ? "record the commanded position too"
                         : "a log of excite --method multisine tells it"));
  };
  describe_filter(record, result_, notes_);
  if (options_.shift) {
    result_.given_shift = *options_.shift * T;
    tell_delay(*options_.shift, 0.0);
  }
  const auto removed = [&](double shift, const char* why) {
    notes_.warn(
        text("in the log the force is %.3g rows (%.3g ms) %s than its motion%s; this shift is removed",
             std::abs(shift), std::abs(shift) * T * 1e3, shift > 0 ? "later" : "earlier", why));
  };
  const bool told = half < std::max(kVagueShift, 0.5 * std::abs(found_.log.shift + 0.5));
  if (!found_.terms.shift && !options_.shift && found_.log.shift != kHeldForce) {
    if (told) tell_delay(found_.log.shift, half);
    add("force_shift", found_.log.shift * T, "s", "ms", found_.intervals.shift_error * T, true);
    result_.parameters.back().identifiable = told;
    if (!told) say("the one that the reversals show is removed, but");
    removed(found_.log.shift, ", as friction shows where the motion reverses");
    return;
  }
  if (!found_.terms.shift) {
    if (half > kVagueShift)
      say("the force is taken as commanded, but");
    else if (!options_.shift)
      tell_delay(kHeldForce, 0.0);
    if (const double later = found_.intervals.untaken_shift; later != 0.0)
      notes_.warn(text(
          "the force fits its motion better %.2g ms or more %s than a force that is held for its row, but by too little to be taken; the "
          "intervals of mass and friction allow for it (where the time is known, give it: --force-shift \"0 ms\" for a force that is "
          "measured at the instant of the position)",
          1e3 * std::abs(later) * T, later > 0.0 ? "later" : "earlier"));
    return;
  }
  const double shift = found_.log.shift;
  if (told) tell_delay(shift, half);  // what is not told, no controller gets
  add("force_shift", shift * T, "s", "ms", found_.intervals.shift_error * T, true);
  result_.parameters.back().identifiable = told;
  if (!told) say("the one with the smallest residual is removed, but");
  removed(shift, "");
}

void Description::write_symmetric() {
  const map::StaticFit& fit = map();
  result_.set_steady(SteadyModel::kConventional);
  friction::Conventional<double> steady{fit.coulomb, fit.viscous, {}};
  add("load", fit.load, "N", "N", std::hypot(map_error(0), spread_of_load(found_.choice, found_.rows.grid)),
      seen(0));
  add("alpha0", fit.coulomb, "N", "N", map_error(1), seen(1));
  if (fit.family == map::StaticFit::Family::kSymmetricStribeck) {
    steady.stribeck =
        friction::Stribeck<double>{fit.coulomb + fit.rise, fit.v0, static_cast<double>(fit.exponent)};
    const bool told = at_rest_seen_[0] || at_rest_seen_[1];
    VectorXd h = found_.intervals.zero();
    h(at(1)) = h(at(3)) = 1.0;
    // A rival with another exponent has another friction at rest and another v0.
    add("alpha1", fit.coulomb + fit.rise, "N", "N",
        std::hypot(found_.intervals.error_of(h), model_spread(0, 0.0)), told && seen(3));
    add("v0", fit.v0, "m/s", "mm/s", std::hypot(map_error(4), spread_of_v0(found_.choice)), told && seen(4));
    if (fit.exponent == map::Exponent::kOne) {
      constexpr double kNotEstimated = std::numeric_limits<double>::quiet_NaN();
      result_.parameters.push_back(
          {"delta", steady.stribeck->delta, "1", "1", kNotEstimated, kNotEstimated, true});
    }
  }
  add("alpha2", fit.viscous, "N s/m", "N s/mm", map_error(2), seen(2));
  result_.friction.steady = steady;
  if (std::abs(fit.load) > kApart * fit.coulomb) note_load();
}

void Description::note_load() {
  notes_.cannot_tell.emplace_back(
      "how much of the load is really friction that differs between the directions: the given load is half the sum of both");
}

void Description::write_load() {
  const map::StaticFit& fit = map();
  if (found_.load) {
    add("load", fit.load, "N", "N", found_.load->error, true);
    notes_.warn(text(
        "the load of %s is the one with which pre-sliding is as stiff forward as backward; the two directions alone do not tell a load from friction that differs between them",
        Shown(found_.log.records.front()).force(fit.load).c_str()));
    return;
  }
  if (std::abs(fit.load) > 0.0) {
    VectorXd h = found_.intervals.zero();
    for (const map::LevelPoint& p : map::level_points(std::min(fit.top[0], fit.top[1]))) {
      for (int s = 0; s < map::kSides; ++s) {
        const auto [first, count] = fit.span(s);
        std::vector<double> slope(count);
        fit.gradient(s, p.speed, slope.data());
        for (std::size_t j = 0; j < count; ++j)
          h(at(first + j)) += 0.5 * map::kDirection[static_cast<std::size_t>(s)] * p.weight * slope[j];
      }
    }
    add("load", fit.load, "N", "N", found_.intervals.error_of(h), true);
    note_load();
    return;
  }
  // Viscous friction that differs the other way round makes both alike at some speed.
  double apart = 0.0, most = kApart;
  for (const double share : {0.05, 0.5}) {
    const double v = share * std::min(fit.top[0], fit.top[1]);
    const auto level = [&](std::size_t s) { return v > 0.0 ? fit.branch[s].force(v / fit.top[s]) : 0.0; };
    const double half = 0.5 * (level(0) - level(1)), mean = 0.5 * (level(0) + level(1));
    if (std::abs(half) > most * mean) apart = half, most = std::abs(half) / std::max(mean, 1e-300);
  }
  if (apart != 0.0 && !options_.balanced) {
    notes_.cannot_tell.push_back(text(
        "whether half the difference between the directions, %s, is a load or friction: it is taken as friction",
        Shown(found_.log.records.front()).force(std::abs(apart)).c_str()));
  }
}

/// Returns the number of terms.
std::size_t Description::write_branch(std::size_t s, friction::GaussianBranch<double>& branch) {
  const map::BranchFit& b = map().branch[s];
  const double top = map().top[s];
  const double d = map::kDirection[s];
  const std::string tail = std::string("_") + map::kSideName[s];
  branch.eta0 = d * b.eta0;
  branch.eta1 = b.eta1 / top;
  std::size_t i = map().span(static_cast<int>(s)).first;
  add("eta0" + tail, branch.eta0, "N", "N", std::hypot(map_error(i), load_error()), seen(i));
  add("eta1" + tail, branch.eta1, "N s/m", "N s/mm", map_error(i + 1) / top, seen(i + 1));
  i += 2;
  if (b.exponential) {
    const map::FitTerm& g = b.terms.front();
    const bool told = at_rest_seen_[s];
    add("exponential_a" + tail, d * g.a, "N", "N",
        std::hypot(map_error(i), model_spread(static_cast<int>(s), 0.0)), told && seen(i));
    add("exponential_c" + tail, g.c * top, "m/s", "mm/s", map_error(i + 1) * top, told && seen(i + 1));
    for (const map::FitTerm& part : map::as_gaussians(g))
      branch.gaussians.push_back({d * part.a, 0.0, part.c * top});
    return branch.gaussians.size();
  }
  for (std::size_t k = 0; k < b.terms.size(); ++k) {
    const map::FitTerm& g = b.terms[k];
    const std::string name = "gaussian_" + std::to_string(k + 1) + "_";
    const bool told = !b.centred || at_rest_seen_[s];
    branch.gaussians.push_back({d * g.a, d * g.b * top, g.c * top});
    add(name + "a" + tail, d * g.a, "N", "N", map_error(i), told && seen(i));
    ++i;
    if (!b.centred) add(name + "b" + tail, d * g.b * top, "m/s", "mm/s", map_error(i) * top, seen(i)), ++i;
    add(name + "c" + tail, g.c * top, "m/s", "mm/s", map_error(i) * top, told && seen(i));
    ++i;
  }
  return b.terms.size();
}

void Description::write_map() {
  if (map().family != map::StaticFit::Family::kByDirection) {
    write_symmetric();
    return;
  }
  write_load();
  friction::Gaussian<double> steady;
  steady.velocity_range = result_.velocity_range;
  const std::size_t forward = write_branch(0, steady.positive);
  const std::size_t back = write_branch(1, steady.negative);
  result_.set_steady(forward + back > 0 || options_.terms ? SteadyModel::kGaussian
                                                          : SteadyModel::kAsymmetric);
  result_.friction.steady = steady;
  steady.validate([&](const auto&, const auto& words) {
    notes_.warn(std::string("friction map: ") + std::string(words));
  });
}

void Description::write_curve(int s) {
  const double d = map::kDirection[static_cast<std::size_t>(s)];
  std::vector<double> speeds =
      curve_speeds(found_.rows.grid[static_cast<std::size_t>(s)], std::max(21, options_.curve_points));
  std::vector<CurvePoint> points;
  for (const double speed : speeds) {
    const Figure own = friction_at(map(), s, speed);
    const double half = found_.intervals.factor * curve_error(own, s, speed);
    const double f = d * own.value;
    points.push_back({d * speed, f, f - half, f + half});
  }
  keep_told(points);
  if (s == 1) std::reverse(points.begin(), points.end());
  result_.curve.insert(result_.curve.end(), points.begin(), points.end());
}

/// Drops the ends of the curve whose half width exceeds a fifth of the friction, and adds a note. Points in ascending speed.
void Description::keep_told(std::vector<CurvePoint>& points) {
  const auto [first, last] = told_part(points);
  const Shown shown(found_.log.records.front());
  const auto say = [&](const char* where, const CurvePoint& p) {
    notes_.cannot_tell.push_back(
        text("friction %s than %s: its half width is more than a fifth of it, and the curve %s there; "
             "add strokes or jogs at such speeds",
             where, shown.velocity(p.velocity).c_str(), where[0] == 's' ? "begins" : "ends"));
  };
  const bool slowly = std::abs(points[first].velocity) > kWorthSlow * std::abs(points.back().velocity);
  if (first > 0 && slowly) say("slower", points[first]);
  if (last < points.size()) say("faster", points[last - 1]);
  points = std::vector<CurvePoint>(points.begin() + static_cast<std::ptrdiff_t>(first),
                                   points.begin() + static_cast<std::ptrdiff_t>(last));
}

void Description::write_points() {
  const map::StaticFit& fit = map();
  const Rows& rows = found_.rows;
  const std::vector<double>& residual = found_.intervals.residual;
  double sum = 0.0, square = 0.0, left = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double f = motion_of(found_.log, rows, i).f[rows.at[i]];
    sum += f;
    square += f * f;
    left += residual[i] * residual[i];
  }
  const auto count = static_cast<double>(rows.size());
  result_.r_squared = 1.0 - left / std::max(square - sum * sum / count, 1e-300);
  const auto wanted = static_cast<std::size_t>(std::max(1, 2 * options_.map_points));
  const std::size_t step = std::max<std::size_t>(1, rows.size() / wanted);
  for (std::size_t i = 0; i < rows.size(); i += step) {
    const std::size_t s = rows.side[i];
    const double v = velocity_of(found_.log, rows, i);
    const double f =
        map::kDirection[s] * fit.force(static_cast<int>(s), std::abs(v)) - fit.load + residual[i];
    result_.map.push_back({v, f, s == 0 ? 1 : -1});
  }
  const std::size_t fine = std::max<std::size_t>(1, rows.size() / kShownResiduals);
  for (std::size_t i = 0; i < rows.size(); i += fine) {
    const log::Record& record = found_.log.records[static_cast<std::size_t>(rows.record[i])];
    result_.residuals.push_back({record.t[rows.at[i]], motion_of(found_.log, rows, i).x[rows.at[i]],
                                 velocity_of(found_.log, rows, i), residual[i], rows.record[i]});
  }
}

}  // namespace

Result describe(const Found& found, const DriveFitOptions& options, Notes& notes) {
  return Description(found, options, notes).write();
}

}  // namespace stribeck::ident::drive
