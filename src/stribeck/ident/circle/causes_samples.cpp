#include <algorithm>
#include <cmath>
#include <stribeck/core/scalar.hpp>
#include <stribeck/ident/circle/causes_parts.hpp>

namespace stribeck::ident::circle {

double Explained::at(const CircleRun& run, int log, std::size_t i, double progress) const {
  CauseRow row;
  row.log = log;
  row.angle = run.angle[i];
  row.direction = run.counter_clockwise ? 1.0 : -1.0;
  row.feed = run.feed;
  row.progress = progress;
  return column_values(rows_, design_.columns, row).dot(fit_.coefficients);
}

PassingSamples::PassingSamples(const std::vector<CircleMotion>& motions, const CauseRows& rows,
                               const Explained& explained)
    : rows_(rows), explained_(explained) {
  int log = 0;
  for (const CircleMotion& m : motions) {
    for (const CircleRun& run : m.runs) runs_.push_back({&run, log});
    ++log;
  }
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    const CircleRun& run = *runs_[k].run;
    for (std::size_t i = 0; i < run.angle.size(); ++i) {
      const double turned = (run.counter_clockwise ? 1.0 : -1.0) * run.angle[i];
      const Passing which{static_cast<int>(k), static_cast<long>(std::floor(turned / (0.5 * kPi)))};
      auto [at, is_new] = ends_.try_emplace(which, i, i);
      at->second.second = i;
    }
  }
  for (std::size_t i = 0; i < rows.rows.size(); ++i)
    rows_of_run_.try_emplace(rows.rows[i].run, i, i).first->second.second = i;
}

std::vector<PassingSamples::Sample> PassingSamples::of(const std::vector<Passing>& passings, double from,
                                                       double to) const {
  std::vector<Sample> out;
  for (const Passing& which : passings) {
    const auto ends = ends_.find(which);
    if (ends == ends_.end()) continue;
    const auto& [run, log] = runs_[static_cast<std::size_t>(which.first)];
    const double direction = run->counter_clockwise ? 1.0 : -1.0;
    bool goes_on = false;
    for (std::size_t i = ends->second.first; i <= ends->second.second; ++i) {
      const double behind = direction * run->angle[i] - 0.5 * kPi * static_cast<double>(which.second);
      if (behind < from || behind >= to) continue;
      const double rest =
          run->error[i] - explained_.at(*run, log, i, progress_at(which.first, run->angle[i]));
      out.push_back({behind, rest, goes_on});
      goes_on = true;
    }
  }
  return out;
}

double PassingSamples::progress_at(int run, double angle) const {
  const auto found = rows_of_run_.find(run);
  if (!rows_.drifts || found == rows_of_run_.end()) return 0.0;
  const auto begin = rows_.rows.begin() + static_cast<std::ptrdiff_t>(found->second.first);
  const auto end = rows_.rows.begin() + static_cast<std::ptrdiff_t>(found->second.second) + 1;
  const double direction = begin->direction;
  const auto next = std::lower_bound(begin, end, direction * angle,
                                     [&](const CauseRow& r, double a) { return direction * r.angle < a; });
  return next == end ? std::prev(end)->progress : next->progress;
}

}  // namespace stribeck::ident::circle
