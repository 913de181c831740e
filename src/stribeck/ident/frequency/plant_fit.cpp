#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/digits.hpp>
#include <stribeck/ident/frequency/plant_fit.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/least_squares.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::frequency {
namespace {

constexpr int kFolds = 5;
constexpr std::size_t kFewestLines = 6;
constexpr double kFarBetter = 0.9;       ///< of the error on held-out lines
constexpr double kFarAway = 0.5;         ///< the same, for a resonance of which only the beginning is seen
constexpr double kMore = 3.0;            ///< times the noise: there is more in the lines than one mass
constexpr double kKnownResonance = 0.1;  ///< relative half width
constexpr double kRoughResonance = 0.5;  ///< the same, above the lines, where the antiresonance is known
constexpr double kKnownLag = 1.0 / 3.0;  ///< relative half width
constexpr double kLeastDelay =
    -0.1;  ///< beside a lag [periods]: a log of the force that the drive makes has neither hold nor lag
constexpr double kBadSquare = 1e30;

/// (e^{pt} − 1)/p.
Complex phi1(Complex p, double t) {
  const Complex q = p * t;
  if (std::abs(q) > 1e-2) return (std::exp(q) - 1.0) / p;
  return t * (1.0 + q / 2.0 * (1.0 + q / 3.0 * (1.0 + q / 4.0 * (1.0 + q / 5.0 * (1.0 + q / 6.0)))));
}
/// Integral of phi1 from 0 to t.
Complex phi2(Complex p, double t) {
  const Complex q = p * t;
  if (std::abs(q) > 1e-2) return (phi1(p, t) - t) / p;
  return 0.5 * t * t * (1.0 + q / 3.0 * (1.0 + q / 4.0 * (1.0 + q / 5.0 * (1.0 + q / 6.0))));
}

/// One pole of V(s) with its residue, sampled: position for a unit force under a hold that is late by d whole periods and a rest.
class Mode {
 public:
  Mode(Complex pole, Complex residue, double sample_time, double rest)
      : residue_(residue), decay_(std::exp(pole * sample_time)) {
    const double late = sample_time - rest;
    all_ = phi1(pole, sample_time);
    v_new_ = phi1(pole, late);
    x_new_ = phi2(pole, late);
    v_old_ = all_ - v_new_;
    x_old_ = phi2(pole, sample_time) - x_new_;
  }
  [[nodiscard]] Complex at(Complex z) const {
    const Complex v = (v_new_ + v_old_ / z) / (z - decay_);
    return residue_ * (all_ * v + x_new_ + x_old_ / z) / (z - 1.0);
  }

 private:
  Complex residue_, decay_, all_, v_new_, v_old_, x_new_, x_old_;
};

/// All modes of a plant.
class Sampled {
 public:
  Sampled(const Plant& p, double sample_time) : sample_time_(sample_time) {
    whole_ = std::floor(p.delay / sample_time);
    const double rest = p.delay - whole_ * sample_time;
    const double slow = -p.viscous / p.mass;
    if (p.structure == Structure::kRigid) {
      modes_.emplace_back(slow, 1.0 / p.mass, sample_time, rest);
      return;
    }
    if (p.structure == Structure::kRigidLag) {
      const double behind = -1.0 / p.lag, residue = 1.0 / (p.mass * p.lag * (slow - behind));
      modes_.emplace_back(slow, residue, sample_time, rest);
      modes_.emplace_back(behind, -residue, sample_time, rest);
      return;
    }
    const double w = p.resonance;
    const double zeta = std::min(p.damping, 0.999);
    const Complex fast = w * Complex(-zeta, std::sqrt(1.0 - zeta * zeta));
    const auto numerator = [&](Complex s) {
      if (p.structure == Structure::kTwoMassTable) return 1.0 + 2.0 * zeta * s / w;
      const Complex q = s / p.antiresonance;
      return q * q + 2.0 * p.zero_damping * q + 1.0;
    };
    const Complex rigid = numerator(slow) / (slow * slow / (w * w) + 2.0 * zeta * slow / w + 1.0);
    const Complex elastic = numerator(fast) * w * w / ((fast - slow) * (fast - std::conj(fast)));
    modes_.emplace_back(slow, rigid / p.mass, sample_time, rest);
    modes_.emplace_back(fast, elastic / p.mass, sample_time, rest);
    modes_.emplace_back(std::conj(fast), std::conj(elastic) / p.mass, sample_time, rest);
  }
  [[nodiscard]] Complex at(double omega) const {
    const Complex z = std::polar(1.0, omega * sample_time_);
    Complex sum = 0.0;
    for (const Mode& m : modes_) sum += m.at(z);
    return sum * std::polar(1.0, -omega * sample_time_ * whole_);
  }

