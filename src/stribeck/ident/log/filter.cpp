#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/log/filter.hpp>
#include <stribeck/ident/stats/linear.hpp>

namespace stribeck::ident::log {
namespace {

using Complex = std::complex<double>;

void check(int order, double edge) {
  if (order < 1) throw std::invalid_argument("filter order must be at least 1");
  if (!(edge > 0.0 && edge < 1.0))
    throw std::invalid_argument("filter edge must lie between 0 and 1 (Nyquist)");
}

/// Coefficients of Π(z − root), highest power first.
std::vector<double> polynomial(const std::vector<Complex>& roots) {
  std::vector<Complex> c{1.0};
  for (const Complex& root : roots) {
    c.push_back(0.0);
    for (std::size_t i = c.size() - 1; i > 0; --i) c[i] -= root * c[i - 1];
  }
  std::vector<double> real(c.size());
  std::transform(c.begin(), c.end(), real.begin(), [](const Complex& z) { return z.real(); });
  return real;
}

/// Low-pass of cut-off 1, given by its poles and its gain at frequency zero, moved to the edge and made
/// discrete.
Filter discrete(std::vector<Complex> poles, double gain_at_zero, double edge) {
  const double warped = 2.0 * std::tan(kPi * edge / 2.0);
  for (Complex& p : poles) {
    const Complex s = warped * p;
    p = (2.0 + s) / (2.0 - s);
  }
  Filter f;
  f.a = polynomial(poles);
  f.b = polynomial(std::vector<Complex>(poles.size(), Complex(-1.0)));
  // Gain at z = 1 from the poles themselves, because the sum of the coefficients cancels for low edges.
  Complex denominator = 1.0;
  for (const Complex& p : poles) denominator *= 1.0 - p;
  const double scale = gain_at_zero * denominator.real() / std::pow(2.0, static_cast<double>(poles.size()));
  for (double& c : f.b) c *= scale;
  return f;
}

/// State of the transposed direct form II after a constant input of 1.
std::vector<double> steady_state(const Filter& f) {
  const auto n = static_cast<Eigen::Index>(f.a.size() - 1);
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd rhs(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    m(i, 0) += f.a[static_cast<std::size_t>(i) + 1];
    if (i + 1 < n) m(i, i + 1) -= 1.0;
    rhs(i) = f.b[static_cast<std::size_t>(i) + 1] - f.a[static_cast<std::size_t>(i) + 1] * f.b[0];
  }
  const Eigen::VectorXd z = stats::solve_lu(m, rhs);
  return {z.data(), z.data() + n};
}

void run(const Filter& f, const std::vector<double>& rest, std::vector<double>& x) {
  std::vector<double> z(rest.size());
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = rest[i] * x.front();
  const std::size_t n = z.size();
  for (double& value : x) {
    const double in = value;
    const double out = f.b[0] * in + z[0];
    for (std::size_t i = 0; i + 1 < n; ++i) z[i] = f.b[i + 1] * in + z[i + 1] - f.a[i + 1] * out;
    z[n - 1] = f.b[n] * in - f.a[n] * out;
    value = out;
  }
}

}  // namespace

Filter butterworth(int order, double edge) {
  check(order, edge);
  std::vector<Complex> poles;
  for (int k = 0; k < order; ++k) {
    poles.push_back(std::polar(1.0, kPi * (2.0 * k + order + 1.0) / (2.0 * order)));
  }
  return discrete(std::move(poles), 1.0, edge);
}

Filter chebyshev_1(int order, double ripple_db, double edge) {
  check(order, edge);
  if (!(ripple_db > 0.0)) throw std::invalid_argument("filter ripple must be positive");
  const double epsilon = std::sqrt(std::pow(10.0, ripple_db / 10.0) - 1.0);
  const double mu = std::asinh(1.0 / epsilon) / order;
  std::vector<Complex> poles;
  for (int k = 0; k < order; ++k) {
    const double theta = kPi * (2.0 * k + 1.0) / (2.0 * order);
    poles.emplace_back(-std::sinh(mu) * std::sin(theta), std::cosh(mu) * std::cos(theta));
  }
  // With an even order, the gain at frequency zero is the lower limit of the ripple.
  const double gain = order % 2 == 0 ? 1.0 / std::sqrt(1.0 + epsilon * epsilon) : 1.0;
  return discrete(std::move(poles), gain, edge);
}

std::vector<double> forward_backward(const Filter& filter, const std::vector<double>& x) {
  const std::size_t extension = 3 * (filter.a.size() - 1);
  if (x.size() <= extension)
    throw std::invalid_argument("signal is too short for forward-backward filtering");
  std::vector<double> y;
  y.reserve(x.size() + 2 * extension);
  for (std::size_t i = extension; i > 0; --i) y.push_back(2.0 * x.front() - x[i]);
  y.insert(y.end(), x.begin(), x.end());
  for (std::size_t i = 1; i <= extension; ++i) y.push_back(2.0 * x.back() - x[x.size() - 1 - i]);
  const std::vector<double> rest = steady_state(filter);
  for (int pass = 0; pass < 2; ++pass) {
    run(filter, rest, y);
    std::reverse(y.begin(), y.end());
  }
  const auto first = y.begin() + static_cast<std::ptrdiff_t>(extension);
  return {first, first + static_cast<std::ptrdiff_t>(x.size())};
}

namespace {
constexpr std::size_t kLargestStep = 13;  // of a decimation
constexpr double kRipple = 0.05;          // of its filter, in one direction [dB]
}  // namespace

std::size_t decimation_up_to(std::size_t most) {
  for (std::size_t factor = most; factor > kLargestStep; --factor) {
    std::size_t rest = factor;
    for (std::size_t step = kLargestStep; step > 1; --step) {
      while (rest % step == 0) rest /= step;
    }
    if (rest == 1) return factor;
  }
  return most;
}

std::vector<double> decimate(const std::vector<double>& x, std::size_t factor) {
  if (factor == 0) throw std::invalid_argument("decimation factor must be at least 1");
  if (factor == 1) return x;
  // A filter of order 8 far below the rate loses all its digits: a large factor is taken in steps.
  for (std::size_t step = kLargestStep; factor > kLargestStep && step > 1; --step) {
    if (factor % step != 0) continue;
    std::vector<double> part = decimate(x, step);
    // What is constant loses its share once, as in one step.
    for (double& y : part) y *= std::pow(10.0, 2.0 * kRipple / 20.0);
    return decimate(part, factor / step);
  }
  const std::vector<double> smooth =
      forward_backward(chebyshev_1(8, kRipple, 0.8 / static_cast<double>(factor)), x);
  std::vector<double> y;
  for (std::size_t k = (x.size() - 1) % factor; k < x.size(); k += factor) y.push_back(smooth[k]);
  return y;
}

std::vector<double> box_weights(int j) {
  std::vector<double> k{1.0};
  const auto width = static_cast<std::size_t>(2 * j + 1);
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> next(k.size() + width - 1, 0.0);
    for (std::size_t i = 0; i < k.size(); ++i) {
      for (std::size_t b = 0; b < width; ++b) next[i + b] += k[i] / static_cast<double>(width);
    }
    k = std::move(next);
  }
  return k;
}

double second_difference_variance(const std::vector<double>& weights) {
  std::vector<double> k = weights;
  k.insert(k.begin(), 2, 0.0);
  k.insert(k.end(), 2, 0.0);
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < k.size(); ++i) {
    const double d = k[i - 1] - 2.0 * k[i] + k[i + 1];
    sum += d * d;
  }
  return sum;
}

}  // namespace stribeck::ident::log
