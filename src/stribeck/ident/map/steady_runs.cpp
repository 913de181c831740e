#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <queue>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/map/steady_runs.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/stats/long_run.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::map {
namespace {

constexpr double kEqual = 0.04;      // speeds that are one
constexpr double kDoubtful = 3.5;    // standard errors below which a difference is noise
constexpr double kDrift = 0.03;      // of the speed over a stretch
constexpr double kBend = 0.015;      // middle against both ends
constexpr double kExact = 0.2;       // of these for a reference: the top of a sine is no constant speed
constexpr double kBlockTime = 0.05;  // [s]
constexpr std::size_t kMostBlocks = 4000;
constexpr std::size_t kFewestBlocks = 4;
constexpr std::size_t kRoomy = 8;
constexpr std::size_t kScales = 8;  // blocks that are left at the longest scale
constexpr double kCrooked = 0.15;   // of the way, that the position may be off the straight line
constexpr double kMuchMore = 1.1;   // that a longer scale must show
constexpr std::size_t kFewestRows = 20;
constexpr double kRelaxations = 6.0;
constexpr double kSameWay = 4.0;           // lengths agree within
constexpr std::size_t kSlowest = 6;        // one run in so many shows the bristle best
constexpr std::size_t kPointsOfRun = 120;  // means over which the periodic term is fitted
constexpr double kWorthwhile = 0.25;       // of the scatter of these means
constexpr double kPointsOfPeriod = 8.0;    // and the shortest period that they show
constexpr double kSlowRipple = 0.7;     // periods per second, below which the axis does not follow the ripple
constexpr double kPeriodsOfSlow = 4.0;  // that the slow runs must hold
constexpr double kPeriodsOfLongest = 1.5;  // the longest stretch holds so many of the longest period

/// A speed as people read it.
std::string shown(double speed, const log::Record& rec) {
  return rec.position_unit == "rad" ? fmt::format("{:.4g} rad/s", speed)
                                    : fmt::format("{:.4g} mm/s", speed * 1e3);
}
std::string shown_way(double way, const log::Record& rec) {
  return rec.position_unit == "rad" ? fmt::format("{:.3g} mrad", way * 1e3)
                                    : fmt::format("{:.3g} um", way * 1e6);
}

double median(std::vector<double> v) { return v.empty() ? 0.0 : stats::median(std::move(v)); }

struct Piece {
  std::size_t first, last;  // blocks, last included
  double mean;
  int before, after;  // neighbours, -1: none
  int version = 0;
  bool alive = true;
  [[nodiscard]] double count() const { return static_cast<double>(last - first + 1); }
};

/// How far two neighbours are from being one; up to 1 they are.
double distance(const Piece& a, const Piece& b, double noise) {
  const double difference = std::abs(a.mean - b.mean);
  if (difference == 0.0) return 0.0;
  return difference / std::max(kEqual * std::max(std::abs(a.mean), std::abs(b.mean)),
                               kDoubtful * noise * std::sqrt(1.0 / a.count() + 1.0 / b.count()));
}

/// Pieces of equal speed, from the speeds of blocks.
std::vector<Piece> segment(const std::vector<double>& u, double noise) {
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < u.size(); ++i) {
    pieces.push_back({i, i, u[i], static_cast<int>(i) - 1, i + 1 < u.size() ? static_cast<int>(i) + 1 : -1});
  }
  struct Pair {
    double distance;
    int left, left_version, right, right_version;
    bool operator<(const Pair& other) const {
      return distance != other.distance ? distance > other.distance : left > other.left;
    }
  };
  std::priority_queue<Pair> queue;
  const auto offer = [&](int left, int right) {
    if (left < 0 || right < 0) return;
    const Piece& a = pieces[static_cast<std::size_t>(left)];
    const Piece& b = pieces[static_cast<std::size_t>(right)];
    const double d = distance(a, b, noise);
    if (d <= 1.0) queue.push({d, left, a.version, right, b.version});
  };
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) offer(static_cast<int>(i), static_cast<int>(i) + 1);
  while (!queue.empty()) {
    const Pair best = queue.top();
    queue.pop();
    Piece& a = pieces[static_cast<std::size_t>(best.left)];
    Piece& b = pieces[static_cast<std::size_t>(best.right)];
    if (!a.alive || !b.alive || a.version != best.left_version || b.version != best.right_version) continue;
    a.mean = (a.mean * a.count() + b.mean * b.count()) / (a.count() + b.count());
    a.last = b.last;
    a.after = b.after;
    ++a.version;
    b.alive = false;
    if (b.after >= 0) pieces[static_cast<std::size_t>(b.after)].before = best.left;
    offer(a.before, best.left);
    offer(best.left, a.after);
  }
  std::vector<Piece> out;
  for (const Piece& p : pieces) {
    if (p.alive) out.push_back(p);
  }
  return out;
}

