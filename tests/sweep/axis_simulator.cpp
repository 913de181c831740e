/// One axis of a random machine, simulated without a line of Stribeck: the truth on which `tools/sweep` judges it.
///
///   axis_simulator TRUTH REFERENCE.csv LOG.csv        the run, as a drive would log it
///   axis_simulator TRUTH --friction V…                friction and load at steady speeds [N], V in m/s
///
///   m·a = u − F − load − k·x      u force, held over a period, late by `delay` periods
///   With a second mass: it hangs on a spring, carries the load and a share of the friction; the encoder is on the first.
///   F = level(x, t)·bristles + viscous(v) + Σ A·sin(2π·x/λ − φ)·(1 or sgn v)
///   steady friction  s±(v) = c± + (b± − c±)·exp(−(|v|/w)^δ) + bump·exp(−((|v| − p)/q)²) + c2±·|v|^e
///
/// Bristles: LuGre (one, first order), or Maxwell slip: ten elements in parallel, each slips at its share of the level,
/// which is followed with a time constant (frictional lag) where one is given.
/// Integration: half-implicit steps of position and velocity, bristles exactly over a step with the velocity held; the
/// step is a fiftieth of the fastest period of mass and stiffness, at most 20 µs.
///
/// TRUTH holds one `key value…` on each line, in SI units. Missing keys are 0 unless said otherwise below.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Values = std::map<std::string, std::vector<double>>;

constexpr double kPi = 3.14159265358979323846;
constexpr int kElements = 10;

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "axis_simulator: %s\n", what.c_str());
  std::exit(2);
}

Values read_truth(const std::string& name) {
  std::ifstream in(name);
  if (!in) fail("cannot read " + name);
  Values values;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string key;
    if (!(words >> key)) continue;
    std::vector<double>& list = values[key];
    double value = 0.0;
    while (words >> value) list.push_back(value);
  }
  return values;
}

class Truth {
 public:
  explicit Truth(Values values) : values_(std::move(values)) {}
  double operator()(const std::string& key, double missing = 0.0, std::size_t i = 0) const {
    const auto found = values_.find(key);
    return found == values_.end() || found->second.size() <= i ? missing : found->second[i];
  }
  [[nodiscard]] const std::vector<double>& list(const std::string& key) const {
    static const std::vector<double> none;
    const auto found = values_.find(key);
    return found == values_.end() ? none : found->second;
  }

 private:
  Values values_;
};

/// Steady friction of one direction. `rest` is what the bristles carry, the remainder is viscous.
struct Branch {
  double coulomb, rise, stribeck_speed, exponent, bump, bump_at, bump_width, viscous, power;

  Branch(const Truth& truth, std::size_t side)
      : coulomb(truth("coulomb", 0, side)),
        rise(truth("static", coulomb, side) - coulomb),
        stribeck_speed(truth("stribeck_speed", 1e-3, side)),
        exponent(truth("stribeck_exponent", 1)),
        bump(truth("bump", 0, side)),
        bump_at(truth("bump_at", 1)),
        bump_width(truth("bump_width", 1)),
        viscous(truth("viscous", 0, side)),
        power(truth("viscous_power", 1)) {}

  [[nodiscard]] double rest(double speed) const {
    const double z = (speed - bump_at) / bump_width;
    return coulomb + rise * std::exp(-std::pow(speed / stribeck_speed, exponent)) + bump * std::exp(-z * z);
  }
  [[nodiscard]] double flow(double speed) const { return viscous * std::pow(speed, power); }
};

struct Bristles {
  bool maxwell;
  double sigma0, sigma1, damping_speed, lag;
  double z = 0.0;
  double level = -1.0;  ///< followed with the lag
  std::vector<double> element = std::vector<double>(kElements, 0.0);

  explicit Bristles(const Truth& truth)
      : maxwell(truth("maxwell") != 0.0),
        sigma0(truth("sigma0", 1e8)),
        sigma1(truth("sigma1")),
        damping_speed(truth("damping_speed", 1e-4)),
        lag(truth("lag")) {}

