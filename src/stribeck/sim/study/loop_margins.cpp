#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <stribeck/sim/contour_run.hpp>
#include <stribeck/sim/study/loop_margins.hpp>
#include <vector>

namespace stribeck::sim {
namespace {

using Complex = std::complex<double>;

/// Powers of two: sums of steps and of the small error are exact, and differences of runs contain no rounding.
constexpr double kStep = 0x1p-18;        ///< of the reference per period [m]
constexpr double kError = 0x1p-30;       ///< [m]
constexpr double kCircleRadius = 10e-3;  ///< radius of the circle whose parameter the law gets [m]
constexpr int kWarm = 64;                ///< periods until the effect of the start has decayed

/// Amplitude of the surface at which a switching part is replaced by a straight line [m/s].
constexpr double kSurface = 0.1e-3;

// ---- the drive

/// States of a drive: position, velocity, and those of the table where there is a mode.
constexpr std::size_t kMostStates = 4;
using Matrix = Mat<double, kMostStates + 1>;

/// exp(a·t) from its series on a step that is short enough, then squared. Written by hand, as the elimination below: Eigen's exp()
/// alone takes 4 s to compile.
Matrix exponential(const Matrix& a, double t) {
  double size = 0.0;
  for (const auto& row : a.row) {
    for (const double x : row.c) size = std::max(size, std::abs(x * t));
  }
  int halvings = 0;
  while (std::ldexp(size, -halvings) > 0.1) ++halvings;
  const double h = std::ldexp(t, -halvings);
  Matrix sum;
  Matrix term;
  for (std::size_t i = 0; i <= kMostStates; ++i) sum[i][i] = term[i][i] = 1.0;
  for (int n = 1; n <= 12; ++n) {
    term = term * a;
    for (auto& row : term.row) row = (h / n) * row;
    for (std::size_t i = 0; i <= kMostStates; ++i) sum[i] = sum[i] + term[i];
  }
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum;
}

/// x(k+1) = A x(k) + b_new u(k−w) + b_old u(k−w−1); the encoder sees the drive side.
class HeldDrive {
 public:
  HeldDrive(double mass, double period, double delay, const std::optional<plant::AxialMode>& mode)
      : period_(period) {
    Matrix a;
    a[0][1] = 1.0;
    double driven = mass;
    if (mode) {
      states_ = 4;
      const double table = mode->table_share * mass;
      driven = mass - table;
      const double omega = 2.0 * kPi * mode->frequency;
      const double spring = table * omega * omega;
      const double damper = 2.0 * mode->damping_ratio * omega * table;
      a[1] = {{-spring / driven, -damper / driven, spring / driven, damper / driven, 0.0}};
      a[2][3] = 1.0;
      a[3] = {{spring / table, damper / table, -spring / table, -damper / table, 0.0}};
    }
    a[1][kMostStates] = 1.0 / driven;
    const double periods = delay / period;
    whole_ = static_cast<std::size_t>(periods);
    const double rest = periods - static_cast<double>(whole_);
    const Matrix all = exponential(a, period);
    const Matrix late = exponential(a, (1.0 - rest) * period);
    for (std::size_t i = 0; i < kMostStates; ++i) {
      for (std::size_t j = 0; j < kMostStates; ++j) a_[i][j] = all[i][j];
      new_[i] = late[i][kMostStates];
      old_[i] = all[i][kMostStates] - late[i][kMostStates];
    }
    past_.assign(whole_ + 2, 0.0);
  }

  /// Position for a unit force [m/N].
  [[nodiscard]] Complex at(double omega) const {
    const Complex z = std::polar(1.0, omega * period_);
    std::array<std::array<Complex, kMostStates + 1>, kMostStates> m{};
    for (std::size_t i = 0; i < states_; ++i) {
      for (std::size_t j = 0; j < states_; ++j) m[i][j] = (i == j ? z : 0.0) - a_[i][j];
      m[i][states_] = new_[i] + old_[i] / z;
    }
    // Gauss elimination with pivots, down to the first unknown, which is eliminated last.
    for (std::size_t c = states_; c-- > 0;) {
      std::size_t best = c;
      for (std::size_t r = 0; r < c; ++r) {
        if (std::abs(m[r][c]) > std::abs(m[best][c])) best = r;
      }
      std::swap(m[c], m[best]);
      for (std::size_t r = 0; r < c; ++r) {
        const Complex f = m[r][c] / m[c][c];
        for (std::size_t k = 0; k <= states_; ++k) m[r][k] -= f * m[c][k];
      }
    }
    return m[0][states_] / m[0][0] * std::polar(1.0, -omega * period_ * static_cast<double>(whole_));
  }