 private:
  double sample_time_;
  double whole_ = 0.0;
  std::vector<Mode> modes_;
};

/// What is fitted: lines with their weights.
struct Data {
  double sample_time = 0.0;
  std::vector<double> omega;
  std::vector<Complex> response;
  std::vector<double> sigma;  ///< relative, of the real and of the imaginary part
  double units = 2.0;         ///< strokes or segments that are independent of each other

  [[nodiscard]] Data part(int fold, bool held_out) const {
    Data out{sample_time, {}, {}, {}, units};
    for (std::size_t i = 0; i < omega.size(); ++i) {
      if ((static_cast<int>(i % kFolds) == fold) != held_out) continue;
      out.omega.push_back(omega[i]);
      out.response.push_back(response[i]);
      out.sigma.push_back(sigma[i]);
    }
    return out;
  }
};

int parameters_of(Structure s) {
  return s == Structure::kRigid ? 3 : s == Structure::kRigidLag ? 4 : s == Structure::kTwoMassDrive ? 7 : 5;
}
bool elastic(Structure s) { return s == Structure::kTwoMassDrive || s == Structure::kTwoMassTable; }

/// Parameters of order one: ln m, c over m and the lowest line, τ over the period, then ln ωp, ln ζp, ln ωz, ln ζz, or the lag: ln of T
/// over the period.
Plant plant_from(const double* p, Structure structure, double slowest, double sample_time) {
  Plant out;
  out.structure = structure;
  out.mass = std::exp(p[0]);
  out.viscous = p[1] * out.mass * slowest;
  out.delay = p[2] * sample_time;
  if (structure == Structure::kRigid) return out;
  if (structure == Structure::kRigidLag) {
    out.lag = std::exp(p[3]) * sample_time;
    return out;
  }
  out.resonance = std::exp(p[3]);
  out.damping = std::exp(p[4]);
  if (structure == Structure::kTwoMassTable) return out;
  out.antiresonance = std::exp(p[5]);
  out.zero_damping = std::exp(p[6]);
  return out;
}

class Errors : public stats::Residuals {
 public:
  Errors(const Data& data, Structure structure, double slowest)
      : data_(data), structure_(structure), slowest_(slowest) {}
  [[nodiscard]] int count() const override { return 2 * static_cast<int>(data_.omega.size()); }
  [[nodiscard]] int parameters() const override { return parameters_of(structure_); }
  bool evaluate(const double* p, double* residuals, double* jacobian) const override {
    if (!fill(p, residuals)) return false;
    if (jacobian == nullptr) return true;
    const auto n = static_cast<std::size_t>(count());
    std::vector<double> moved(p, p + parameters());
    std::vector<double> up(n);
    std::vector<double> down(n);
    for (int j = 0; j < parameters(); ++j) {
      constexpr double kStep = 1e-6;
      const auto at = static_cast<std::size_t>(j);
      moved[at] = p[j] + kStep;
      if (!fill(moved.data(), up.data())) return false;
      moved[at] = p[j] - kStep;
      if (!fill(moved.data(), down.data())) return false;
      moved[at] = p[j];
      for (std::size_t i = 0; i < n; ++i) jacobian[at * n + i] = (up[i] - down[i]) / (2.0 * kStep);
    }
    return true;
  }

 private:
  bool fill(const double* p, double* out) const {
    const Plant plant = plant_from(p, structure_, slowest_, data_.sample_time);
    const double top = kPi / data_.sample_time;
    if (structure_ == Structure::kRigidLag && std::abs(p[3]) > 5.0) return false;
    if (elastic(structure_) && (plant.resonance > top || plant.damping > 0.9 || plant.damping < 1e-5))
      return false;
    if (structure_ == Structure::kTwoMassDrive &&
        (p[5] > p[3] || p[5] < p[3] - 3.0 || plant.zero_damping > 2.0))
      return false;
    if (std::abs(p[1]) > 1e3 || std::abs(p[2]) > 100.0) return false;
    const Sampled model(plant, data_.sample_time);
    for (std::size_t i = 0; i < data_.omega.size(); ++i) {
      const Complex e = (model.at(data_.omega[i]) / data_.response[i] - 1.0) / data_.sigma[i];
      out[2 * i] = e.real();
      out[2 * i + 1] = e.imag();
      if (!std::isfinite(out[2 * i]) || !std::isfinite(out[2 * i + 1])) return false;
    }
    return true;
  }