double mean_of(const std::vector<double>& u, std::size_t first, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = first; i < end; ++i) sum += u[i];
  return sum / static_cast<double>(end - first);
}

/// The speed neither drifts nor bends beyond its noise.
bool is_constant(const std::vector<double>& u, const Piece& p, double noise, double strictness) {
  // The first and last block may hold a little of the ramps.
  const std::size_t inside = p.last - p.first + 1 >= kRoomy ? 1 : 0;
  const std::size_t from = p.first + inside;
  const std::size_t to = p.last + 1 - inside;
  const std::size_t third = (to - from) / 3;
  if (third == 0) return true;
  const double begin = mean_of(u, from, from + third);
  const double middle = mean_of(u, from + third, to - third);
  const double end = mean_of(u, to - third, to);
  const double error = 3.0 * noise / std::sqrt(static_cast<double>(third));
  return std::abs(end - begin) <= strictness * kDrift * std::abs(p.mean) + 1.5 * error &&
         std::abs(middle - 0.5 * (begin + end)) <= strictness * kBend * std::abs(p.mean) + 1.3 * error;
}

/// No way to and fro hides in long blocks.
bool is_straight(const std::vector<double>& x, const SteadyRun& run) {
  const double step = (x[run.last] - x[run.first]) / static_cast<double>(run.last - run.first);
  const double allowed = kCrooked * std::abs(x[run.last] - x[run.first]);
  for (std::size_t k = run.first; k <= run.last; ++k) {
    if (std::abs(x[k] - x[run.first] - step * static_cast<double>(k - run.first)) > allowed) return false;
  }
  return true;
}

struct Found {
  SteadyRun run;
  bool from_change = true;  // a change of speed precedes
  std::optional<std::size_t> reversal;
};

/// Runs that blocks of so many rows show.
std::vector<Found> pieces_at(const log::Record& rec, std::size_t number, std::size_t block) {
  const std::size_t n = rec.t.size();
  const std::vector<double>& p = rec.r.empty() ? rec.x : rec.r;
  std::vector<double> u;
  for (std::size_t k = 0; k + block < n; k += block) {
    u.push_back((p[k + block] - p[k]) / (static_cast<double>(block) * rec.sample_time));
  }
  std::vector<double> differences;
  for (std::size_t i = 1; i < u.size(); ++i) {
    if (u[i] != u[i - 1]) differences.push_back(std::abs(u[i] - u[i - 1]));
  }
  // A reference has none; a measured speed at rest neither.
  const double noise =
      !rec.r.empty() || static_cast<double>(differences.size()) < 0.3 * static_cast<double>(u.size())
          ? 0.0
          : median(std::move(differences)) / (0.6745 * std::sqrt(2.0));

  std::vector<Found> found;
  std::size_t moving_from = 0;  // first row of the motion since the last run that was found
  for (const Piece& piece : segment(u, noise)) {
    if (piece.last - piece.first + 1 < kFewestBlocks) continue;
    if (piece.mean == 0.0 || std::abs(piece.mean) < 4.0 * noise / std::sqrt(piece.count())) continue;
    if (!is_constant(u, piece, noise, rec.r.empty() ? 1.0 : kExact)) continue;
    Found f;
    f.run.record = number;
    f.run.first = piece.first * block;
    f.run.last = piece.last * block;  // the last block may hold the first row of braking
    if (!is_straight(p, f.run)) continue;
    f.run.speed = piece.mean;
    f.from_change = piece.first > 0;
    const double sign_of = piece.mean > 0.0 ? 1.0 : -1.0;
    std::size_t lowest = moving_from;
    for (std::size_t k = moving_from; k <= f.run.first; ++k) {
      if (sign_of * rec.x[k] <= sign_of * rec.x[lowest]) lowest = k;
    }
    // A record that begins in motion shows no reversal.
    const bool in_motion = lowest < block && u.front() / piece.mean > 0.5;
    if (f.from_change && !in_motion) f.reversal = lowest;
    moving_from = f.run.last;
    found.push_back(f);
  }
  return found;
}