  void start(double position) {
    x_ = {};
    x_[0] = position;
    if (states_ > 2) x_[2] = position;
    std::fill(past_.begin(), past_.end(), 0.0);
  }
  void step(double force) {
    std::rotate(past_.begin(), past_.end() - 1, past_.end());
    past_[0] = force;
    std::array<double, kMostStates> next{};
    for (std::size_t i = 0; i < states_; ++i) {
      next[i] = new_[i] * past_[whole_] + old_[i] * past_[whole_ + 1];
      for (std::size_t j = 0; j < states_; ++j) next[i] += a_[i][j] * x_[j];
    }
    x_ = next;
  }
  [[nodiscard]] double position() const { return x_[0]; }

 private:
  double period_;
  std::size_t states_ = 2;
  std::size_t whole_ = 0;
  std::array<std::array<double, kMostStates>, kMostStates> a_{};
  std::array<double, kMostStates> new_{};
  std::array<double, kMostStates> old_{};
  std::array<double, kMostStates> x_{};
  std::vector<double> past_;
};

// ---- the law

/// Force of each axis after a short error of one axis.
template <std::size_t N>
using Answer = std::array<std::vector<double>, N>;

/// A law that moves along a straight line with the tangent along one axis.
template <std::size_t N>
class Line {
 public:
  using State = LawRunner<N>;

  Line(const State& at_rest, std::size_t tangent, double period) : period_(period), state_(at_rest.copy()) {
    for (std::size_t i = 0; i < N; ++i) {
      point_.frame[i] = {};
      point_.frame[i][(tangent + i) % N] = 1.0;
    }
    tangent_ = tangent;
    point_.velocity[tangent] = kStep / period;
    for (int k = 0; k < kWarm; ++k) step(*state_, {});
  }

  /// Forces for an error of position [m]; changes the state `s`.
  Vec<double, N> step(State& s, const Vec<double, N>& error) {
    point_.position[tangent_] = kStep * static_cast<double>(tick_);
    point_.phi = point_.position[tangent_] / kCircleRadius;
    ++tick_;
    return s.step(point_, point_.position + error);
  }
  /// Runs with and without error; returns the difference of the forces.
  Vec<double, N> difference(State& with, State& without, const Vec<double, N>& error) {
    const Vec<double, N> plain = step(without, {});
    --tick_;
    return step(with, error) - plain;
  }

  /// Responses to a unit error of axis j over one period, until they have settled.
  Answer<N> answer(std::size_t j) {
    const long begin = tick_;
    const auto with = state_->copy();
    const auto without = state_->copy();
    Answer<N> h;
    const auto ticks = std::clamp(static_cast<std::size_t>(kLongest / period_), std::size_t{500}, kMostTicks);
    double peak = 0.0;
    double recent = 0.0;
    for (std::size_t k = 0; k < ticks; ++k) {
      Vec<double, N> error{};
      if (k == 0) error[j] = kError;
      const Vec<double, N> f = difference(*with, *without, error);
      double bend = 0.0;
      for (std::size_t i = 0; i < N; ++i) {
        h[i].push_back(-f[i] / kError);
        if (k >= 2) bend = std::max(bend, std::abs(h[i][k] - 2.0 * h[i][k - 1] + h[i][k - 2]));
      }
      peak = std::max(peak, bend);
      recent = std::max(recent, bend);
      if ((k + 1) % kLook == 0) {
        if (k + 1 > kLook && recent <= kSettled * peak) break;
        recent = 0.0;
      }
    }
    tick_ = begin;
    return h;
  }

  /// Whether a small error decays with these drives.
  bool dies_out(std::array<HeldDrive, N>& drives) {
    constexpr int kWindow = 200;
    constexpr int kWindows = 100;
    const long begin = tick_;
    const auto with = state_->copy();
    const auto without = state_->copy();
    for (std::size_t i = 0; i < N; ++i) drives[i].start(kError * (1.0 + 0.25 * static_cast<double>(i)));
    double greatest = 0.0;
    double middle = 0.0;
    double worst = 0.0;
    for (int w = 0; w < kWindows; ++w) {
      worst = 0.0;
      for (int k = 0; k < kWindow; ++k) {
        Vec<double, N> error;
        for (std::size_t i = 0; i < N; ++i) error[i] = drives[i].position();
        const Vec<double, N> f = difference(*with, *without, error);
        for (std::size_t i = 0; i < N; ++i) {
          drives[i].step(f[i]);
          const double e = std::abs(error[i]);
          if (!(e <= worst)) worst = e;
        }
      }
      if (!(worst <= 1e3 * kError)) break;
      greatest = std::max(greatest, worst);
      if (w == kWindows / 2) middle = worst;
      if (worst < 1e-5 * greatest) break;
    }
    tick_ = begin;
    if (!(worst <= 1e3 * kError)) return false;
    return worst < 1e-5 * greatest || worst < 0.99 * middle;
  }