  const Data& data_;
  Structure structure_;
  double slowest_;
};

struct Fitted {
  Eigen::VectorXd p;
  double squares = kBadSquare;
};

double squares_of(const Data& data, Structure s, double slowest, const Eigen::VectorXd& p) {
  const Errors errors(data, s, slowest);
  std::vector<double> r(static_cast<std::size_t>(errors.count()));
  if (!errors.evaluate(p.data(), r.data(), nullptr)) return kBadSquare;
  double sum = 0.0;
  for (const double e : r) sum += e * e;
  return sum;
}

Fitted descend(const Data& data, Structure s, double slowest, Eigen::VectorXd start) {
  if (squares_of(data, s, slowest, start) >= kBadSquare) return {std::move(start), kBadSquare};
  const Errors errors(data, s, slowest);
  stats::minimise_squares(errors, start,
                          {.iterations = 60, .parameter_tolerance = 1e-9, .function_tolerance = 1e-9});
  const double squares = squares_of(data, s, slowest, start);
  return {std::move(start), squares};
}

/// The mass by each line, for a double integrator.
std::vector<double> line_masses(const Data& data) {
  std::vector<double> masses;
  for (std::size_t i = 0; i < data.omega.size(); ++i)
    masses.push_back(1.0 / (std::abs(data.response[i]) * data.omega[i] * data.omega[i]));
  return masses;
}

/// Starts with the antiresonance where the lines are deepest and the mass of the slow lines: one mass that fits neither side of an
/// antiresonance is no start, and the resonance may lie above all lines.
std::vector<Eigen::VectorXd> starts_by_antiresonance(const Data& data) {
  const std::vector<double> masses = line_masses(data);
  const auto deepest =
      static_cast<std::size_t>(std::max_element(masses.begin(), masses.end()) - masses.begin());
  const double mass =
      stats::median({masses.begin(), masses.begin() + static_cast<std::ptrdiff_t>(deepest / 2 + 1)});
  std::vector<Eigen::VectorXd> starts;
  for (const double above : {1.25, 1.7, 2.4, 4.0}) {
    Eigen::VectorXd p(parameters_of(Structure::kTwoMassDrive));
    const double w = data.omega[deepest];
    p << std::log(mass), 0.0, 0.0, std::log(above * w), std::log(0.03), std::log(w), std::log(0.03);
    starts.push_back(std::move(p));
  }
  return starts;
}

/// Least squares from several starts: friction, delay, and where the resonance may be.
Fitted fit(const Data& data, Structure s, double slowest, const Fitted* rigid) {
  Fitted best;
  const auto keep = [&](Fitted f) {
    if (f.squares < best.squares) best = std::move(f);
  };
  if (s == Structure::kRigid) {
    std::vector<double> masses = line_masses(data);
    std::nth_element(masses.begin(), masses.begin() + static_cast<std::ptrdiff_t>(masses.size() / 2),
                     masses.end());
    for (const double delay : {0.0, 1.0, 3.0}) {
      Eigen::VectorXd p(3);
      p << std::log(masses[masses.size() / 2]), 0.0, delay;
      keep(descend(data, s, slowest, p));
    }
    return best;
  }
  if (s == Structure::kRigidLag) {
    for (const double lag : {0.3, 1.0, 3.0, 10.0}) {
      Eigen::VectorXd p(4);
      p.head(3) = rigid->p;
      p[2] = std::max(0.0, p[2] - lag);
      p[3] = std::log(lag);
      keep(descend(data, s, slowest, p));
    }
    return best;
  }
  if (s == Structure::kTwoMassDrive) {
    for (const Eigen::VectorXd& p : starts_by_antiresonance(data)) keep(descend(data, s, slowest, p));
  }
  const double low = 2.0 * data.omega.front();
  const double high = std::min(1.2 * data.omega.back(), 0.98 * kPi / data.sample_time);
  for (double w = low; w < high; w *= 1.15) {
    for (const double apart : {0.05, 0.35, 1.0}) {
      Eigen::VectorXd p(parameters_of(s));
      p.head(3) = rigid->p;
      p[3] = std::log(w);
      p[4] = std::log(0.03);
      if (s == Structure::kTwoMassDrive) {
        p[5] = p[3] - apart;
        p[6] = std::log(0.03);
        p[0] += 0.5 * apart;  // above the resonance only the mass before the spring is seen
      } else if (apart > 0.05) {
        continue;
      }
      keep(descend(data, s, slowest, p));
    }
  }
  return best;
}

/// Squares on lines that the fit did not see, per degree of freedom.
double held_out_error(const Data& data, Structure s, double slowest, const Fitted& all) {
  double sum = 0.0;
  for (int fold = 0; fold < kFolds; ++fold) {
    const Fitted f = descend(data.part(fold, false), s, slowest, all.p);
    sum += squares_of(data.part(fold, true), s, slowest, f.p);
  }
  return std::sqrt(sum / (2.0 * static_cast<double>(data.omega.size())));
}

/// Half widths of the parameters.
Eigen::VectorXd parameter_half_widths(const Data& data, Structure s, double slowest, const Fitted& f,
                                      double* excess) {
  const Errors errors(data, s, slowest);
  const int n = errors.count();
  const int k = errors.parameters();
  Eigen::MatrixXd jacobian(n, k);
  Eigen::VectorXd r(n);
  Eigen::VectorXd out = Eigen::VectorXd::Constant(k, std::numeric_limits<double>::infinity());
  if (!errors.evaluate(f.p.data(), r.data(), jacobian.data())) return out;
  const double freedom = std::max(1, n - k);
  *excess = std::sqrt(f.squares / freedom);
  const Eigen::MatrixXd covariance = stats::pseudo_inverse(jacobian.transpose() * jacobian);
  // What friction distorts is common to the lines of a stroke: no more is known of the scatter than the strokes tell, each with a real and an imaginary part.
  const double independent = std::clamp(2.0 * (data.units - 1.0), 1.0, freedom);
  const double factor = stats::student_factor(independent) * std::max(1.0, *excess);
  for (int j = 0; j < k; ++j) out[j] = factor * std::sqrt(std::max(0.0, covariance(j, j)));
  return out;
}

Data data_of(const Response& response) {
  Data data;
  data.sample_time = response.sample_time;
  data.units = static_cast<double>(response.units);
  for (const Line& line : response.lines) {
    if (!line.determined()) continue;
    data.omega.push_back(line.omega);
    data.response.push_back(line.plant);
    // 95 % of a normal error; a floor, because no line is better than 0.01 %.
    data.sigma.push_back(std::max(1e-4, line.half_width / 1.96));
  }
  if (data.omega.size() < kFewestLines) {
    throw Refused(fmt::format(
        "frequency response: {} lines are determined, a fit of mass and delay needs {} (excite more "
        "frequencies, more strongly, or for longer)",
        data.omega.size(), kFewestLines));
  }
  return data;
}

/// A fit of one structure with what decides between them.
struct Candidate {
  Structure structure = Structure::kRigid;
  Fitted fitted;
  Eigen::VectorXd half;
  double excess = 1.0;
  double held_out = std::numeric_limits<double>::quiet_NaN();
};

std::string choice_in_words(const Candidate& best, const Candidate& rigid, const Data& data) {
  const double top = data.omega.back() / (2.0 * kPi);
  if (best.structure == Structure::kRigidLag)
    return fmt::format(
        "a force behind a lag of first order, of a current loop or a filter, misses held-out lines by {} times their noise, a delay alone by "
        "{} times",
        digits(best.held_out), digits(rigid.held_out));
  if (best.structure == Structure::kRigid)
    return fmt::format(
        "no resonance is visible up to {} Hz: two masses are not better than one on held-out lines, or "
        "would have a resonance that the lines do not determine",
        digits(top));
  return fmt::format("two masses miss held-out lines by {} times their noise, one mass by {} times",
                     digits(best.held_out), digits(rigid.held_out));
}

/// Whether the lines show where the resonance is, or with a motor that feels both masses where the antiresonance below it is.
bool determined(const Candidate& c, const Data& data) {
  const auto shown = [&](std::size_t i) {
    return c.half[i] <= kKnownResonance && std::exp(c.fitted.p[i]) <= data.omega.back();
  };
  return shown(3) || (c.structure == Structure::kTwoMassDrive && shown(5) && c.half[3] <= kRoughResonance);
}

PlantFit result_of(const Candidate& c, const Data& data) {
  const double slowest = data.omega.front();
  PlantFit out;
  out.plant = plant_from(c.fitted.p.data(), c.structure, slowest, data.sample_time);
  const Plant& p = out.plant;
  const double hidden = std::abs(p.viscous) / (p.mass * data.omega.back());
  out.mass = {p.mass, p.mass * (c.half[0] + hidden)};
  out.viscous = {p.viscous, p.mass * slowest * c.half[1] + std::abs(p.viscous) * c.half[0]};
  out.delay = {p.delay, data.sample_time * c.half[2]};
  if (c.structure == Structure::kRigidLag) out.lag = Value{p.lag, p.lag * c.half[3]};
  if (elastic(c.structure)) {
    out.resonance = Value{p.resonance, p.resonance * (c.half[3] + 0.5 * hidden)};
    out.damping = Value{p.damping, p.damping * c.half[4]};
  }
  if (c.structure == Structure::kTwoMassDrive)
    out.antiresonance = Value{p.antiresonance, p.antiresonance * c.half[5]};
  out.excess = c.excess;
  const Sampled model(p, data.sample_time);
  double sum = 0.0;
  for (std::size_t i = 0; i < data.omega.size(); ++i)
    sum += std::norm(model.at(data.omega[i]) / data.response[i] - 1.0);
  out.misfit = std::sqrt(sum / static_cast<double>(data.omega.size()));
  return out;
}

}  // namespace

