#pragma once
/// A virtual drive for the tests of this folder: rigid axis, LuGre over Table 2.3, encoder, D/A, force noise.
///
///   m·a = f − F(z, v) − d        d: first-order noise, held over a sample, positive against the motion to +x
///
/// It has its own equations and its own integrator (classical Runge–Kutta): an identification must not be judged with the code
/// that it uses. Included by tests only.

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <stribeck/core/scalar.hpp>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/ident/log/record.hpp>

namespace stribeck::ident::test {

using friction::Gaussian;

struct Drive {
  double mass = 57.65e3;
  Gaussian<double> friction;
  double sigma0 = 3e8;
  double sigma1 = 6e5;
  double damping_velocity = 0.05e-3;
  double wave = 0.0;         ///< force periodic in position [N]
  double wave_length = 1.0;  ///< [m]
  double sample_time = 0.005;
  double encoder = 25e-9;
  double noise_rms = 20.0;
  double noise_time = 0.047;
  double force_per_volt = 1048.0;
  double volts = 10.0;
  double bits = 16.0;

  /// Level of friction of the bristle, by branch [N].
  [[nodiscard]] double level(double v, bool forward) const {
    const auto& branch = forward ? friction.positive : friction.negative;
    const double edge = forward ? friction.velocity_range[1] : friction.velocity_range[0];
    const double at = std::abs(v) > std::abs(edge) ? edge : v;
    double sum = branch.eta0;
    for (const auto& g : branch.gaussians) sum += g.a * std::exp(-std::pow((at - g.b) / g.c, 2.0));
    return std::abs(sum);
  }
  [[nodiscard]] double steady(double v) const {
    return (v >= 0 ? 1.0 : -1.0) * level(v, v >= 0) +
           (v >= 0 ? friction.positive : friction.negative).eta1 * v;
  }
};

/// Table 2.3, SI.
inline Gaussian<double> table_2_3(char axis) {
  const double mm = 1e-3;
  auto branch = [&](double eta0, double eta1, std::initializer_list<std::array<double, 3>> terms) {
    friction::GaussianBranch<double> b;
    b.eta0 = eta0;
    b.eta1 = eta1 / mm;
    for (const auto& t : terms) b.gaussians.push_back({t[0], t[1] * mm, t[2] * mm});
    return b;
  };
  Gaussian<double> g;
  g.velocity_range = {-9.5 * mm, 9.5 * mm};
  if (axis == 'x') {
    g.positive =
        branch(768.6, 102.48, {{517.4, 1.763, 3.091}, {509.3, 5.806, 1.825}, {1995.9, 10.668, 1.876}});
    g.negative =
        branch(-768.6, 102.48, {{-378.2, -2.163, 2.265}, {-547.5, -5.912, 1.761}, {-4472, -13.99, 3.659}});
  } else {
    g.positive =
        branch(640.5, 140.91, {{518.0, 1.766, 1.986}, {852.0, 5.872, 2.733}, {1059.1, 10.27, 1.744}});
    g.negative =
        branch(-640.5, 140.91, {{-371.34, -1.963, 2.997}, {-236.1, -5.804, 1.223}, {-354.97, -9.311, 0.475}});
  }
  return g;
}

struct Truth {
  std::vector<double> v, a, friction;  ///< at the ticks
};

/// One run. command(k, t, x measured) returns the force [N] that is commanded at tick k.
inline log::Record run(const Drive& drive, double duration, std::uint64_t seed,
                       const std::function<double(std::size_t, double, double)>& command,
                       Truth* truth = nullptr) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  const double T = drive.sample_time;
  const double rho = drive.noise_time > 0 ? std::exp(-T / drive.noise_time) : 0.0;
  double d = drive.noise_rms * normal(engine);
  double s[3] = {0, 0, 0};  // x, v, z
  log::Record rec;
  rec.source = "virtual drive";
  rec.sample_time = T;
  const auto rows = static_cast<std::size_t>(std::llround(duration / T));
  const double lsb = drive.bits > 0 ? 2.0 * drive.volts / std::pow(2.0, drive.bits) : 0.0;
  constexpr int kSub = 16;  // stable to σ0·v/g = 8900 1/s
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = T * static_cast<double>(k);
    const double x = drive.encoder > 0 ? drive.encoder * std::round(s[0] / drive.encoder) : s[0];
    double volts = std::clamp(command(k, t, x) / drive.force_per_volt, -drive.volts, drive.volts);
    if (lsb > 0) volts = lsb * std::round(volts / lsb);
    const double f = volts * drive.force_per_volt;
    rec.t.push_back(t);
    rec.x.push_back(x);
    rec.f.push_back(f);
    auto friction = [&](const double* y, double& rate) {
      const double g = drive.level(y[1], y[1] >= 0);
      rate = y[1] - drive.sigma0 * std::abs(y[1]) / g * y[2];
      const double damping = drive.sigma1 * std::exp(-std::pow(y[1] / drive.damping_velocity, 2.0));
      const double wave = drive.wave * std::sin(2.0 * kPi * y[0] / drive.wave_length - 0.7);
      return wave + drive.sigma0 * y[2] + damping * rate +
             (y[1] >= 0 ? drive.friction.positive : drive.friction.negative).eta1 * y[1];
    };
    auto slope = [&](const double* y, double* out) {
      double rate = 0;
      const double force = friction(y, rate);
      out[0] = y[1];
      out[1] = (f - force - d) / drive.mass;
      out[2] = rate;
    };
    if (truth != nullptr) {
      double rate = 0;
      const double force = friction(s, rate);
      truth->v.push_back(s[1]);
      truth->a.push_back((f - force - d) / drive.mass);
      truth->friction.push_back(force);
    }
    const double h = T / kSub;
    for (int i = 0; i < kSub; ++i) {
      double k1[3], k2[3], k3[3], k4[3], y[3];
      slope(s, k1);
      for (int j = 0; j < 3; ++j) y[j] = s[j] + 0.5 * h * k1[j];
      slope(y, k2);
      for (int j = 0; j < 3; ++j) y[j] = s[j] + 0.5 * h * k2[j];
      slope(y, k3);
      for (int j = 0; j < 3; ++j) y[j] = s[j] + h * k3[j];
      slope(y, k4);
      for (int j = 0; j < 3; ++j) s[j] += h / 6.0 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
    d = rho * d + std::sqrt(1.0 - rho * rho) * drive.noise_rms * normal(engine);
  }
  return rec;
}