  /// Force over a step with v held; `g` is the level at this speed and place.
  double step(double v, double g, double dt) {
    const double r = v / damping_speed;
    const double damping = sigma1 * std::exp(-r * r);
    if (level < 0.0 || lag <= 0.0) {
      level = g;
    } else {
      level += (g - level) * (1.0 - std::exp(-dt / lag));
    }
    if (maxwell) {
      double force = 0.0, before = 0.0;
      for (int i = 0; i < kElements; ++i) {
        // Equal shares of the level; the first slips at a tenth of the deflection of the last.
        const double share = 1.0 / kElements;
        const double stiffness = 2.0 * sigma0 / (kElements + 1.0) * (kElements - i) / kElements;
        double& f = element[static_cast<std::size_t>(i)];
        before += f;
        f = std::clamp(f + stiffness * v * dt, -share * level, share * level);
        force += f;
      }
      // What slips is not damped: at a constant speed the friction is the level, as in LuGre.
      return force + damping * (force - before) / (sigma0 * dt);
    }
    // ż = v − σ0·|v|/g·z, exactly for v held.
    const double rate = sigma0 * std::abs(v) / level;
    const double before = z;
    if (rate * dt > 1e-12) {
      const double steady = v > 0 ? level / sigma0 : -level / sigma0;
      z = steady + (z - steady) * std::exp(-rate * dt);
    } else {
      z += v * dt;
    }
    return sigma0 * z + damping * (z - before) / dt;
  }
};

struct Friction {
  Branch positive, negative;
  Bristles bristles;
  std::vector<double>
      periodic;  ///< amplitude, period, phase, 1 where it reverses with the direction; repeated
  double slope, warming, warming_time, place, place_width, place_level, load;

  explicit Friction(const Truth& truth)
      : positive(truth, 0),
        negative(truth, 1),
        bristles(truth),
        periodic(truth.list("periodic")),
        slope(truth("level_slope")),
        warming(truth("warming")),
        warming_time(truth("warming_time", 100)),
        place(truth("tight_at")),
        place_width(truth("tight_width", 1)),
        place_level(truth("tight")),
        load(truth("load")) {}

  [[nodiscard]] double level(double x, double t) const {
    const double p = (x - place) / place_width;
    return 1.0 + slope * x - warming * (1.0 - std::exp(-t / warming_time)) + place_level * std::exp(-p * p);
  }
  /// Sum of the terms that reverse with the direction (1) or that keep their sign (0).
  [[nodiscard]] double of_place(double x, double reverses) const {
    double force = 0.0;
    for (std::size_t i = 0; i + 3 < periodic.size(); i += 4) {
      if (periodic[i + 3] == reverses)
        force += periodic[i] * std::sin(2.0 * kPi * x / periodic[i + 1] - periodic[i + 2]);
    }
    return force;
  }
  /// `v` at the beginning, `middle` in the middle of the step.
  double step(double x, double v, double middle, double t, double dt) {
    const Branch& branch = middle >= 0.0 ? positive : negative;
    const double speed = std::abs(middle);
    const double scale = level(x, t);
    // A term that reverses with the direction does so over the way of the bristles: the contact carries it too.
    const double rest = bristles.step(v, branch.rest(speed) * scale + of_place(x, 1.0), dt);
    const double viscous = (middle >= 0.0 ? 1.0 : -1.0) * branch.flow(speed) * scale;
    return rest + viscous + of_place(x, 0.0);
  }
  /// Friction and load at a speed that is held, mean over place, cold.
  [[nodiscard]] double steady(double v) const {
    const Branch& branch = v >= 0.0 ? positive : negative;
    const double f = branch.rest(std::abs(v)) + branch.flow(std::abs(v));
    return (v >= 0.0 ? f : -f) + load;
  }
};

struct Reference {
  std::vector<double> time, value;
  bool is_force = false;
};

/// A CSV of excite: t and r [mm], or t, u [V], f [N].
Reference read_reference(const std::string& name) {
  std::ifstream in(name);
  if (!in) fail("cannot read " + name);
  Reference reference;
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    if (line[0] == 't') {
      reference.is_force = line.find("f [N]") != std::string::npos;
      continue;
    }
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    std::vector<double> row;
    double cell = 0.0;
    while (cells >> cell) row.push_back(cell);
    if (row.size() < 2) fail(name + ": a row of fewer than two numbers");
    reference.time.push_back(row[0]);
    reference.value.push_back(reference.is_force ? row.back() : row[1] * 1e-3);
  }
  if (reference.time.size() < 2) fail(name + ": no rows");
  return reference;
}

