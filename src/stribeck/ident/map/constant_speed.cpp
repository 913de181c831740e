#include <algorithm>
#include <cmath>
#include <queue>
#include <stribeck/ident/map/constant_speed.hpp>
#include <stribeck/ident/stats/order.hpp>
#include <utility>

namespace stribeck::ident::map {
namespace {

constexpr double kEqual = 0.04;    // share by which speeds may differ and still count as equal
constexpr double kDoubtful = 3.5;  // standard errors below which a difference is noise
constexpr double kDrift = 0.03;    // share of the speed over a stretch
constexpr double kBend = 0.015;    // difference of the middle from both ends, as a share
constexpr double kExact =
    0.2;  // factor on these limits for a reference: the top of a sine is no constant speed
constexpr double kBlockTime = 0.05;  // [s]
constexpr std::size_t kMostBlocks = 4000;
constexpr std::size_t kFewestBlocks = 4;
constexpr std::size_t kRoomy = 8;
constexpr std::size_t kScales = 8;  // number of blocks at the longest scale
constexpr double kCrooked =
    0.15;  // share of the distance by which the position may differ from a straight line
constexpr double kMuchMore = 1.1;  // how much more a longer scale must find

double median_or_zero(std::vector<double> v) { return v.empty() ? 0.0 : stats::median(std::move(v)); }

struct Piece {
  std::size_t first, last;  // first and last block
  double mean;
  int before, after;  // neighbours; −1: none
  int version = 0;
  bool alive = true;
  [[nodiscard]] double count() const { return static_cast<double>(last - first + 1); }
};

/// Difference of two neighbours; up to 1 they count as equal.
double distance(const Piece& a, const Piece& b, double noise) {
  const double difference = std::abs(a.mean - b.mean);
  if (difference == 0.0) return 0.0;
  return difference / std::max(kEqual * std::max(std::abs(a.mean), std::abs(b.mean)),
                               kDoubtful * noise * std::sqrt(1.0 / a.count() + 1.0 / b.count()));
}

/// Pieces of equal speed, computed from the speeds of blocks.
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

/// Whether the speed neither drifts nor bends beyond its noise.
bool is_constant(const std::vector<double>& u, const Piece& p, double noise, double strictness) {
  // The first and the last block may contain a part of the ramps.
  const std::size_t inside = p.last - p.first + 1 >= kRoomy ? 1 : 0;
  const std::size_t from = p.first + inside;
  const std::size_t to = p.last + 1 - inside;
  const std::size_t third = (to - from) / 3;
  if (third == 0) return true;
  const double begin = mean_over(u, from, from + third);
  const double middle = mean_over(u, from + third, to - third);
  const double end = mean_over(u, to - third, to);
  const double error = 3.0 * noise / std::sqrt(static_cast<double>(third));
  return std::abs(end - begin) <= strictness * kDrift * std::abs(p.mean) + 1.5 * error &&
         std::abs(middle - 0.5 * (begin + end)) <= strictness * kBend * std::abs(p.mean) + 1.3 * error;
}

/// Whether the position moves evenly: long blocks must not hide motion to and fro.
bool is_straight(const std::vector<double>& x, const SteadyRun& run) {
  const double step = (x[run.last] - x[run.first]) / static_cast<double>(run.last - run.first);
  const double allowed = kCrooked * std::abs(x[run.last] - x[run.first]);
  for (std::size_t k = run.first; k <= run.last; ++k) {
    if (std::abs(x[k] - x[run.first] - step * static_cast<double>(k - run.first)) > allowed) return false;
  }
  return true;
}

/// Runs that blocks of this many rows show.
std::vector<ConstantSpeed> pieces_at(const log::Record& rec, std::size_t number, std::size_t block) {
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
  // A reference at rest has no noise, and neither has a measured speed at rest.
  const double noise =
      !rec.r.empty() || static_cast<double>(differences.size()) < 0.3 * static_cast<double>(u.size())
          ? 0.0
          : median_or_zero(std::move(differences)) / (0.6745 * std::sqrt(2.0));

  std::vector<ConstantSpeed> found;
  std::size_t moving_from = 0;  // first row of motion since the last run found
  for (const Piece& piece : segment(u, noise)) {
    if (piece.last - piece.first + 1 < kFewestBlocks) continue;
    if (piece.mean == 0.0 || std::abs(piece.mean) < 4.0 * noise / std::sqrt(piece.count())) continue;
    if (!is_constant(u, piece, noise, rec.r.empty() ? 1.0 : kExact)) continue;
    ConstantSpeed f;
    f.run.record = number;
    f.run.first = piece.first * block;
    f.run.last = piece.last * block;  // the last block may contain the first row of braking
    if (!is_straight(p, f.run)) continue;
    f.run.speed = piece.mean;
    f.from_change = piece.first > 0;
    const double sign_of = piece.mean > 0.0 ? 1.0 : -1.0;
    std::size_t lowest = moving_from;
    for (std::size_t k = moving_from; k <= f.run.first; ++k) {
      if (sign_of * rec.x[k] <= sign_of * rec.x[lowest]) lowest = k;
    }
    // A record that begins in motion shows no reversal before it.
    const bool in_motion = lowest < block && u.front() / piece.mean > 0.5;
    if (f.from_change && !in_motion) f.reversal = lowest;
    moving_from = f.run.last;
    found.push_back(f);
  }
  return found;
}

}  // namespace

double mean_over(const std::vector<double>& values, std::size_t first, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = first; i < end; ++i) sum += values[i];
  return sum / static_cast<double>(end - first);
}

std::vector<ConstantSpeed> find_constant_speeds(const log::Record& rec, std::size_t number) {
  const std::size_t n = rec.t.size();
  auto block = static_cast<std::size_t>(std::max(1.0, std::floor(kBlockTime / rec.sample_time)));
  block = std::min(block, std::max<std::size_t>(1, n / 200));
  block = std::max(block, (n + kMostBlocks - 1) / kMostBlocks);
  std::vector<ConstantSpeed> best;
  double best_score = 0.0;
  for (; n / block >= kScales; block *= 2) {
    std::vector<ConstantSpeed> found = pieces_at(rec, number, block);
    double score = 0.0;  // sum of squares, so that one long run scores higher than its pieces
    for (const ConstantSpeed& f : found)
      score += std::pow(static_cast<double>(f.run.last - f.run.first), 2.0);
    if (score > kMuchMore * best_score) {
      best_score = score;
      best = std::move(found);
    }
    if (!rec.r.empty()) break;  // a reference has no ripple
  }
  return best;
}

}  // namespace stribeck::ident::map
