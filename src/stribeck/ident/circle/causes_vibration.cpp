#include <algorithm>
#include <cmath>
#include <complex>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>
#include <stribeck/ident/stats/linear.hpp>
#include <stribeck/ident/stats/order.hpp>

namespace stribeck::ident::circle {
namespace {

constexpr std::size_t kLongestSegment = 512;
constexpr std::size_t kShortestSegment = 128;
constexpr std::size_t kFewestPieces = 4;

/// A piece of the rest without its cubic trend, times Hann's window.
std::vector<double> tapered(const CircleRun& run, int log, std::size_t first, std::size_t segment,
                            const Explained& explained) {
  Eigen::MatrixXd X(static_cast<Eigen::Index>(segment), 4);
  Eigen::VectorXd y(X.rows());
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const double u = 2.0 * static_cast<double>(i) / static_cast<double>(segment - 1) - 1.0;
    X.row(i) << 1.0, u, u * u, u * u * u;
    const std::size_t row = first + static_cast<std::size_t>(i);
    y(i) = run.error[row] - explained.at(run, log, row);
  }
  y -= X * stats::least_squares(X, y).x;
  std::vector<double> out(segment);
  for (std::size_t i = 0; i < segment; ++i)
    out[i] = y(static_cast<Eigen::Index>(i)) *
             (1.0 - std::cos(2.0 * kPi * static_cast<double>(i) / static_cast<double>(segment)));
  return out;
}

/// Squared amplitudes of the lines 0 … n/2 − 1 of n values.
std::vector<double> lines_of(const std::vector<double>& v) {
  const std::size_t segment = v.size();
  std::vector<double> out(segment / 2);
  for (std::size_t line = 0; line < out.size(); ++line) {
    const std::complex<double> turn =
        std::polar(1.0, -2.0 * kPi * static_cast<double>(line) / static_cast<double>(segment));
    std::complex<double> at(1.0, 0.0);
    std::complex<double> sum;
    for (const double value : v) {
      sum += value * at;
      at *= turn;
    }
    out[line] = std::norm(2.0 / static_cast<double>(segment) * sum);
  }
  return out;
}

/// First rows of pieces that lie between two reversals, outside the window behind them.
std::vector<std::size_t> pieces_of(const CircleRun& run, double window, std::size_t segment) {
  std::vector<std::size_t> out;
  const double direction = run.counter_clockwise ? 1.0 : -1.0;
  const auto behind = [&](std::size_t i) {
    const double turned = direction * run.angle[i];
    return turned - 0.5 * kPi * std::floor(turned / (0.5 * kPi));
  };
  for (std::size_t i = 0; i + segment <= run.angle.size();) {
    const double from = behind(i);
    const double turned = direction * (run.angle[i + segment - 1] - run.angle[i]);
    if (from >= window && from + turned < 0.5 * kPi) {
      out.push_back(i);
      i += segment;
    } else {
      ++i;
    }
  }
  return out;
}

/// The longest pieces of which there are enough.
struct Pieces {
  std::size_t segment = 0;  ///< rows of each
  std::vector<std::size_t> first;
};

/// Without times, or with too few rows between the reversals: none.
Pieces pieces(const CircleRun& run, double window) {
  if (run.time.empty() || !(run.time.back() > run.time.front())) return {};
  for (std::size_t segment = kLongestSegment; segment >= kShortestSegment; segment /= 2) {
    std::vector<std::size_t> first = pieces_of(run, window, segment);
    if (first.size() >= kFewestPieces) return {segment, std::move(first)};
  }
  return {};
}

/// One axis alone: in the radius its amplitude goes with |cos θ| of x, |sin θ| of y. `powers` are squared amplitudes of the pieces.
void tell_axis(const CircleRun& run, const std::vector<std::size_t>& first, std::size_t segment,
               const std::vector<double>& powers, Vibration& v) {
  constexpr double kQuiet = 0.15;  // of the square of the other
  constexpr double kSure = 3.0;    // standard deviations
  const auto n = static_cast<Eigen::Index>(powers.size());
  Eigen::MatrixXd X(n, 2);
  Eigen::VectorXd y(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    // The power of a piece is weighted by the square of Hann's window.
    double x_part = 0.0;
    double y_part = 0.0;
    for (std::size_t i = 0; i < segment; ++i) {
      const double angle = run.angle[first[static_cast<std::size_t>(k)] + i];
      const double window = 1.0 - std::cos(2.0 * kPi * static_cast<double>(i) / static_cast<double>(segment));
      const double weight = window * window / (1.5 * static_cast<double>(segment));
      x_part += weight * std::pow(std::cos(angle), 2);
      y_part += weight * std::pow(std::sin(angle), 2);
    }
    X.row(k) << x_part, y_part;
    y(k) = powers[static_cast<std::size_t>(k)];
  }
  const double xx = X.col(0).squaredNorm(), xy = X.col(0).dot(X.col(1)), yy = X.col(1).squaredNorm();
  const double determinant = xx * yy - xy * xy;
  if (n < 4 || !(determinant > 1e-6 * (xx + yy) * (xx + yy))) return;
  const double f_x = X.col(0).dot(y), f_y = X.col(1).dot(y);
  const Eigen::Vector2d square((yy * f_x - xy * f_y) / determinant, (xx * f_y - xy * f_x) / determinant);
  const double variance = (y - X * square).squaredNorm() / static_cast<double>(n - 2);
  const int axis = square(0) >= square(1) ? 0 : 1;
  const double own = square(axis), other = square(1 - axis);
  const double deviation = std::sqrt(variance * (xx + yy + 2.0 * xy) / determinant);  // of their difference
  if (!(own > 0.0) || !(other < kQuiet * own) || !(own - other > kSure * deviation)) return;
  // The other one does not vibrate: this one alone.
  const double alone = X.col(axis).dot(y) / X.col(axis).squaredNorm();
  const double rest = (y - alone * X.col(axis)).squaredNorm() / static_cast<double>(n - 1);
  v.axis = axis;
  v.amplitude = std::sqrt(alone);
  v.half_width = 1.96 * std::sqrt(rest / X.col(axis).squaredNorm()) / (2.0 * v.amplitude);
}

/// Squared amplitudes of the lines of the pieces of one run.
struct Spectrum {
  std::size_t segment = 0;
  std::vector<std::size_t> first;            ///< row of each piece
  std::vector<std::vector<double>> squares;  ///< of each piece
  std::vector<double> mean;
  double floor = 0.0;  ///< median of the lines that count
};

constexpr std::size_t kLowest = 5;  // slower lines belong to the form of the circle

Spectrum spectrum_of(const CircleRun& run, int log, double window, const Explained& explained) {
  constexpr std::size_t kMostPieces = 48;
  Spectrum out;
  const auto [segment, all] = pieces(run, window);
  out.segment = segment;
  const std::size_t skip = (all.size() + kMostPieces - 1) / kMostPieces;
  for (std::size_t k = 0; k < all.size(); k += skip) {
    out.first.push_back(all[k]);
    out.squares.push_back(lines_of(tapered(run, log, all[k], segment, explained)));
  }
  if (all.empty()) return out;
  out.mean.assign(segment / 2, 0.0);
  for (const auto& one : out.squares) {
    for (std::size_t line = 0; line < out.mean.size(); ++line)
      out.mean[line] += one[line] / static_cast<double>(out.squares.size());
  }
  out.floor = stats::median(std::vector<double>(out.mean.begin() + kLowest, out.mean.end()));
  return out;
}

Vibration vibration_at(const CircleRun& run, const Spectrum& s, std::size_t line) {
  // A line between two places of the grid shows on both; Hann's window spreads it over neighbours, their sum holds 3/2 of it.
  const auto power = [&](const std::vector<double>& v) {
    double sum = 0.0;
    for (std::size_t k = line - 2; k <= std::min(line + 2, v.size() - 1); ++k)
      sum += std::max(0.0, v[k] - s.floor);
    return sum / 1.5;
  };
  double scatter = 0.0;
  const double middle = power(s.mean);
  for (const auto& one : s.squares) scatter += (power(one) - middle) * (power(one) - middle);
  const double pieces_used = static_cast<double>(s.squares.size());
  Vibration v;
  v.amplitude = v.in_radius = std::sqrt(middle);
  v.half_width = 1.96 * std::sqrt(scatter / (pieces_used * (pieces_used - 1.0))) / (2.0 * v.amplitude);
  // Between two lines Hann's window gives them amplitudes in the ratio (1 + δ)/(2 − δ), δ from the larger one.
  const auto between = [&](const std::vector<double>& of) {
    const bool above = line + 1 < of.size() && of[line + 1] > of[line - 1];
    const double next = std::max(0.0, of[above ? line + 1 : line - 1] - s.floor);
    const double ratio = std::sqrt(next / std::max(of[line] - s.floor, 1e-300));
    const double offset = std::clamp((2.0 * ratio - 1.0) / (ratio + 1.0), 0.0, 0.5);
    return above ? offset : -offset;
  };
  const double per_line = static_cast<double>(run.time.size() - 1) / static_cast<double>(s.segment) /
                          (run.time.back() - run.time.front());
  const double offset = between(s.mean);
  double strays = 0.0;
  for (const auto& one : s.squares) strays += (between(one) - offset) * (between(one) - offset);
  v.frequency = (static_cast<double>(line) + offset) * per_line;
  std::vector<double> powers;
  for (const auto& one : s.squares) powers.push_back(power(one));
  tell_axis(run, s.first, s.segment, powers, v);
  v.frequency_half_width = 1.96 * per_line * std::sqrt(strays / (pieces_used * (pieces_used - 1.0)));
  return v;
}

/// The lines of one run that stand out, the strongest first.
std::vector<Vibration> vibrations_of(const CircleRun& run, int log, double window,
                                     const Explained& explained) {
  // The largest of 250 lines of noise in a mean of eight pieces is three times the median; fewer pieces, more.
  constexpr double kClear = 12.0;
  constexpr std::size_t kMost = 3;
  constexpr std::size_t kApart = 5;        // lines that belong to one vibration on either side
  constexpr double kBesideAnother = 1e-3;  // of its square: the borders of Hann's window and of the pieces
  const Spectrum s = spectrum_of(run, log, window, explained);
  std::vector<Vibration> out;
  if (s.squares.empty()) return out;
  std::vector<double> left = s.mean;
  std::fill(left.begin(), left.begin() + kLowest, 0.0);
  double most = 0.0;
  while (out.size() < kMost) {
    const auto line = static_cast<std::size_t>(std::max_element(left.begin(), left.end()) - left.begin());
    most = std::max(most, left[line]);
    if (!(left[line] > kClear * s.floor) || left[line] < kBesideAnother * most || line == kLowest) break;
    out.push_back(vibration_at(run, s, line));
    // A vibration whose frequency changes is broad.
    const std::size_t apart = std::max(kApart, line / 5);
    for (std::size_t k = line - std::min(line, apart); k <= std::min(line + apart, left.size() - 1); ++k)
      left[k] = 0.0;
  }
  return out;
}

}  // namespace

bool tells_vibration(const std::vector<CircleMotion>& motions, double window) {
  return std::any_of(motions.begin(), motions.end(), [&](const CircleMotion& m) {
    return std::any_of(m.runs.begin(), m.runs.end(),
                       [&](const CircleRun& run) { return !pieces(run, window).first.empty(); });
  });
}

std::vector<Vibration> find_vibrations(const std::vector<CircleMotion>& motions, const CauseRows& rows,
                                       const Design& design, const CauseFit& fit) {
  const Explained explained(rows, design, fit);
  std::vector<Vibration> best;
  int log = 0;
  for (const CircleMotion& m : motions) {
    for (const CircleRun& run : m.runs) {
      std::vector<Vibration> found = vibrations_of(run, log, fit.window(), explained);
      if (!found.empty() && (best.empty() || found.front().in_radius > best.front().in_radius))
        best = std::move(found);
    }
    ++log;
  }
  return best;
}

}  // namespace stribeck::ident::circle