Complex sampled_response(const Plant& plant, double omega, double sample_time) {
  return Sampled(plant, sample_time).at(omega);
}

PlantFit fit_plant(const Response& response) {
  const Data data = data_of(response);
  const double slowest = data.omega.front();
  std::vector<Candidate> all;
  for (const Structure s :
       {Structure::kRigid, Structure::kTwoMassDrive, Structure::kTwoMassTable, Structure::kRigidLag}) {
    Candidate c;
    c.structure = s;
    const bool rigid_fits = !all.empty() && all.front().fitted.squares < kBadSquare;
    if (s == Structure::kRigid ||
        (rigid_fits && data.omega.size() >= 2 * static_cast<std::size_t>(parameters_of(s))))
      c.fitted = fit(data, s, slowest, all.empty() ? nullptr : &all.front().fitted);
    if (c.fitted.squares < kBadSquare) {
      c.half = parameter_half_widths(data, s, slowest, c.fitted, &c.excess);
      c.held_out = held_out_error(data, s, slowest, c.fitted);
    }
    all.push_back(std::move(c));
  }
  if (all.front().fitted.squares >= kBadSquare)
    throw Refused(
        "frequency response: no mass and delay fit the lines (look at the picture: is the sign of the force right?)");
  const Candidate* best = &all.front();
  bool beyond = false;
  const Candidate& lag = all.back();
  // A lag that leaves more than the noise stands for something else, such as a resonance above the lines.
  if (lag.held_out < kFarBetter * best->held_out && lag.excess < kMore && lag.half[3] < kKnownLag &&
      lag.fitted.p[2] > kLeastDelay)
    best = &lag;
  double put_aside = std::numeric_limits<double>::infinity();
  for (const Candidate& c : all) {
    if (!elastic(c.structure) || !(c.held_out < kFarBetter * best->held_out)) continue;
    if (!determined(c, data)) {
      beyond = beyond || c.held_out < kFarAway * all.front().held_out;
      put_aside = std::min(put_aside, c.held_out);
      continue;
    }
    best = &c;
  }
  // What fits much worse than one that was put aside has the wrong structure.
  if (elastic(best->structure) && put_aside < kFarAway * best->held_out) best = &all.front();
  PlantFit out = result_of(*best, data);
  if (!(out.mass.half_width < 0.5 * out.mass.value)) {
    throw Refused(fmt::format(
        "frequency response: the lines do not determine the mass ({} kg, 95 %: {} to {} kg): what moves the axis is too slow or too weak (record "
        "a multisine on strokes at constant speed: stribeck excite MACHINE.toml --method multisine)",
        digits(out.mass.value), digits(out.mass.low()), digits(out.mass.high())));
  }
  for (const Candidate& c : all) out.held_out.push_back(c.held_out);
  out.beyond = !elastic(best->structure) && (beyond || out.excess > kMore);
  out.reason = choice_in_words(*best, all.front(), data);
  return out;
}

}  // namespace stribeck::ident::frequency