/// PD control of a reference with a disturbance observer, gains of thesis §2.4.3.
inline log::Record run_closed(const Drive& drive, double mass_model, const std::vector<double>& r,
                              std::uint64_t seed, Truth* truth = nullptr) {
  const double T = drive.sample_time;
  const double kp = 1600, kv = 80, kev = 40, ked = 400 * mass_model;
  double e_last = 0, x_last = 0, v_hat = 0, d_hat = 0;
  auto ref = [&](std::ptrdiff_t k) {
    return r[static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(k, 0, static_cast<std::ptrdiff_t>(r.size()) - 1))];
  };
  auto control = [&](std::size_t k, double, double x) {
    const auto i = static_cast<std::ptrdiff_t>(k);
    const double acc = (ref(i + 1) - 2 * ref(i) + ref(i - 1)) / (T * T);
    const double e = x - ref(i);
    const double v = k > 0 ? (x - x_last) / T : 0.0;
    const double f = mass_model * (acc - kv * (k > 0 ? (e - e_last) / T : 0.0) - kp * e) + d_hat;
    const double dv = (f - d_hat) / mass_model - kev * (v_hat - v);
    const double dd = ked * (v_hat - v);
    v_hat += T * dv;
    d_hat += T * dd;
    e_last = e;
    x_last = x;
    return f;
  };
  log::Record rec = run(drive, T * static_cast<double>(r.size()), seed, control, truth);
  rec.r = r;
  return rec;
}

/// r = −A + A·cos(w·t) with a run-in: the phase speeds up over one second, so that the motion starts from rest.
inline std::vector<double> sine_reference(double T, double amplitude, double w, double periods) {
  std::vector<double> r;
  const double end = periods * 2 * kPi / w + 0.5;
  for (double t = 0; t < end; t += T) {
    const double s = t < 1.0 ? t * t * t * (1.0 - 0.5 * t) : t - 0.5;  // ∫ 3t² − 2t³
    r.push_back(-amplitude + amplitude * std::cos(w * s));
  }
  return r;
}

}  // namespace stribeck::ident::test