/// Runs at the scale that shows most of them: a rippling speed is constant only to longer blocks.
std::vector<Found> pieces_of(const log::Record& rec, std::size_t number) {
  const std::size_t n = rec.t.size();
  auto block = static_cast<std::size_t>(std::max(1.0, std::floor(kBlockTime / rec.sample_time)));
  block = std::min(block, std::max<std::size_t>(1, n / 200));
  block = std::max(block, (n + kMostBlocks - 1) / kMostBlocks);
  std::vector<Found> best;
  double best_score = 0.0;
  for (; n / block >= kScales; block *= 2) {
    std::vector<Found> found = pieces_at(rec, number, block);
    double score = 0.0;  // squares: one long run rather than its pieces
    for (const Found& f : found) score += std::pow(static_cast<double>(f.run.last - f.run.first), 2.0);
    if (score > kMuchMore * best_score) {
      best_score = score;
      best = std::move(found);
    }
    if (!rec.r.empty()) break;  // a reference does not ripple
  }
  return best;
}

/// Way in which the force relaxes to 1/e after the reversal before a run [m]; NaN: the rows do not resolve it.
double relaxation_of(const log::Record& rec, const Found& f) {
  constexpr std::size_t kResolved = 6;
  constexpr double kLengths = 2.0;  // exp(−2) is well above the noise
  constexpr double kShortOfRun = 0.2;
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (!f.reversal) return none;
  const std::size_t half = f.run.first + (f.run.last - f.run.first) / 2;
  const double end = mean_of(rec.f, half, f.run.last + 1);
  const double begin = rec.f[*f.reversal];
  const double change = end - begin;
  if (change * f.run.speed <= 0.0 || std::abs(change) < 0.5 * std::abs(end))
    return none;  // no reversal of the force
  for (std::size_t k = *f.reversal; k <= f.run.last; ++k) {
    if ((end - rec.f[k]) / change > std::exp(-kLengths)) continue;
    if (k - *f.reversal < kResolved) return none;
    const double way = std::abs(rec.x[k] - rec.x[*f.reversal]);
    return way < kShortOfRun * std::abs(rec.x[f.run.last] - rec.x[f.run.first]) ? way / kLengths : none;
  }
  return none;
}

/// Means over parts of the runs, for the periodic term.
struct Points {
  std::vector<double> x, f, direction;
  std::vector<int> run;
};

Points points_of(const std::vector<log::Record>& records, const std::vector<SteadyRun>& runs) {
  Points out;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const SteadyRun& run = runs[i];
    const log::Record& rec = records[run.record];
    const std::size_t rows = run.last - run.first + 1;
    const std::size_t step = std::max<std::size_t>(1, rows / kPointsOfRun);
    for (std::size_t k = run.first; k + step <= run.last + 1; k += step) {
      out.x.push_back(mean_of(rec.x, k, k + step));
      out.f.push_back(mean_of(rec.f, k, k + step));
      out.direction.push_back(run.speed > 0.0 ? 1.0 : -1.0);
      out.run.push_back(static_cast<int>(i));
    }
  }
  return out;
}

