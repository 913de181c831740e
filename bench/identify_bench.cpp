/// Identification at the size of long logs. Everything is I1: x follows r = −20 + 20 cos 0.475 t mm at 500 Hz for a
/// million rows (151 periods) on the x axis of the biaxial table, friction without pre-sliding, force noise of 20 N with
/// a pole of 0.9 per row, x in steps of 25 nm, v its central difference.
///
///   Read             the log as CSV (t, r, x, v, a, f; about 60 MB) into memory, in SI
///   ReadAndIdentify  the same, then identify_drive: mass, all static models, choice, intervals; with pre_sliding 1 also
///                    LuGre and GMS from the reversals, as by default
///   FitI1            rows of velocity and friction to bins, three Gaussians for each direction with many starts,
///                    intervals of the curve under correlated noise
///   RandomStartsI1   100 sets of scattered starts (argument: starts of a set): how many end within 0.1 % of the least
///                    sum of squares of the rows
///   NelderMeadI1     the peer: NLopt's simplex on all rows, the same model, one start
///
/// Times are CPU times of one core. curve_error_N is the largest error over 0.1–9.4 mm/s, both directions.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <stribeck/friction/gaussian.hpp>
#include <stribeck/friction/test_maps.hpp>
#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/map/gaussian_fit.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <stribeck/ident/stats/simplex.hpp>
#include <stribeck/io/log/log.hpp>
#include <string>
#include <variant>
#include <vector>

namespace {

using namespace stribeck;

constexpr std::size_t kRows = 1'000'000;
constexpr double kPeriod = 0.002, kFrequency = 0.475;
constexpr double kSlowest = 0.1e-3, kFastest = 9.4e-3;  // [m/s] where curves are compared
constexpr int kTerms = 3;
constexpr double kMass = 57650.0;

const friction::Gaussian<double>& truth() {
  static const auto map = friction::test::table_2_3_x<double>();
  return map;
}

struct Signals {
  std::vector<double> t, r, x, v, a, f;  // SI
};

const Signals& signals() {
  static const Signals instance = [] {
    Signals s;
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    double noise = 20.0 * normal(engine);
    for (std::size_t k = 0; k < kRows; ++k) {
      const double t = kPeriod * static_cast<double>(k);
      const double phase = kFrequency * t,
                   held = phase + 0.5 * kFrequency * kPeriod;  // the force acts over a period
      s.t.push_back(t);
      s.r.push_back(-0.02 + 0.02 * std::cos(phase));
      s.x.push_back(25e-9 * std::round(s.r.back() / 25e-9));
      const double v = -0.02 * kFrequency * std::sin(held);
      const double a = -0.02 * kFrequency * kFrequency * std::cos(held);
      s.f.push_back(kMass * a + friction::steady_force(truth(), v) + noise);
      noise = 0.9 * noise + std::sqrt(1.0 - 0.81) * 20.0 * normal(engine);
    }
    s.v.assign(kRows, 0.0), s.a.assign(kRows, 0.0);
    for (std::size_t k = 1; k + 1 < kRows; ++k) {
      s.v[k] = (s.x[k + 1] - s.x[k - 1]) / (2.0 * kPeriod);
      s.a[k] = (s.x[k + 1] - 2.0 * s.x[k] + s.x[k - 1]) / (kPeriod * kPeriod);
    }
    return s;
  }();
  return instance;
}

// ---- the log --------------------------------------------------------------------------------------------------

class CsvFile {
 public:
  CsvFile()
      : path_(std::filesystem::temp_directory_path() / ("stribeck-i1-" + std::to_string(getpid()) + ".csv")) {
    const Signals& s = signals();
    std::FILE* out = std::fopen(path_.c_str(), "w");
    if (out == nullptr) throw std::runtime_error("cannot write " + path_.string());
    std::fputs("t [s],r [mm],x [mm],v [mm/s],a [mm/s2],f [N]\n", out);
    for (std::size_t k = 0; k < kRows; ++k) {
      std::fprintf(out, "%.3f,%.7f,%.6f,%.7f,%.5f,%.5f\n", s.t[k], 1e3 * s.r[k], 1e3 * s.x[k], 1e3 * s.v[k],
                   1e3 * s.a[k], s.f[k]);
    }
    std::fclose(out);
    bytes_ = static_cast<double>(std::filesystem::file_size(path_));
  }
  ~CsvFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;