/// The drive's own loop: PD on the position with the rate of the error, or P on position over PI on velocity.
class Loop {
 public:
  Loop(const Truth& truth, double period) : period_(period), cascade_(truth("cascade") != 0.0) {
    const double omega = truth("omega", 40.0);
    const double mass = truth("loop_mass", truth("mass"));
    kp_ = omega * omega * mass;
    kv_ = 2.0 * omega * mass;
    ki_ = cascade_ ? kv_ * omega / 2.0 : omega * kp_ / 4.0;
    limit_ = truth("force_limit", 1e12);
    feed_forward_ = truth("feed_forward") * mass;
  }
  double step(double r, double x) {
    const double error = r - x;
    const double reference_speed = (r - r_before_) / period_;
    const double speed = (x - x_before_) / period_;
    const double reference_acceleration = (reference_speed - reference_speed_before_) / period_;
    double force = 0.0;
    if (cascade_) {
      const double asked = kp_ / kv_ * error + reference_speed;
      const double missing = asked - speed;
      integral_ += ki_ * missing * period_;
      force = kv_ * missing + integral_ + feed_forward_ * reference_acceleration;
    } else {
      integral_ += ki_ * error * period_;
      force =
          kp_ * error + kv_ * (reference_speed - speed) + integral_ + feed_forward_ * reference_acceleration;
      reference_speed_before_ = reference_speed;
    }
    integral_ = std::clamp(integral_, -limit_, limit_);
    x_before_ = x;
    r_before_ = r;
    return std::clamp(force, -limit_, limit_);
  }
  void start(double r, double x, double holding) {
    integral_ = holding;
    r_before_ = r;
    x_before_ = x;
  }

 private:
  double period_;
  bool cascade_;
  double kp_, kv_, ki_, limit_, feed_forward_;
  double integral_ = 0.0, x_before_ = 0.0, r_before_ = 0.0, reference_speed_before_ = 0.0;
};

struct Row {
  double t, r, x, f;
};

/// The mechanics between two samples.
class Axis {
 public:
  Axis(const Truth& truth, double start)
      : friction_(truth),
        second_friction_(truth),
        mass_(truth("mass")),
        second_(truth("second_mass")),
        spring_(truth("spring")),
        position_(start),
        seen_(start),
        second_position_(position_) {
    const double mode = 2.0 * kPi * truth("mode_hz");
    const double reduced = second_ > 0.0 ? mass_ * second_ / (mass_ + second_) : mass_;
    coupling_ = second_ > 0.0 ? mode * mode * reduced : 0.0;
    coupling_damping_ = second_ > 0.0 ? 2.0 * truth("mode_damping", 0.05) * mode * reduced : 0.0;
    second_share_ = truth("second_friction_share", 0.33);
    const double stiffest = friction_.bristles.sigma0 * 2.0 / mass_ + (coupling_ > 0 ? mode * mode : 0.0);
    longest_step_ = std::min(2e-5, 2.0 * kPi / std::sqrt(stiffest) / 50.0);
  }
  void move(double force, double from, double duration) {
    const int steps = std::max(1, static_cast<int>(std::ceil(duration / longest_step_)));
    const double dt = duration / steps;
    for (int i = 0; i < steps; ++i) {
      const double t = from + i * dt;
      double between = 0.0;
      if (coupling_ > 0.0) {
        between =
            coupling_ * (second_position_ - position_) + coupling_damping_ * (second_velocity_ - velocity_);
        const double drag =
            second_share_ * second_friction_.step(second_position_, second_velocity_,
                                                  second_velocity_ + 0.5 * second_change_, t, dt);
        second_change_ = -(between + drag + friction_.load) / second_ * dt;
        second_velocity_ += second_change_;
        second_position_ += second_velocity_ * dt;
      }
      const double load = coupling_ > 0.0 ? 0.0 : friction_.load;
      const double share = coupling_ > 0.0 ? 1.0 - second_share_ : 1.0;
      const double opposing = share * friction_.step(position_, velocity_, velocity_ + 0.5 * change_, t, dt);
      change_ = (force + between - opposing - load - spring_ * position_) / mass_ * dt;
      velocity_ += change_;
      position_ += velocity_ * dt;
      seen_ += (velocity_ - 0.5 * change_) * dt;
    }
  }
  [[nodiscard]] double position() const { return seen_; }