struct Wave {
  double period = 0.0, cosine = 0.0, sine = 0.0;
  bool proportional = false;
  double left = std::numeric_limits<double>::infinity();  // Σ residual² with the means of the runs
};

/// Least squares of cosine and sine together with the mean of every run; the better of the two forms.
Wave fit_wave(const Points& p, std::size_t runs, double period) {
  std::vector<double> n(runs), c(runs), s(runs), f(runs);
  const std::size_t size = p.x.size();
  std::vector<double> cosine(size), sine(size);
  for (std::size_t i = 0; i < size; ++i) {
    cosine[i] = std::cos(2.0 * kPi * p.x[i] / period);
    sine[i] = std::sin(2.0 * kPi * p.x[i] / period);
    const auto r = static_cast<std::size_t>(p.run[i]);
    n[r] += 1.0, c[r] += cosine[i], s[r] += sine[i], f[r] += p.f[i];
  }
  // A run has one direction: times sgn v changes the sign of the products with the force alone.
  double cc = 0, cs = 0, ss = 0, ff = 0;
  double cf[2] = {0, 0}, sf[2] = {0, 0};
  for (std::size_t i = 0; i < size; ++i) {
    const auto r = static_cast<std::size_t>(p.run[i]);
    const double a = cosine[i] - c[r] / n[r];
    const double b = sine[i] - s[r] / n[r];
    const double e = p.f[i] - f[r] / n[r];
    cc += a * a, cs += a * b, ss += b * b, ff += e * e;
    cf[0] += a * e, sf[0] += b * e;
    cf[1] += p.direction[i] * a * e, sf[1] += p.direction[i] * b * e;
  }
  Wave best;
  best.period = period;
  best.left = ff;
  const double det = cc * ss - cs * cs;
  if (!(det > 1e-6 * cc * ss)) return best;
  for (const int form : {0, 1}) {
    const double x = (ss * cf[form] - cs * sf[form]) / det;
    const double y = (cc * sf[form] - cs * cf[form]) / det;
    const double left = ff - x * cf[form] - y * sf[form];
    if (left < best.left) best = {period, x, y, form == 1, left};
  }
  return best;
}

/// The best period near that of `start`; step in periods per metre.
Wave refined(const Points& p, std::size_t runs, const Wave& start, double step) {
  Wave best = start;
  for (double fine = step / 2.0; fine > step / 200.0; fine /= 2.0) {
    for (const double sign_of : {1.0, -1.0}) {
      const Wave w = fit_wave(p, runs, 1.0 / (1.0 / best.period + sign_of * fine));
      if (w.left < best.left) best = w;
    }
  }
  return best;
}

std::optional<Wave> search_wave(const Points& p, const std::vector<SteadyRun>& runs,
                                const std::optional<double>& given) {
  if (p.x.empty() || (given && *given == 0.0)) return {};
  const auto [low, high] = std::minmax_element(p.x.begin(), p.x.end());
  const double span = *high - *low;
  double longest = 0.0;
  std::vector<double> steps;
  for (const SteadyRun& run : runs) longest = std::max(longest, run.way);
  for (std::size_t i = 1; i < p.x.size(); ++i) {
    if (p.run[i] == p.run[i - 1]) steps.push_back(std::abs(p.x[i] - p.x[i - 1]));
  }
  if (steps.empty() || !(span > 0.0)) return {};
  const double none = fit_wave(p, runs.size(), 1e9 * span).left;
  Wave best;
  const auto consider = [&](double period) {
    const Wave w = fit_wave(p, runs.size(), period);
    if (w.left < best.left) best = w;
  };
  if (given) {
    consider(*given);
  } else {
    const double shortest = std::max(kPointsOfPeriod * median(std::move(steps)), span / 200.0);
    const double step = 0.25 / span;  // in periods per metre
    for (double q = kPeriodsOfLongest / longest; q <= 1.0 / shortest; q += step) consider(1.0 / q);
    best = refined(p, runs.size(), best, step);
  }
  if (!(best.left < (1.0 - kWorthwhile) * none) && !given) return {};
  // At higher speeds the axis follows the ripple, and the force holds its acceleration.
  Points slow;
  double way = 0.0;
  for (const SteadyRun& run : runs) {
    if (std::abs(run.speed) <= kSlowRipple * best.period) way += run.way;
  }
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    if (std::abs(runs[static_cast<std::size_t>(p.run[i])].speed) > kSlowRipple * best.period) continue;
    slow.x.push_back(p.x[i]);
    slow.f.push_back(p.f[i]);
    slow.direction.push_back(p.direction[i]);
    slow.run.push_back(p.run[i]);
  }
  if (way < kPeriodsOfSlow * best.period) return best;
  const Wave again = fit_wave(slow, runs.size(), best.period);
  return given ? again : refined(slow, runs.size(), again, 0.25 / way);
}

}  // namespace

