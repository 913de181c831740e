#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stribeck/ident/bristle/bristle_fit.hpp>
#include <stribeck/ident/drive/drive_fit_parts.hpp>
#include <stribeck/ident/stats/uncertainty.hpp>

namespace stribeck::ident::drive {
namespace {

constexpr std::size_t kShownResiduals = 4000;
constexpr double kApart = 0.1;  ///< of friction: difference of the directions that is worth a word

}  // namespace

std::string DriveFit::in_units(std::string unit) const {
  // "N" and the metre are written for whatever the log holds.
  if (records_.front().force_unit != "N" && unit.starts_with("N"))
    unit = records_.front().force_unit + unit.substr(1);
  return unit;
}

void DriveFit::add(std::string name, double value, const std::string& unit, const std::string& shown,
                   double error, bool seen) {
  Parameter p;
  p.name = std::move(name);
  p.value = value;
  p.unit = in_units(unit);
  p.shown = in_units(shown);
  p.ci_low = value - factor_ * error;
  p.ci_high = value + factor_ * error;
  p.identifiable = seen && std::isfinite(error) && factor_ * error < std::abs(value);
  result_.parameters.push_back(std::move(p));
}

Result DriveFit::finish() {
  const map::StaticFit& fit = choice_.fit;
  const std::size_t q = columns();
  result_.method = "auto";
  result_.force_unit = records_.front().force_unit;
  result_.position_unit = records_.front().position_unit;
  const bool newton = result_.force_unit == "N";
  result_.mass = mass_;
  result_.plain_mass = options_.mass ? std::numeric_limits<double>::quiet_NaN() : plain_mass_;
  const double mass_error = options_.mass ? 0.0 : error_at(0);
  result_.mass_interval = {mass_ - factor_ * mass_error, mass_ + factor_ * mass_error};
  result_.velocity_range = {-grid_[1].high, grid_[0].high};
  result_.rows = rows_.size();
  result_.peaks = {map::peaks_of(line_[0]), map::peaks_of(line_[1])};
  add("mass", mass_, newton ? "kg" : "N s2/m", newton ? "N s2/mm" : "N s2/m", mass_error, true);
  if (!result_.parameters.back().identifiable) {
    warn("the mass cannot be determined from this log; run a sine or pulses, or give the mass");
  }
  if (shift_free_) {
    const double T = records_.front().sample_time;
    // A held force belongs to the motion half a row later without any delay (motion.hpp). One that was measured stands late, if
    // at all, and acts at once.
    result_.delay = std::max(0.0, (-shift_ - 0.5) * T);
    add("force_shift", shift_ * T, "s", "ms", error_at(q - 1) * T, true);
    warn(text("in the log the force is %.3g rows (%.3g ms) %s than its motion; this shift is removed",
              std::abs(shift_), std::abs(shift_) * T * 1e3, shift_ > 0 ? "later" : "earlier"));
  }
  result_.load = fit.load;
  write_map();
  write_waves();
  for (int s = map::kSides - 1; s >= 0; --s) write_curve(s);
  write_points();
  result_.held_out_rms = choice_.held_out_rms;
  result_.models = choice_.candidates;
  if (options_.dynamics) bristle();
  drift();
  return std::move(result_);
}

void DriveFit::write_map() {
  const map::StaticFit& fit = choice_.fit;
  const std::size_t q = columns();
  auto error = [&](std::size_t i) { return error_at(q + i); };
  auto seen = [&](std::size_t i) { return blind_[i] < 0.1; };
  if (fit.family != map::StaticFit::Family::kByDirection) {
    result_.model = "conventional";
    friction::Conventional<double> map{fit.coulomb, fit.viscous, {}};
    add("load", fit.load, "N", "N", error(0), seen(0));
    add("alpha0", fit.coulomb, "N", "N", error(1), seen(1));
    if (fit.family == map::StaticFit::Family::kSymmetricStribeck) {
      map.stribeck = friction::Stribeck<double>{fit.coulomb + fit.rise, fit.v0, 2.0};
      VectorXd h = VectorXd::Zero(covariance_.rows());
      h(static_cast<Index>(q) + 1) = h(static_cast<Index>(q) + 3) = 1.0;
      add("alpha1", fit.coulomb + fit.rise, "N", "N", error_of(h), seen(3));
      add("v0", fit.v0, "m/s", "mm/s", error(4), seen(4));
    }
    add("alpha2", fit.viscous, "N s/m", "N s/mm", error(2), seen(2));
    result_.friction.steady = map;
    return;
  }
  friction::Gaussian<double> map;
  map.velocity_range = result_.velocity_range;
  std::size_t most = 0;
  if (std::abs(fit.load) > 0.0) {
    VectorXd h = VectorXd::Zero(covariance_.rows());
    h(static_cast<Index>(q)) = 0.5;
    h(static_cast<Index>(q + fit.span(1).first)) = -0.5;
    add("load", fit.load, "N", "N", error_of(h), true);
    result_.cannot_tell.emplace_back(
        "how much of the load is friction that differs by direction: it is half the sum of both directions");
  } else {
    const double v = 0.5 * std::min(fit.top[0], fit.top[1]);
    const auto level = [&](std::size_t s) { return v > 0.0 ? fit.branch[s].force(v / fit.top[s]) : 0.0; };
    const double apart = 0.5 * (level(0) - level(1));
    if (std::abs(apart) > kApart * 0.5 * (level(0) + level(1))) {
      result_.cannot_tell.push_back(text(
          "whether the difference of %.3g %s between each direction and their mean is a load or friction: "
          "taken as friction",
          std::abs(apart), result_.force_unit.c_str()));
    }
  }
  for (std::size_t s = 0; s < map::kSides; ++s) {
    const map::BranchFit& b = fit.branch[s];
    const double top = fit.top[s];
    const double d = map::kDirection[s];
    const std::string tail = std::string("_") + map::kSideName[s];
    friction::GaussianBranch<double>& branch = s == 0 ? map.positive : map.negative;
    branch.eta0 = d * b.eta0;
    branch.eta1 = b.eta1 / top;
    std::size_t i = fit.span(static_cast<int>(s)).first;
    add("eta0" + tail, branch.eta0, "N", "N", error(i), seen(i));
    add("eta1" + tail, branch.eta1, "N s/m", "N s/mm", error(i + 1) / top, seen(i + 1));
    i += 2;
    for (std::size_t k = 0; k < b.terms.size(); ++k) {
      const map::FitTerm& g = b.terms[k];
      const std::string name = "gaussian_" + std::to_string(k + 1) + "_";
      branch.gaussians.push_back({d * g.a, d * g.b * top, g.c * top});
      add(name + "a" + tail, d * g.a, "N", "N", error(i), seen(i));
      ++i;
      if (!b.centred) add(name + "b" + tail, d * g.b * top, "m/s", "mm/s", error(i) * top, seen(i)), ++i;
      add(name + "c" + tail, g.c * top, "m/s", "mm/s", error(i) * top, seen(i));
      ++i;
    }
    most = std::max(most, b.terms.size());
  }
  result_.model = most > 0 || options_.terms ? "gaussian" : "asymmetric";
  result_.friction.steady = map;
  map.validate(
      [&](const auto&, const auto& words) { warn(std::string("friction map: ") + std::string(words)); });
}

void DriveFit::write_waves() {
  if (waves_.empty()) return;
  result_.model += " + periodic";
  const std::size_t first = options_.mass ? 0 : 1;
  for (std::size_t w = 0; w < waves_.size(); ++w) {
    const std::size_t i = first + 2 * w;
    const double s = linear_(static_cast<Index>(i)), c = linear_(static_cast<Index>(i) + 1);
    // s·sin + c·cos = A·sin(· − φ)
    const double amplitude = std::hypot(s, c);
    const double phase = std::atan2(-c, s);
    VectorXd along = VectorXd::Zero(covariance_.rows()), across = along;
    along(static_cast<Index>(i)) = s / amplitude, along(static_cast<Index>(i) + 1) = c / amplitude;
    across(static_cast<Index>(i)) = c / (amplitude * amplitude);
    across(static_cast<Index>(i) + 1) = -s / (amplitude * amplitude);
    const std::string tail = "_" + std::to_string(w + 1);
    add("periodic_amplitude" + tail, amplitude, "N", "N", error_of(along), true);
    Parameter period;
    period.name = "periodic_period" + tail;
    period.value = waves_[w].period;
    period.unit = "m", period.shown = "mm";
    period.ci_low = waves_[w].period_interval.low, period.ci_high = waves_[w].period_interval.high;
    result_.parameters.push_back(period);
    add("periodic_phase" + tail, phase, "rad", "rad", error_of(across), true);
    result_.parameters.back().identifiable = factor_ * error_of(across) < 0.5 * kPi;
    result_.friction.eccentric.push_back({amplitude, waves_[w].period, phase, waves_[w].form});
  }
  warn("the phase of the periodic terms belongs to the homing position of this log");
}

void DriveFit::write_curve(int s) {
  const map::StaticFit& fit = choice_.fit;
  const auto S = static_cast<std::size_t>(s);
  const auto [first, count] = fit.span(s);
  const std::size_t q = columns();
  const int points = std::max(21, options_.curve_points);
  std::vector<double> g(count);
  for (int i = 0; i < points; ++i) {
    const int at = s == 0 ? i : points - 1 - i;
    const double speed = grid_[S].low + (grid_[S].high - grid_[S].low) * at / (points - 1);
    fit.gradient(s, speed, g.data());
    VectorXd h = VectorXd::Zero(covariance_.rows());
    for (std::size_t j = 0; j < count; ++j) h(static_cast<Index>(q + first + j)) = g[j];
    // The load is a parameter of its own in the symmetric families; friction is what is shown.
    const double own = fit.force(s, speed) - map::kDirection[S] * fit.load;
    if (fit.family != map::StaticFit::Family::kByDirection) h(static_cast<Index>(q)) = 0.0;
    // What the models differ in that the data cannot tell apart is part of the uncertainty (Buckland et al.
    // 1997).
    double spread = 0.0;
    for (const map::StaticFit& r : choice_.rivals)
      spread += std::pow(r.force(s, speed) - fit.force(s, speed), 2.0);
    if (!choice_.rivals.empty()) spread /= static_cast<double>(choice_.rivals.size() + 1);
    const double error = error_of(h);
    const double half = factor_ * std::sqrt(error * error + spread);
    const double f = map::kDirection[S] * own;
    result_.curve.push_back({map::kDirection[S] * speed, f, f - half, f + half});
  }
}

void DriveFit::write_points() {
  const map::StaticFit& fit = choice_.fit;
  double sum = 0.0, square = 0.0, left = 0.0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double f = motion(i).f[rows_.at[i]];
    sum += f;
    square += f * f;
    left += residual_[i] * residual_[i];
  }
  const auto rows = static_cast<double>(rows_.size());
  result_.r_squared = 1.0 - left / std::max(square - sum * sum / rows, 1e-300);
  const auto wanted = static_cast<std::size_t>(std::max(1, 2 * options_.map_points));
  const std::size_t step = std::max<std::size_t>(1, rows_.size() / wanted);
  for (std::size_t i = 0; i < rows_.size(); i += step) {
    const int s = rows_.side[i];
    const double v = velocity(i);
    const double f = map::kDirection[rows_.side[i]] * fit.force(s, std::abs(v)) - fit.load + residual_[i];
    result_.map.push_back({v, f, s == 0 ? 1 : -1});
  }
  const std::size_t fine = std::max<std::size_t>(1, rows_.size() / kShownResiduals);
  for (std::size_t i = 0; i < rows_.size(); i += fine) {
    const auto r = static_cast<std::size_t>(rows_.record[i]);
    result_.residuals.push_back(
        {records_[r].t[rows_.at[i]], motion(i).x[rows_.at[i]], velocity(i), residual_[i], rows_.record[i]});
  }
}