  [[nodiscard]] double bytes() const { return bytes_; }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
  double bytes_ = 0.0;
};

const CsvFile& csv() {
  static const CsvFile file;
  return file;
}

void read(benchmark::State& state) {
  const CsvFile& file = csv();
  for (auto _ : state) benchmark::DoNotOptimize(io::read_log(file.path()).rows);
  state.counters["MB_per_s"] = benchmark::Counter(
      1e-6 * file.bytes() * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["MB"] = 1e-6 * file.bytes();
}

double curve_error(const friction::SteadyVariant& fitted) {
  double worst = 0.0;
  for (double speed = kSlowest; speed <= kFastest; speed += 0.05e-3) {
    for (const double v : {speed, -speed}) {
      const double f = std::visit([&](const auto& map) { return friction::steady_force(map, v); }, fitted);
      const double error = std::abs(f - friction::steady_force(truth(), v));
      if (!(error <= worst)) worst = error;
    }
  }
  return worst;
}

void read_and_identify(benchmark::State& state) {
  const CsvFile& file = csv();
  ident::Result result;
  for (auto _ : state) {
    const io::Log log = io::read_log(file.path());
    ident::log::Record record;
    record.source = "I1";
    record.t = io::in_si(log.at("t"), quantity("s", "ms"));
    record.r = io::in_si(log.at("r"), quantity("m", "mm"));
    record.x = io::in_si(log.at("x"), quantity("m", "mm"));
    record.v = io::in_si(log.at("v"), quantity("m/s", "mm/s"));
    record.f = io::in_si(log.at("f"), quantity("N", "N"));
    record.sample_time = io::check_time(record.t).sample_time;
    ident::drive::DriveFitOptions options;
    options.dynamics = state.range(0) != 0;
    result = ident::drive::identify_drive({record}, options);
  }
  state.counters["curve_error_N"] = curve_error(result.friction.steady);
  state.counters["mass_error_percent"] = 100.0 * (result.mass / kMass - 1.0);
  state.counters["models"] = static_cast<double>(result.models.size());
  state.SetLabel(result.model);
}

// ---- the fit alone --------------------------------------------------------------------------------------------

/// One direction in the sense of motion: speed and friction of every row of it, the mass taken off.
struct Direction {
  std::vector<double> speed, force;
  std::vector<std::size_t> at;  // row of the log
};

const std::array<Direction, 2>& directions() {
  static const std::array<Direction, 2> instance = [] {
    std::array<Direction, 2> out;
    const Signals& s = signals();
    for (std::size_t k = 1; k + 1 < kRows; ++k) {
      // The hold puts the force half a row later than v; rows whose sign the encoder does not tell are left out.
      const double v = 0.5 * (s.v[k] + s.v[k + 1]);
      if (std::abs(v) < 0.02e-3 || k + 2 >= kRows) continue;
      Direction& d = out[v > 0.0 ? 0 : 1];
      const double held = kFrequency * (s.t[k] + 0.5 * kPeriod);
      const double a = -0.02 * kFrequency * kFrequency * std::cos(held);
      d.speed.push_back(std::abs(v));
      d.force.push_back((v > 0.0 ? 1.0 : -1.0) * (s.f[k] - kMass * a));
      d.at.push_back(k);
    }
    return out;
  }();
  return instance;
}

constexpr int kBins = 160;

struct Binned {
  ident::map::Bins bins;
  double top = 0.0;     // [m/s]
  double within = 0.0;  // Σ of squares about the means of the bins
  ident::map::FitSettings settings;
};

Binned binned(const Direction& d) {
  Binned out;
  out.top = *std::max_element(d.speed.begin(), d.speed.end());
  struct Sum {
    double n = 0, v = 0, f = 0, ff = 0;
  };
  std::vector<Sum> sums(kBins);
  const double scale = kBins / out.top;
  for (std::size_t i = 0; i < d.speed.size(); ++i) {
    Sum& s = sums[static_cast<std::size_t>(std::min(kBins - 1, static_cast<int>(d.speed[i] * scale)))];
    s.n += 1.0, s.v += d.speed[i], s.f += d.force[i], s.ff += d.force[i] * d.force[i];
  }
  double highest = 0.0;
  for (const Sum& s : sums) {
    if (s.n <= 0.0) continue;
    out.bins.u.push_back(s.v / s.n / out.top);
    out.bins.force.push_back(s.f / s.n);
    out.bins.weight.push_back(s.n);
    out.within += s.ff - s.f * s.f / s.n;
    highest = std::max(highest, std::abs(s.f / s.n));
  }
  // As identify_drive sets them.
  out.settings.noise = std::sqrt(out.within / static_cast<double>(d.speed.size()));
  out.settings.height_scale = 10.0 * highest;
  out.settings.slope_scale = 0.2 * highest;
  return out;
}

struct Curve {
  ident::map::BranchFit fit;
  double top = 0.0;
  std::vector<double> half;  // 95 %, at the bins [N]
};

/// Delta method on the long-run covariance of the rows, as identify_drive does it.
Curve fit_direction(const Direction& d) {
  const Binned b = binned(d);
  Curve out{ident::map::fit_ladder(b.bins, kTerms, b.settings).back(), b.top, {}};
  const std::size_t p = out.fit.parameters();
  const auto P = static_cast<Eigen::Index>(p);
  constexpr int kTable = 2048;
  std::vector<double> table;
  std::vector<double> slope((kBins + 1) * p);
  for (int i = 0; i <= kTable; ++i) table.push_back(out.fit.force(static_cast<double>(i) / kTable));
  for (int i = 0; i < kBins; ++i)
    out.fit.gradient((i + 0.5) / kBins, &slope[static_cast<std::size_t>(i) * p]);
  std::vector<double> residual(d.speed.size());
  std::vector<int> record(d.speed.size(), 0);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const double place = d.speed[i] / b.top * kTable;
    const int cell = std::min(kTable - 1, static_cast<int>(place));
    const auto c = static_cast<std::size_t>(cell);
    residual[i] = d.force[i] - (table[c] + (place - cell) * (table[c + 1] - table[c]));
  }
  ident::stats::LongRun moments(p, ident::stats::memory_of(residual, record, d.at));
  const double scale = kBins / b.top;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    double* row = moments.row(0, d.at[i]);
    const double* g =
        &slope[static_cast<std::size_t>(std::min(kBins - 1, static_cast<int>(d.speed[i] * scale))) * p];
    for (std::size_t j = 0; j < p; ++j) row[j] += g[j] * residual[i];
  }
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(P, P);
  Eigen::VectorXd g(P);
  for (std::size_t i = 0; i < b.bins.size(); ++i) {
    out.fit.gradient(b.bins.u[i], g.data());
    normal += b.bins.weight[i] * g * g.transpose();
  }
  const std::vector<double> raw = moments.covariance();
  const Eigen::Map<const Eigen::MatrixXd> meat(raw.data(), P, P);
  const Eigen::VectorXd unit = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd bread = unit.asDiagonal() *
                                Eigen::MatrixXd(unit.asDiagonal() * normal * unit.asDiagonal())
                                    .completeOrthogonalDecomposition()
                                    .pseudoInverse() *
                                unit.asDiagonal();
  const Eigen::MatrixXd covariance = bread * meat * bread;
  for (const double u : b.bins.u) {
    out.fit.gradient(u, g.data());
    out.half.push_back(1.96 * std::sqrt(std::max(0.0, g.dot(covariance * g))));
  }
  return out;
}