 private:
  static constexpr double kLongest = 20.0;  ///< [s]
  static constexpr std::size_t kMostTicks = 20000;
  static constexpr std::size_t kLook = 50;
  static constexpr double kSettled = 1e-9;

  double period_;
  std::size_t tangent_ = 0;
  long tick_ = 0;
  path::PathPoint<N> point_;
  std::unique_ptr<State> state_;
};

/// Differences of the responses until they have decayed: C(z) = taps(z)/(1 − z⁻¹)^integrators.
template <std::size_t N>
struct Response {
  std::array<Answer<N>, N> taps;  ///< [j][i]: force i for error j
  int integrators = 0;
  bool coupled = false;

  friend bool operator==(const Response&, const Response&) = default;

  /// Differences a response that has not decayed; returns false where two differences are not enough.
  bool settle() {
    for (; integrators <= 2; ++integrators) {
      double peak = 0.0;
      double tail = 0.0;
      for (const Answer<N>& a : taps) {
        for (const auto& h : a) {
          for (std::size_t k = 0; k < h.size(); ++k) {
            peak = std::max(peak, std::abs(h[k]));
            if (k + h.size() / 10 >= h.size()) tail = std::max(tail, std::abs(h[k]));
          }
        }
      }
      if (!std::isfinite(peak)) return false;
      if (tail <= 1e-6 * peak) {
        trim(peak);
        return true;
      }
      if (integrators == 2) return false;
      for (Answer<N>& a : taps) {
        for (auto& h : a) {
          for (std::size_t k = h.size(); k-- > 1;) h[k] -= h[k - 1];
        }
      }
    }
    return false;
  }

  [[nodiscard]] Complex at(std::size_t i, std::size_t j, double turn) const {
    const Complex back = std::polar(1.0, -turn);
    const auto& h = taps[j][i];
    Complex sum = 0.0;
    for (std::size_t k = h.size(); k-- > 0;) sum = sum * back + h[k];
    // 1 − z⁻¹, without cancellation at low frequencies.
    const Complex step = 2.0 * std::sin(0.5 * turn) * std::polar(1.0, 0.5 * (kPi - turn));
    for (int q = 0; q < integrators; ++q) sum /= step;
    return sum;
  }