void DriveFit::bristle() {
  if (!(mass_ > 0.0) || result_.position_unit != "m") return;
  friction::AxisModel known{mass_, result_.load, result_.friction};
  std::vector<log::Record> records;
  for (std::size_t r = 0; r < records_.size(); ++r) {
    if (motions_[r].loop == log::Loop::kClosed) records.push_back(records_[r]);
  }
  bristle::BristleOptions options;
  options.shift = shift_;
  const bool open = records.empty();
  bristle::BristleFit fit;
  try {
    fit = bristle::fit_bristle(open ? records_ : records, known, options);
  } catch (const Refused& why) {
    fit.reason = why.what();
  }
  if (!fit.determinable) {
    result_.cannot_tell.push_back(fit.reason);
    return;
  }
  const bool gms = std::holds_alternative<friction::Gms<double>>(fit.best);
  result_.friction.dynamics = fit.best;
  result_.model += gms ? " + gms" : " + lugre";
  for (Parameter p : gms ? fit.gms_parameters : fit.lugre_parameters) {
    // The ringing after pulses tells stiffness, its damping hardly (bristle_fit.hpp).
    if (open && p.name != "sigma0" && p.name != "stiffness") p.identifiable = false;
    result_.parameters.push_back(std::move(p));
  }
  result_.break_away_distance = fit.break_away;
  result_.parameters.push_back({"break_away_distance", fit.break_away, "m", "um", fit.break_away_interval.low,
                                fit.break_away_interval.high, true});
  for (Candidate c : fit.models) {
    c.name = "after reversals: " + c.name;
    result_.models.push_back(std::move(c));
  }
}

