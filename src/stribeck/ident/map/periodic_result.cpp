#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/map/periodic_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/quantiles.hpp>

namespace stribeck::ident::map::periodic {
namespace {

/// Share of the residual of a term with a period too long to determine, from which it is reported.
constexpr double kSlow = 0.25;
/// Likelihood ratio e^5 between the two forms.
constexpr double kFormEvidence = 5.0;

/// Share of the residual that a single slow periodic term explains.
double explained(const Data& data, double f, Form form, std::size_t stride) {
  // Columns e, sin, cos less their means in each pass.
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (const Pass& p : data.passes) {
    double weight = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = p.first; i < p.last; i += stride) {
      const Group& g = data.groups[i];
      const double angle = 2.0 * kPi * f * (g.x - data.middle);
      const double sign = form == kReversing ? g.sign : 1.0;
      const Eigen::Vector3d b(g.e, sign * std::sin(angle), sign * std::cos(angle));
      weight += g.weight;
      sum += g.weight * b;
      gram += g.weight * b * b.transpose();
    }
    if (weight > 0.0) gram -= sum * sum.transpose() / weight;
  }
  const Eigen::Vector2d moment = gram.block<2, 1>(1, 0);
  const double taken = moment.dot(gram.block<2, 2>(1, 1).ldlt().solve(moment));
  return gram(0, 0) > 0.0 ? taken / gram(0, 0) : 0.0;
}

/// A periodic term longer than the longest period that explains much of the residual: a real one, or a drift.
void note_slow_term(const Data& data, PeriodicResult& result) {
  constexpr int kPeriods = 24;
  constexpr std::size_t kEnough = 5000;  // number of groups; enough because the periods are long
  const std::size_t stride = data.groups.size() / kEnough + 1;
  double best = 0.0;
  for (int k = 0; k < kPeriods; ++k) {
    const double f = (0.75 + (data.length / data.longest - 0.75) * k / kPeriods) / data.length;
    for (const Form form : {kSame, kReversing}) {
      if (form == kReversing && !data.both) continue;
      best = std::max(best, explained(data, f, form, stride));
    }
  }
  if (!(best > kSlow)) return;
  result.cannot_tell.push_back(
      fmt::format("periodic terms of more than {}, which do not fit three times into {} of "
                  "travel: a slow change with the position is {:.0f} % of the residual; move farther",
                  data.shown.length(data.longest), data.shown.length(data.length), 100.0 * best));
}

void note_one_direction(PeriodicResult& result) {
  result.cannot_tell.emplace_back(
      "periodic terms: whether they reverse with the direction cannot be told: one direction only");
}

/// Power that a term removes from a residual in one of the forms.
double power_of(const Data& data, const Line& line, Form form, const VectorXd& e) {
  Line other = line;
  other.form = form;
  MatrixXd B(e.size(), 3);
  columns(data, other, B, false);
  const Eigen::Matrix2d gram = B.leftCols(2).transpose() * B.leftCols(2);
  const Eigen::Vector2d moment = B.leftCols(2).transpose() * e;
  return moment.dot(gram.ldlt().solve(moment));
}

/// Term number j with its intervals; C is the unscaled covariance of a, b and f, X has the columns of all terms.
PeriodicTerm term_of(const Data& data, const FrequencyGrid& grid, const Residual& left, const Line& line,
                     const Eigen::Matrix3d& C, const MatrixXd& X, Index j, PeriodicResult& result) {
  PeriodicTerm t;
  const double A = std::hypot(line.a, line.b);
  const double psi = std::atan2(line.b, line.a);
  t.term.amplitude = A;
  t.term.period = 1.0 / line.f;
  t.term.phase = std::remainder(2.0 * kPi * line.f * data.middle - psi, 2.0 * kPi);
  t.term.form =
      line.form == kSame ? friction::EccentricForm::kAdditive : friction::EccentricForm::kProportional;
  const auto background = local(data, grid, left, line, line.form);
  const double noise = background.first;
  const double factor = stats::student_factor(std::min(1e4, 2.0 * background.second));
  const auto half = [&](const Eigen::Vector3d& g) {
    return factor * std::sqrt(0.5 * noise * std::max(0.0, g.dot(C * g)));
  };
  const double amplitude = half({line.a / A, line.b / A, 0.0});
  const double frequency = half({0.0, 0.0, 1.0});
  const double phase = half({line.b / (A * A), -line.a / (A * A), 2.0 * kPi * data.middle});
  t.amplitude = {A - amplitude, A + amplitude};
  t.period = {t.term.period * (1.0 - frequency / line.f), t.term.period * (1.0 + frequency / line.f)};
  t.phase = {t.term.phase - phase, t.term.phase + phase};

  // Both forms are compared on the residual to which this term is added back.
  const VectorXd own = X.col(3 * j) * line.a + X.col(3 * j + 1) * line.b;
  const VectorXd e = left.e + own;
  const Form opposite = line.form == kSame ? kReversing : kSame;
  const double power = power_of(data, line, line.form, e);
  t.share = std::clamp(power / data.total, 0.0, 1.0);
  t.signal_to_background = std::sqrt(power / noise);
  if (data.both) {
    const double other = power_of(data, line, opposite, e);
    const double level = std::max(noise, local(data, grid, left, line, opposite).first);
    t.form_told = power - other > kFormEvidence * level;
    if (!t.form_told) {
      result.cannot_tell.push_back(fmt::format(
          "periodic terms: the data do not tell whether the term of period {:g} reverses with the direction",
          t.term.period));
    }
  } else {
    // At standstill there is no direction with which it could reverse.
    t.form_told = data.standstill;
  }
  return t;
}

/// Assigns each term to the longest period of which it is a harmonic.
void number_harmonics(const Data& data, double turn, PeriodicResult& result) {
  for (PeriodicTerm& t : result.terms) {
    double longest = t.term.period;
    for (const PeriodicTerm& other : result.terms) {
      const double ratio = other.term.period / t.term.period;
      const double whole = std::round(ratio);
      const double tolerance = std::max(0.2 * other.term.period / data.length,
                                        (other.period.high - other.period.low) / other.term.period);
      if (other.term.period > longest && whole >= 2.0 && whole <= kHighestHarmonic &&
          std::abs(ratio / whole - 1.0) < tolerance) {
        longest = other.term.period;
        t.harmonic = static_cast<int>(whole);
      }
    }
    if (turn > 0.0) t.harmonic = static_cast<int>(std::lround(turn / t.term.period));
  }
}

}  // namespace

