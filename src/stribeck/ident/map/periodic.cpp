#include <cmath>
#include <stribeck/ident/map/periodic.hpp>
#include <stribeck/ident/map/periodic_parts.hpp>
#include <utility>

namespace stribeck::ident::map {
namespace {

using namespace periodic;

constexpr int kTries = 40;
/// Gauss–Newton ends when its steps are below these shares of the resolution.
constexpr double kRough = 1e-4;
constexpr double kFine = 1e-9;

/// Two terms of one period, or of neighbouring ones, hide each other: what one of them leaves is the background of the other, and a part
/// that reverses makes the passes of both directions disagree on the part that does not. `more` ends with the first of them, `left` is what
/// it leaves. True when both stand out beside each other.
bool add_second(const Data& data, const FrequencyGrid& grid, const PeriodicOptions& options,
                const std::vector<double>& rejected, std::vector<Line>& more, Residual& left) {
  if (static_cast<int>(more.size()) >= options.most) return false;
  constexpr double kApart = 1.2;  // of the resolution
  const auto second = strongest(data, grid, left, options, more, rejected, true, kApart);
  if (!second) return false;
  more.back().f = more.back().start;  // alone it was drawn towards the other
  more.push_back(*second);
  if (!refine(data, kRough, more, left.e)) return false;
  spectrum(data, grid, left);
  return stands(data, grid, left, more[more.size() - 2]) && stands(data, grid, left, more.back());
}

/// Adds one term after the other, each refined together with those before it; `left` is their residual, `rejected` has the frequencies
/// of those that were tried and do not count.
std::vector<Line> search_lines(const Data& data, const FrequencyGrid& grid, const PeriodicOptions& options,
                               Residual& left, std::vector<double>& rejected) {
  constexpr int kPairs = 6;  // tries with a second term beside the first one
  std::vector<Line> found;
  std::vector<Line> guess;
  double most_power = 0.0;
  bool any = true;
  for (int tries = 0; tries < kTries && static_cast<int>(found.size()) < options.most; ++tries) {
    const auto line = strongest(data, grid, left, options, found, rejected, any);
    any = false;
    if (!line) break;
    std::vector<Line> more = found;
    more.push_back(*line);
    const Residual before = left;
    if (refine(data, kRough, more, left.e)) {
      spectrum(data, grid, left);
      const std::vector<Line> one = more;
      const double power = before.e.squaredNorm() - left.e.squaredNorm();
      if (stands(data, grid, left, more.back()) ||
          (tries < kPairs && add_second(data, grid, options, rejected, more, left))) {
        found = std::move(more);
        any = true;
        continue;
      }
      if (options.guess && found.empty() && power > most_power) most_power = power, guess = one;
    }
    left = before;
    rejected.push_back(line->start);
  }
  return found.empty() ? guess : found;
}

/// A line whose free period is beside the known one has this, unless clearly more is left then.
void hold_known(const Data& data, const PeriodicOptions& options, std::vector<Line>& found, Residual& left) {
  constexpr double kNear = 0.02;
  constexpr double kAsGood = 1.05;  // of the squares
  if (!(options.known > 0.0)) return;
  for (std::size_t j = 0; j < found.size(); ++j) {
    if (found[j].exact || std::abs(found[j].f * options.known - 1.0) > kNear) continue;
    std::vector<Line> held = found;
    held[j].f = held[j].start = 1.0 / options.known;
    held[j].exact = true;
    VectorXd e;
    if (!refine(data, kFine, held, e) || e.squaredNorm() > kAsGood * left.e.squaredNorm()) continue;
    found = std::move(held);
    left.e = std::move(e);
  }
}

/// `behind`: rows count for a period as far as the low-pass leaves it. `stronger`: a line that does not count is stronger than all terms.
PeriodicResult search(const PeriodicRows& rows, const PeriodicOptions& options, bool behind, bool& stronger) {
  PeriodicResult result;
  Data data;
  stronger = false;
  if (!measure(rows, options, behind, data, result) || !join(rows, data, result)) return result;
  prepare_passes(data);
  const FrequencyGrid grid = frequencies(data);
  if (!(data.total > 0.0)) {
    result.notes.emplace_back("periodic terms: the residual is zero");
    return result;
  }
  Residual left;
  left.e = data.e;
  spectrum(data, grid, left);
  write_spectrum(grid, left, result);
  std::vector<double> rejected;
  std::vector<Line> found = search_lines(data, grid, options, left, rejected);
  if (found.empty()) {
    report_none(data, result);
    return result;
  }
  refine(data, kFine, found, left.e);
  hold_known(data, options, found, left);
  spectrum(data, grid, left);
  report(data, grid, left, options, found, result);
  stronger = note_rejected(data, grid, left, found, rejected, result);
  return result;
}

}  // namespace

PeriodicResult find_periodic(const PeriodicRows& rows, const PeriodicOptions& options) {
  bool stronger = false, still = false;
  PeriodicResult result = search(rows, options, false, stronger);
  if (!stronger || rows.passed == nullptr) return result;
  // Rows too fast for the low-pass may have spoken against it.
  PeriodicResult again = search(rows, options, true, still);
  return still || again.terms.size() <= result.terms.size() ? result : again;
}

}  // namespace stribeck::ident::map