void DriveFit::drift() {
  std::vector<std::size_t> length(records_.size());
  for (const int r : rows_.record) ++length[static_cast<std::size_t>(r)];
  const auto longest = static_cast<int>(std::max_element(length.begin(), length.end()) - length.begin());
  std::vector<std::size_t> rows;
  for (const std::size_t i : sample()) {
    if (rows_.record[i] == longest) rows.push_back(i);
  }
  if (rows.size() < 500) return;
  const log::Record& rec = records_[static_cast<std::size_t>(longest)];
  const double from = rec.t[rows_.at[rows.front()]], to = rec.t[rows_.at[rows.back()]];
  MatrixXd X(static_cast<Index>(rows.size()), 2);
  VectorXd y(static_cast<Index>(rows.size()));
  std::vector<int> record(rows.size(), 0);
  std::vector<std::size_t> at(rows.size());
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const auto k = static_cast<Index>(j);
    const double tau = (rec.t[rows_.at[rows[j]]] - from) / (to - from) - 0.5;
    X(k, 0) = tau;
    X(k, 1) = tau * direction(rows[j]);
    y(k) = residual_[rows[j]];
    at[j] = rows_.at[rows[j]];
  }
  const MatrixXd normal = X.transpose() * X;
  // One direction only, or next to it: offset and friction cannot be told apart.
  if (!(normal.determinant() > 1e-3 * normal(0, 0) * normal(1, 1))) return;
  const MatrixXd inverse = normal.inverse();
  const VectorXd x = inverse * (X.transpose() * y);
  const stats::Uncertainty uncertainty(X, y - X * x, inverse, record, at);
  const double level = 0.5 * (choice_.fit.force(0, grid_[0].low) + choice_.fit.force(1, grid_[1].low));
  constexpr double kWorthSaying = 0.02;
  const char* what[2] = {"the offset of the force", "friction"};
  for (Index j = 0; j < 2; ++j) {
    const double half = uncertainty.half_width(VectorXd::Unit(2, j));
    // Slow noise looks like a drift now and then: twice the interval.
    if (std::abs(x(j)) < 2.0 * half || std::abs(x(j)) < kWorthSaying * std::abs(level)) continue;
    warn(text(
        "%s %s by %.3g %s (%.2g %% of the friction) from begin to end of %s: warming up or running in; the "
        "result is the mean over the record",
        what[j], x(j) > 0 ? "rose" : "fell", std::abs(x(j)), result_.force_unit.c_str(),
        100.0 * std::abs(x(j) / level), rec.source.c_str()));
  }
}

}  // namespace stribeck::ident::drive