 private:
  void trim(double peak) {
    for (std::size_t j = 0; j < N; ++j) {
      for (std::size_t i = 0; i < N; ++i) {
        auto& h = taps[j][i];
        while (!h.empty() && std::abs(h.back()) <= 1e-9 * peak) h.pop_back();
        if (i != j && !h.empty()) coupled = true;
      }
    }
  }
};

// ---- the loop

/// Loop i with the other loops closed.
template <std::size_t N>
Complex loop_at(const Response<N>& c, const std::array<HeldDrive, N>& drives, std::size_t i, double omega,
                double period) {
  const double turn = omega * period;
  if (!c.coupled) return c.at(i, i, turn) * drives[i].at(omega);
  // Row i of (I + L) x = e_i solved for x_i by eliminating the others.
  std::array<std::array<Complex, N>, N> m;
  for (std::size_t b = 0; b < N; ++b) {
    const Complex p = drives[b].at(omega);
    for (std::size_t a = 0; a < N; ++a) m[a][b] = (a == b ? 1.0 : 0.0) + c.at(a, b, turn) * p;
  }
  for (std::size_t k = 0; k < N; ++k) {
    if (k == i) continue;
    for (std::size_t r = 0; r < N; ++r) {
      if (r == k || (r < k && r != i)) continue;
      const Complex f = m[r][k] / m[k][k];
      for (std::size_t col = 0; col < N; ++col) m[r][col] -= f * m[k][col];
    }
  }
  return m[i][i] - 1.0;
}

/// Root of f, whose signs at a and b are opposite; logarithmic bisection.
template <class F>
double crossing(F f, double a, double b) {
  const bool sign = f(a) > 0.0;
  for (int k = 0; k < 48; ++k) {
    const double middle = std::sqrt(a * b);
    ((f(middle) > 0.0) == sign ? a : b) = middle;
  }
  return std::sqrt(a * b);
}

template <class Loop>
void judge(const Loop& loop, double period, std::size_t axis, LoopMargins& m) {
  constexpr int kPerDecade = 160;
  constexpr int kDecades = 4;
  const double highest = kPi / period;
  double last_omega = 0.0;
  Complex last;
  const auto gain_at = [&](double size) {
    if (size < 1.0) {
      m.gain_up = std::min(m.gain_up, 1.0 / size);
    } else {
      m.gain_down = std::min(m.gain_down, size);
    }
  };
  for (int k = 0; k <= kPerDecade * kDecades; ++k) {
    const double omega = highest * std::pow(10.0, static_cast<double>(k) / kPerDecade - kDecades);
    const Complex now = loop(omega);
    m.modulus = std::min(m.modulus, std::abs(1.0 + now));
    if (k > 0) {
      if ((std::abs(last) > 1.0) != (std::abs(now) > 1.0)) {
        const double at = crossing([&](double w) { return std::abs(loop(w)) - 1.0; }, last_omega, omega);
        const double angle = std::arg(-loop(at));  // angle from −1
        if (std::abs(angle) < m.phase) {
          m.phase = std::abs(angle);
          m.axis = axis;
        }
        m.delay = std::min(m.delay, (angle >= 0.0 ? angle : angle + 2.0 * kPi) / at);
        m.crossover = std::max(m.crossover, at);
      }
      // Crosses the negative real axis, not the positive one.
      if ((last.imag() > 0.0) != (now.imag() > 0.0) && k < kPerDecade * kDecades) {
        const double at = crossing([&](double w) { return loop(w).imag(); }, last_omega, omega);
        const Complex there = loop(at);
        if (there.real() < 0.0) gain_at(-there.real());
      }
    }
    last_omega = omega;
    last = now;
  }
  if (last.real() < -1e-9) gain_at(-last.real());  // at half the sampling frequency the value is real
}

}  // namespace

control::LawParams linear_part(const control::LawParams& law) {
  control::LawParams linear = law;
  if (auto* sliding = std::get_if<control::SlidingModeParams>(&linear)) {
    switch (sliding->switching) {
      case control::Switching::kSign:
        sliding->switching = control::Switching::kBoundaryLayer;
        sliding->boundary = kSurface * kPi / 4.0;
        break;
      case control::Switching::kSuperTwisting:
        throw Refused(
            "super-twisting has no linear part, so that its loop has no margins (choose another switching)");
      default:
        break;
    }
  }
  return linear;
}

template <std::size_t N>
LoopMargins loop_margins(const control::LawParams& law, const control::Setup<N>& setup,
                         const DeclaredModes<N>& modes) {
  control::Setup<N> free = setup;
  free.force_limit = control::spread<N>({}, std::numeric_limits<double>::infinity());
  for (auto& c : free.compensation) {
    c.feedforward = control::Feedforward::kNone;  // depends on the reference alone
    c.adaptation.enabled = false;
  }
  auto drives = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<HeldDrive, N>{
        HeldDrive(free.compensation[I].model.mass, free.period, free.compensation[I].delay, modes[I])...};
  }
  (std::make_index_sequence<N>());
  LoopMargins m;
  m.stable = true;
  const AnyController<N> controller = make_controller<N>(linear_part(law), free);
  std::vector<Response<N>> seen;
  for (std::size_t tangent = 0; tangent < N; ++tangent) {
    Line<N> line(*controller, tangent, free.period);
    Response<N> response;
    for (std::size_t j = 0; j < N; ++j) response.taps[j] = line.answer(j);
    if (!response.settle()) {
      throw Refused(
          "the response of the law to a small error neither decays nor becomes a straight line: it has no margins");
    }
    if (std::find(seen.begin(), seen.end(), response) != seen.end()) continue;
    for (std::size_t i = 0; i < N; ++i) {
      judge([&](double omega) { return loop_at<N>(response, drives, i, omega, free.period); }, free.period, i,
            m);
    }
    m.stable = m.stable && line.dies_out(drives);
    seen.push_back(std::move(response));
  }
  m.gain = std::min(m.gain_up, m.gain_down);
  if (!m.stable) {
    m.phase = -m.phase;
    m.gain = 1.0 / m.gain;
    m.delay = 0.0;
  }
  return m;
}

#define STRIBECK_INSTANTIATE(N)                                                             \
  template LoopMargins loop_margins<N>(const control::LawParams&, const control::Setup<N>&, \
                                       const DeclaredModes<N>&);
STRIBECK_INSTANTIATE(1)
STRIBECK_INSTANTIATE(2)
STRIBECK_INSTANTIATE(3)
STRIBECK_INSTANTIATE(5)
#undef STRIBECK_INSTANTIATE

}  // namespace stribeck::sim