double curve_error(const ident::map::BranchFit& fit, double top, double sign) {
  double worst = 0.0;
  for (double speed = kSlowest; speed <= kFastest; speed += 0.05e-3) {
    const double error =
        std::abs(fit.force(speed / top) - sign * friction::steady_force(truth(), sign * speed));
    if (!(error <= worst)) worst = error;
  }
  return worst;
}

void fit_i1(benchmark::State& state) {
  const auto& d = directions();
  std::array<Curve, 2> curves;
  for (auto _ : state) {
    for (std::size_t s = 0; s < 2; ++s) curves[s] = fit_direction(d[s]);
  }
  double error = 0.0, half = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    error = std::max(error, curve_error(curves[s].fit, curves[s].top, s == 0 ? 1.0 : -1.0));
    half = std::max(half, *std::max_element(curves[s].half.begin(), curves[s].half.end()));
  }
  state.counters["curve_error_N"] = error;
  state.counters["widest_half_interval_N"] = half;
}

/// Sums of squares that 100 sets of random starts end with, worst over the directions.
void random_starts(benchmark::State& state) {
  constexpr unsigned kSets = 100;
  std::array<Binned, 2> b{binned(directions()[0]), binned(directions()[1])};
  for (Binned& side : b) side.settings.scattered = static_cast<int>(state.range(0));
  std::array<std::vector<double>, 2> cost;
  for (auto _ : state) {
    for (std::size_t s = 0; s < 2; ++s) {
      cost[s].clear();
      for (unsigned k = 0; k < kSets; ++k) {
        b[s].settings.first_start = 1 + k * static_cast<unsigned>(b[s].settings.scattered);
        cost[s].push_back(ident::map::fit_ladder(b[s].bins, kTerms, b[s].settings).back().cost);
      }
    }
  }
  const std::array<std::string, 2> side{"_forward", "_back"};
  for (std::size_t s = 0; s < 2; ++s) {
    const auto [least, most] = std::minmax_element(cost[s].begin(), cost[s].end());
    // The sum of squares of the rows, and what the bins add to it.
    const double of_rows = *least + b[s].within;
    const auto same = std::count_if(cost[s].begin(), cost[s].end(),
                                    [&, low = *least](double c) { return c - low <= 1e-3 * of_rows; });
    state.counters["same_of_100" + side[s]] = static_cast<double>(same);
    state.counters["spread_percent" + side[s]] = 100.0 * (*most - *least) / of_rows;
  }
}