log::Record with_positions(const log::Record& record) {
  log::Record out = record;
  if (out.x.empty() && out.v.size() == out.t.size() && !out.v.empty()) {
    out.x.assign(out.v.size(), 0.0);
    for (std::size_t k = 1; k < out.v.size(); ++k) {
      out.x[k] = out.x[k - 1] + 0.5 * out.sample_time * (out.v[k] + out.v[k - 1]);
    }
  }
  const auto wrong = log::problems(out);
  if (!wrong.empty()) throw Refused(wrong.front());
  return out;
}

SteadyRuns find_steady_runs(const std::vector<log::Record>& records, const SteadyOptions& options) {
  SteadyRuns out;
  std::vector<log::Record> whole;
  whole.reserve(records.size());
  bool measured = true;  // positions of several records belong together
  for (const log::Record& r : records) {
    whole.push_back(with_positions(r));
    measured = measured && !r.x.empty();
  }
  std::vector<Found> found;
  std::vector<std::pair<double, double>> lengths;  // speed, length
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (Found& f : pieces_of(whole[i], i)) {
      const double length = relaxation_of(whole[i], f);
      if (std::isfinite(length)) lengths.push_back({std::abs(f.run.speed), length});
      found.push_back(f);
    }
  }
  // The slowest show the bristle: at higher speeds the force of the acceleration hides it.
  std::vector<double> speeds;
  for (const Found& f : found) speeds.push_back(std::abs(f.run.speed));
  std::sort(speeds.begin(), speeds.end());
  std::sort(lengths.begin(), lengths.end());
  std::vector<double> slow;
  for (const auto& [speed, length] : lengths) {
    const bool enough = slow.size() >= std::max<std::size_t>(2, found.size() / kSlowest);
    if (!enough && speed <= speeds[speeds.size() / 3]) slow.push_back(length);
  }
  if (slow.size() >= 2) {
    const auto [least, most] = std::minmax_element(slow.begin(), slow.end());
    if (*most < kSameWay * *least) out.relaxation = median(slow);
  }
  out.exclude = options.exclude.value_or(std::isfinite(out.relaxation) ? kRelaxations * out.relaxation : 0.0);

  std::vector<std::string> left_out;
  for (Found& f : found) {
    const log::Record& rec = whole[f.run.record];
    SteadyRun& run = f.run;
    const double T = rec.sample_time;
    const double duration = T * static_cast<double>(run.last - run.first);
    const double way = std::abs(rec.x[run.last] - rec.x[f.reversal.value_or(run.first)]);
    if (f.from_change) {
      run.first += static_cast<std::size_t>(std::ceil(std::min(options.settle, 0.3 * duration) / T));
    }
    if (f.reversal) {
      while (run.first < run.last && std::abs(rec.x[run.first] - rec.x[*f.reversal]) < out.exclude)
        ++run.first;
    }
    if (run.last - run.first + 1 < kFewestRows ||
        T * static_cast<double>(run.last - run.first) < options.shortest) {
      left_out.push_back(
          f.reversal && way < 1.5 * out.exclude
              ? fmt::format(
                    "{}: {} from {:.4g} s: moved {}, and the bristle follows for {} after a reversal; left out",
                    rec.source, shown(run.speed, rec), rec.t[run.first], shown_way(way, rec),
                    shown_way(out.exclude, rec))
              : fmt::format("{}: {} from {:.4g} s: less than {:g} s of constant speed; left out", rec.source,
                            shown(run.speed, rec), rec.t[run.first], options.shortest));
      continue;
    }
    const double rows = static_cast<double>(run.last - run.first);
    const double speed = (rec.x[run.last] - rec.x[run.first]) / (rows * T);
    if (!rec.r.empty() && std::abs(speed - run.speed) > 0.1 * std::abs(run.speed)) {
      left_out.push_back(fmt::format("{}: {} asked from {:.4g} s on, but the axis moved with {}; left out",
                                     rec.source, shown(run.speed, rec), rec.t[run.first], shown(speed, rec)));
      continue;
    }
    run.speed = speed;
    run.way = std::abs(rec.x[run.last] - rec.x[run.first]);
    if (run.speed != 0.0) out.runs.push_back(run);
  }
  constexpr std::size_t kNamed = 6;
  for (std::size_t i = 0; i < std::min(left_out.size(), kNamed); ++i) out.notes.push_back(left_out[i]);
  if (left_out.size() > kNamed) {
    out.notes.push_back(
        fmt::format("and {} more stretches were left out for like reasons", left_out.size() - kNamed));
  }

  std::optional<Wave> wave;
  if (measured) {
    const Points points = points_of(whole, out.runs);
    wave = search_wave(points, out.runs, options.period);
    if (wave) {
      friction::Eccentric<double> e;
      e.period = wave->period;
      e.amplitude = std::hypot(wave->cosine, wave->sine);
      // sin(θ − φ) = cos φ·sin θ − sin φ·cos θ
      e.phase = std::atan2(-wave->cosine, wave->sine);
      e.form =
          wave->proportional ? friction::EccentricForm::kProportional : friction::EccentricForm::kAdditive;
      out.periodic = e;
    }
  }
  double square = 0.0, correlated = 0.0;
  for (SteadyRun& run : out.runs) {
    const log::Record& rec = whole[run.record];
    std::vector<double> e;
    std::vector<int> number;
    std::vector<std::size_t> at;
    for (std::size_t k = run.first; k <= run.last; ++k) {
      double f = rec.f[k];
      if (out.periodic) {
        friction::SteadyParts<double> p;
        out.periodic->add_to(p, rec.x[k]);
        f -= p.additive + (run.speed > 0.0 ? p.level : -p.level);
      }
      e.push_back(f);
      number.push_back(0);
      at.push_back(k);
    }
    const double n = static_cast<double>(e.size());
    double mean = 0.0;
    for (const double f : e) mean += f / n;
    double variance = 0.0;
    for (double& f : e) f -= mean, variance += f * f / n;
    const stats::Memory memory = stats::memory_of(e, number, at);
    run.force = mean;
    run.error = std::sqrt(variance * 2.0 * std::max(0.5, memory.rows) / n);
    square += variance;
    correlated += 2.0 * std::max(0.5, memory.rows) * variance * rec.sample_time;
  }
  if (out.periodic && square > 0.0) {
    // Of the amplitude: the long-run variance over all the time that was used.
    double time = 0.0;
    for (const SteadyRun& run : out.runs) {
      time += whole[run.record].sample_time * static_cast<double>(run.last - run.first + 1);
    }
    out.periodic_error = std::sqrt(2.0 * correlated / static_cast<double>(out.runs.size()) / time);
  }
  return out;
}

}  // namespace stribeck::ident::map
