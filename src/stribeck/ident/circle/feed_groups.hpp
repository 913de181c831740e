#pragma once
/// Groups of runs by their feed, for the peaks of a circle. Inside ident only. Real time: no.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stribeck/ident/circle/causes_parts.hpp>
#include <vector>

namespace stribeck::ident::circle {

/// Runs whose feeds agree to a twentieth are one group.
class FeedGroups {
 public:
  explicit FeedGroups(const CauseRows& rows) {
    std::map<double, int> counts;
    for (const CauseRow& row : rows.rows) {
      if (std::isfinite(row.feed)) ++counts[row.feed];
    }
    for (const auto& [feed, count] : counts) {
      if (groups_.empty() || feed > kAlike * groups_.back().slowest) groups_.push_back({feed});
      groups_.back().sum += feed * count;
      groups_.back().count += count;
    }
  }
  /// Number of the group, ascending with the feed; that behind the last one where no feed is known.
  [[nodiscard]] double of(double feed) const {
    if (!std::isfinite(feed)) return static_cast<double>(groups_.size());
    const auto behind = std::upper_bound(groups_.begin(), groups_.end(), feed,
                                         [](double f, const Group& g) { return f < g.slowest; });
    return static_cast<double>(behind - groups_.begin() - 1);
  }
  /// Mean feed of the rows of a group [m/s]; NaN: none is known.
  [[nodiscard]] double mean(double group) const {
    const auto at = static_cast<std::size_t>(group);
    return at < groups_.size() ? groups_[at].sum / groups_[at].count
                               : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  static constexpr double kAlike = 1.05;
  struct Group {
    double slowest = 0.0;
    double sum = 0.0;
    int count = 0;
  };
  std::vector<Group> groups_;
};

}  // namespace stribeck::ident::circle
