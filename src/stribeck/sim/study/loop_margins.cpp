#include <algorithm>
#include <cmath>
#include <memory>
#include <stribeck/sim/contour_run.hpp>
#include <stribeck/sim/study/held_drive.hpp>
#include <stribeck/sim/study/loop_margins.hpp>
#include <vector>

namespace stribeck::sim {
namespace {

/// Powers of two: sums of steps and of the small error are exact, and differences of runs contain no rounding.
constexpr double kStep = 0x1p-18;        ///< of the reference per period [m]
constexpr double kError = 0x1p-30;       ///< [m]
constexpr double kCircleRadius = 10e-3;  ///< radius of the circle whose parameter the law gets [m]
constexpr int kWarm = 64;                ///< periods until the effect of the start has decayed

/// Amplitude of the surface at which a switching part is replaced by a straight line [m/s].
constexpr double kSurface = 0.1e-3;

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

namespace {

/// Calls see(response, line, drives, period) for every different response that the law has along the axes.
template <std::size_t N, class See>
void for_each_response(const control::LawParams& law, const control::Setup<N>& setup,
                       const DeclaredModes<N>& modes, See see) {
  control::Setup<N> free = setup;
  free.force_limit = control::spread<N>({}, std::numeric_limits<double>::infinity());
  for (auto& c : free.compensation) {
    c.feedforward = control::Feedforward::kNone;  // depends on the reference alone
    c.adaptation.enabled = false;
  }
  auto drives = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<HeldDrive, N>{
        HeldDrive(free.compensation[I].model.mass, free.period, free.compensation[I].delay(), modes[I])...};
  }
  (std::make_index_sequence<N>());
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
    see(response, line, drives);
    seen.push_back(std::move(response));
  }
}

}  // namespace

template <std::size_t N>
LoopMargins loop_margins(const control::LawParams& law, const control::Setup<N>& setup,
                         const DeclaredModes<N>& modes) {
  LoopMargins m;
  m.stable = true;
  const double period = setup.period;
  for_each_response<N>(
      law, setup, modes, [&](const Response<N>& response, Line<N>& line, std::array<HeldDrive, N>& drives) {
        for (std::size_t i = 0; i < N; ++i) {
          judge([&](double omega) { return loop_at<N>(response, drives, i, omega, period); }, period, i, m);
        }
        m.stable = m.stable && line.dies_out(drives);
      });
  m.gain = std::min(m.gain_up, m.gain_down);
  if (!m.stable) {
    m.phase = -m.phase;
    m.gain = 1.0 / m.gain;
    m.delay = 0.0;
  }
  return m;
}

template <std::size_t N>
std::array<LoopResponse, N> loop_responses(const control::LawParams& law, const control::Setup<N>& setup,
                                           const DeclaredModes<N>& modes) {
  constexpr int kPerDecade = 60;
  constexpr int kPoints = 7 * kPerDecade / 2 + 1;  // three and a half decades
  const double period = setup.period;
  std::array<LoopResponse, N> worst;
  const auto see = [&](const Response<N>& response, Line<N>&, const std::array<HeldDrive, N>& drives) {
    for (std::size_t i = 0; i < N; ++i) {
      LoopResponse one;
      one.axis = i;
      for (int k = 1; k <= kPoints; ++k) {
        const double omega = kPi / period * std::pow(10.0, static_cast<double>(k - kPoints) / kPerDecade);
        one.omega.push_back(omega);
        one.loop.push_back(loop_at<N>(response, drives, i, omega, period));
        one.nearest = std::min(one.nearest, std::abs(1.0 + one.loop.back()));
      }
      if (one.nearest < worst[i].nearest) worst[i] = std::move(one);
    }
  };
  for_each_response<N>(law, setup, modes, see);
  return worst;
}

#define STRIBECK_INSTANTIATE(N)                                                             \
  template LoopMargins loop_margins<N>(const control::LawParams&, const control::Setup<N>&, \
                                       const DeclaredModes<N>&);                            \
  template std::array<LoopResponse, N> loop_responses<N>(const control::LawParams&,         \
                                                         const control::Setup<N>&, const DeclaredModes<N>&);
STRIBECK_INSTANTIATE(1)
STRIBECK_INSTANTIATE(2)
STRIBECK_INSTANTIATE(3)
STRIBECK_INSTANTIATE(5)
#undef STRIBECK_INSTANTIATE

}  // namespace stribeck::sim
