#include <algorithm>
#include <cmath>
#include <stribeck/ident/drive/steady_rows.hpp>

namespace stribeck::ident::drive {
namespace {

// Differences as shares of the mean. A slip begins and ends at rest, so that rows of its pieces differ by 100 %; noise of the speed
// by a coarse encoder must fit in.
// From the mean of its piece.
constexpr double kRowMayDiffer = 0.5;
// From the first piece of its run: friction changes little over such a range of speed.
constexpr double kPieceMayDiffer = 0.3;
// Up to four speeds between two reversals; a slip is a smaller share.
constexpr double kLeastShareOfTravel = 0.25;
// The end of a stroke that runs out passes through any range of speed within one or two.
constexpr int kFewestPieces = 4;
constexpr double kNoises = 20.0;  // the mean speed of a piece is then right within 7 %

struct Run {
  std::size_t first = 0, last = 0;  ///< rows
  double speed = 0.0;               ///< mean of its first piece [m/s]
  double travel = 0.0;              ///< [m]
  int pieces = 1;
};

class Stretch {
 public:
  Stretch(const log::Motion& m, std::size_t first, std::size_t last, double piece)
      : m_(m), first_(first), last_(last), piece_(piece) {}

  void mark(std::vector<std::uint8_t>& steady) const {
    double farthest = 0.0;
    for (std::size_t k = first_; k <= last_; ++k) farthest = std::max(farthest, m_.distance[k]);
    for (const Run& run : runs()) {
      if (run.pieces < kFewestPieces || run.travel < kLeastShareOfTravel * farthest) continue;
      std::fill(steady.begin() + static_cast<std::ptrdiff_t>(run.first),
                steady.begin() + static_cast<std::ptrdiff_t>(run.last) + 1, std::uint8_t{1});
    }
  }

 private:
  [[nodiscard]] std::vector<Run> runs() const {
    std::vector<Run> out;
    bool goes_on = false;
    for (std::size_t from = first_; from < last_;) {
      std::size_t to = from;
      while (to < last_ && m_.distance[to] - m_.distance[from] < piece_) ++to;
      const double travel = m_.distance[to] - m_.distance[from];
      if (travel < piece_) break;
      const double speed = travel / (static_cast<double>(to - from) * m_.sample_time);
      const bool steady = is_steady(from, to, speed);
      if (steady && goes_on && std::abs(speed - out.back().speed) <= kPieceMayDiffer * out.back().speed) {
        out.back().last = to;
        out.back().travel += travel;
        ++out.back().pieces;
      } else if (steady) {
        out.push_back({from, to, speed, travel, 1});
      }
      goes_on = steady;
      from = to;
    }
    return out;
  }

  [[nodiscard]] bool is_steady(std::size_t from, std::size_t to, double speed) const {
    for (std::size_t k = from; k <= to; ++k) {
      if (!(std::abs(m_.v[k] * m_.direction[k] - speed) <= kRowMayDiffer * speed)) return false;
    }
    return true;
  }

  const log::Motion& m_;
  std::size_t first_, last_;
  double piece_;
};

}  // namespace

std::vector<std::uint8_t> steady_rows(const log::Motion& m, double exclude) {
  std::vector<std::uint8_t> steady(m.rows(), 0);
  const double piece = std::max(exclude, kNoises * m.position_noise);
  if (!(piece > 0.0)) return steady;
  for (std::size_t first = 0; first < m.rows();) {
    std::size_t last = first;
    while (last + 1 < m.rows() && m.stretch[last + 1] == m.stretch[first]) ++last;
    Stretch(m, first, last, piece).mark(steady);
    first = last + 1;
  }
  return steady;
}

bool asked_slower(std::span<const log::Record> records, double direction, double speed) {
  constexpr double kLongEnough = 1.0;  // [s]
  constexpr double kSame = 0.02;       // of a speed
  for (const log::Record& r : records) {
    double held = 0.0, last = 0.0;
    for (std::size_t k = 1; k < r.r.size(); ++k) {
      const double v = direction * (r.r[k] - r.r[k - 1]) / r.sample_time;
      const bool slow = v > 0.0 && v < speed && std::abs(v - last) <= kSame * v;
      held = slow ? held + r.sample_time : 0.0;
      last = v;
      if (held > kLongEnough) return true;
    }
  }
  return false;
}

}  // namespace stribeck::ident::drive