void write_spectrum(const FrequencyGrid& grid, const Residual& left, PeriodicResult& result) {
  constexpr int kLines = 400;
  const double ratio = static_cast<double>(grid.highest) / static_cast<double>(grid.lowest);
  std::vector<SpectrumLine> lines;
  std::size_t j = grid.lowest;
  for (int i = 1; i <= kLines && j <= grid.highest; ++i) {
    const double end = static_cast<double>(grid.lowest) * std::pow(ratio, static_cast<double>(i) / kLines);
    SpectrumLine line;
    for (; j <= grid.highest && static_cast<double>(j) <= end + 1e-9; ++j) {
      const double a = std::max(left.amplitude[kSame][j], left.amplitude[kReversing][j]);
      if (line.period == 0.0 || a > line.amplitude) line = {1.0 / (static_cast<double>(j) * grid.step), a};
    }
    if (line.period > 0.0) lines.push_back(line);
  }
  result.spectrum.assign(lines.rbegin(), lines.rend());
}

void report(const Data& data, const FrequencyGrid& grid, const Residual& left, const PeriodicOptions& options,
            const std::vector<Line>& found, PeriodicResult& result) {
  const auto n = static_cast<Index>(data.groups.size());
  const auto count = static_cast<Index>(found.size());
  MatrixXd X(n, 3 * count);
  for (Index j = 0; j < count; ++j)
    columns(data, found[static_cast<std::size_t>(j)], X.middleCols(3 * j, 3), true);
  MatrixXd gram = stats::gram(X);
  hold_exact(found, gram, 2, 3);
  const VectorXd scale = gram.diagonal().cwiseSqrt();
  const MatrixXd inverse = stats::inverse(scale.asDiagonal().inverse() * gram * scale.asDiagonal().inverse());
  for (Index j = 0; j < count; ++j) {
    const Line& line = found[static_cast<std::size_t>(j)];
    Eigen::Matrix3d C;
    for (Index p = 0; p < 3; ++p) {
      for (Index q = 0; q < 3; ++q) {
        C(p, q) = inverse(3 * j + p, 3 * j + q) / (scale(3 * j + p) * scale(3 * j + q));
      }
    }
    if (line.exact) C(2, 2) = 0.0;
    result.terms.push_back(term_of(data, grid, left, line, C, X, j, result));
  }
  std::stable_sort(result.terms.begin(), result.terms.end(),
                   [](const auto& a, const auto& b) { return a.term.amplitude > b.term.amplitude; });
  number_harmonics(data, options.turn, result);
  if (!data.both && !data.standstill) note_one_direction(result);
  bool mixed = false;
  for (const Line& a : found) {
    for (const Line& b : found) mixed |= a.form < b.form && std::abs(a.f - b.f) < 1.0 / data.length;
  }
  if (mixed) {
    result.notes.emplace_back(
        "periodic terms: one period has a part that keeps its sign and one that reverses with the "
        "direction; a delay between force and position looks the same");
  }
}

bool note_rejected(const Data& data, const FrequencyGrid& grid, const Residual& left,
                   const std::vector<Line>& found, const std::vector<double>& rejected,
                   PeriodicResult& result) {
  double most = 0.0;
  MatrixXd B(static_cast<Index>(data.groups.size()), 2);
  for (const Line& line : found) {
    columns(data, line, B, false);
    most = std::max(most, (line.a * B.col(0) + line.b * B.col(1)).squaredNorm());
  }
  double f = 0.0, amplitude = 0.0;
  for (const double other : rejected) {
    const auto j = std::min(grid.highest, static_cast<std::size_t>(std::lround(other / grid.step)));
    for (const Form form : {kSame, kReversing}) {
      if (left.power[form].empty() || !(left.power[form][j] > most)) continue;
      most = left.power[form][j], f = other, amplitude = left.amplitude[form][j];
    }
  }
  if (!(f > 0.0)) return false;
  result.cannot_tell.push_back(fmt::format(
      "whether a force of about {} repeats every {}: it is stronger in the residual than the periodic "
      "terms found, but the passes do not agree on it; add slow strokes at constant speed",
      data.shown.force(amplitude), data.shown.length(1.0 / f)));
  return true;
}

void report_none(const Data& data, PeriodicResult& result) {
  note_slow_term(data, result);
  if (!data.both && !data.standstill) note_one_direction(result);
}

}  // namespace stribeck::ident::map::periodic