// ---- the peer -------------------------------------------------------------------------------------------------

void nelder_mead_i1(benchmark::State& state) {
  const auto evaluations = static_cast<int>(state.range(0));
  double error = 0.0, excess = 0.0;
  for (auto _ : state) {
    for (std::size_t s = 0; s < 2; ++s) {
      const Direction& d = directions()[s];
      const Binned b = binned(d);
      std::vector<double> u(d.speed.size());
      for (std::size_t i = 0; i < u.size(); ++i) u[i] = d.speed[i] / b.top;
      const auto squares = [&](const std::vector<double>& p) {
        double sum = 0.0;
        for (std::size_t i = 0; i < u.size(); ++i) {
          double e = d.force[i] - p[0] - p[1] * u[i];
          for (std::size_t k = 2; k < p.size(); k += 3) {
            const double z = (u[i] - p[k + 1]) / p[k + 2];
            e -= p[k] * std::exp(-z * z);
          }
          sum += e * e;
        }
        return sum;
      };
      // The straight line, and a tenth of its level at three places.
      const ident::map::BranchFit line = ident::map::fit_line(b.bins, b.settings);
      std::vector<double> start{line.eta0, line.eta1}, step{0.1 * line.eta0, 0.1 * line.eta0};
      for (const double centre : {1.0 / 6.0, 0.5, 5.0 / 6.0}) {
        start.insert(start.end(), {0.1 * line.eta0, centre, 0.2});
        step.insert(step.end(), {0.1 * line.eta0, 0.1, 0.05});
      }
      ident::stats::SimplexOptions options;
      options.evaluations = evaluations;
      const ident::stats::SimplexResult found = ident::stats::minimise_simplex(squares, start, step, options);
      ident::map::BranchFit fit;
      fit.eta0 = found.x[0], fit.eta1 = found.x[1];
      for (std::size_t k = 2; k < found.x.size(); k += 3)
        fit.terms.push_back({found.x[k], found.x[k + 1], found.x[k + 2]});
      error = std::max(error, curve_error(fit, b.top, s == 0 ? 1.0 : -1.0));
      excess = std::max(
          excess, 100.0 * (std::sqrt(found.value / static_cast<double>(u.size())) / b.settings.noise - 1.0));
    }
  }
  state.counters["curve_error_N"] = error;
  state.counters["rms_above_noise_percent"] = excess;
}

BENCHMARK(read)->Name("Read")->Unit(benchmark::kMillisecond);
BENCHMARK(read_and_identify)
    ->Name("ReadAndIdentify")
    ->ArgName("pre_sliding")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(fit_i1)->Name("FitI1")->Unit(benchmark::kMillisecond);
BENCHMARK(random_starts)
    ->Name("RandomStartsI1")
    ->Arg(16)
    ->Arg(96)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(nelder_mead_i1)->Name("NelderMeadI1")->Arg(2000)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