 private:
  Friction friction_, second_friction_;
  double mass_, second_, spring_;
  double position_;  ///< half a step, up to 10 µs, ahead of the velocity, which keeps the energy
  double seen_;      ///< by the encoder, without that half step
  double second_position_;
  double coupling_ = 0.0, coupling_damping_ = 0.0, second_share_ = 0.0, longest_step_ = 2e-5;
  double velocity_ = 0.0, second_velocity_ = 0.0;
  double change_ = 0.0, second_change_ = 0.0;  ///< of the velocity in the step before
};

std::vector<Row> run(const Truth& truth, const Reference& reference) {
  const double period = truth("period", 1e-3);
  const double resolution = truth("resolution", 1e-9);
  const double noise = truth("noise");
  const double memory = truth("noise_time") > 0.0 ? std::exp(-period / truth("noise_time")) : 0.0;
  const double late = truth("delay") * period;
  std::mt19937_64 random(static_cast<std::uint64_t>(truth("seed", 1)));
  std::normal_distribution<double> normal;
  // A drive that holds its position was switched on before the log begins.
  Axis axis(truth, reference.is_force ? 0.0 : reference.value.front());
  Loop loop(truth, period);
  std::vector<Row> rows;
  std::deque<double> asked(static_cast<std::size_t>(late / period) + 2, truth("load"));  // newest first
  double disturbance = noise * normal(random);
  loop.start(reference.value.front(), axis.position(), truth("load"));
  const double whole = std::floor(late / period);
  const double fraction = late - whole * period;
  for (std::size_t k = 0; k < reference.value.size(); ++k) {
    const double t = static_cast<double>(k) * period;
    const double x = resolution * std::round(axis.position() / resolution);
    const double r = reference.value[k];
    const double force = reference.is_force ? r : loop.step(r, x);
    asked.push_front(force);
    asked.pop_back();
    rows.push_back({t, reference.is_force ? std::nan("") : r, x, force});
    disturbance = memory * disturbance + std::sqrt(1.0 - memory * memory) * noise * normal(random);
    const auto newest = static_cast<std::size_t>(whole);
    if (fraction > 0.0) axis.move(asked[newest + 1] + disturbance, t, fraction);
    axis.move(asked[newest] + disturbance, t + fraction, period - fraction);
    if (!(std::abs(axis.position()) < 1e3)) fail("the axis ran away");
  }
  return rows;
}

/// As a drive would write it; `dialect` chooses separators, names and units.
void write_log(const std::string& name, const std::vector<Row>& rows, const Truth& truth) {
  std::FILE* out = std::fopen(name.c_str(), "w");
  if (out == nullptr) fail("cannot write " + name);
  const int dialect = static_cast<int>(truth("dialect"));
  const bool no_reference = truth("no_reference") != 0.0 || std::isnan(rows.front().r);
  const char separator = dialect == 1 ? ';' : dialect == 2 ? '\t' : ',';
  const double position_scale = dialect == 3 ? 1.0 : 1e3;
  const char* position_unit = dialect == 3 ? "m" : "mm";
  std::fprintf(out, "t [s]%c", separator);
  if (!no_reference) std::fprintf(out, "r [%s]%c", position_unit, separator);
  std::fprintf(out, "x [%s]%cf [N]\n", position_unit, separator);
  for (const Row& row : rows) {
    char line[256];
    int n = std::snprintf(line, sizeof line, "%.9g%c", row.t, separator);
    if (!no_reference) {
      n += std::snprintf(line + n, sizeof line - static_cast<std::size_t>(n), "%.12g%c",
                         row.r * position_scale, separator);
    }
    std::snprintf(line + n, sizeof line - static_cast<std::size_t>(n), "%.12g%c%.9g\n",
                  row.x * position_scale, separator, row.f);
    if (dialect == 1) std::replace(line, line + sizeof line, '.', ',');
    std::fputs(line, out);
  }
  if (std::fclose(out) != 0) fail("cannot write " + name);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4)
    fail("usage: axis_simulator TRUTH REFERENCE.csv LOG.csv | axis_simulator TRUTH --friction V…");
  const Truth truth(read_truth(argv[1]));
  if (std::string(argv[2]) == "--friction") {
    const Friction friction(truth);
    for (int i = 3; i < argc; ++i) std::printf("%.17g\n", friction.steady(std::atof(argv[i])));
    return 0;
  }
  write_log(argv[3], run(truth, read_reference(argv[2])), truth);
  return 0;
}
