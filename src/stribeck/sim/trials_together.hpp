#pragma once
/// Trials of one machine that run side by side, so that their drives move in packs (Drives::run_together()).
///
/// Inside sim only. Real time: no. Errors: none.

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <stribeck/sim/contour_run.hpp>
#include <thread>
#include <utility>

namespace stribeck::sim {

/// The drives of one machine, as many times as they are needed.
class EqualDrives {
 public:
  explicit EqualDrives(std::function<Drives()> make) : make_(std::move(make)) {}

  /// References stay valid.
  Drives& operator[](std::size_t i) {
    while (all_.size() <= i) all_.push_back(make_());
    return all_[i];
  }

 private:
  std::function<Drives()> make_;
  std::deque<Drives> all_;
};

/// Trials cut into shares that are run at once: few of them, and work for every thread.
class TrialShares {
 public:
  /// `rows`: how many times the trials are run; threads = 0: as many as the machine has.
  TrialShares(std::uint32_t trials, std::size_t rows, unsigned threads) : trials_(trials) {
    constexpr std::size_t kMostTogether = 16;  // their state fits into the cache of a core
    if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
    const std::size_t of_threads =
        (threads + std::max<std::size_t>(rows, 1) - 1) / std::max<std::size_t>(rows, 1);
    const std::size_t least = std::max(of_threads, (trials + kMostTogether - 1) / kMostTogether);
    count_ = std::max<std::size_t>(1, std::min<std::size_t>(least, trials));
  }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// The first trial of a share, and the one behind its last.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> operator[](std::size_t i) const noexcept {
    return {at(i), at(i + 1)};
  }

 private:
  [[nodiscard]] std::uint32_t at(std::size_t i) const noexcept {
    return static_cast<std::uint32_t>(i * trials_ / count_);
  }
  std::size_t trials_;
  std::size_t count_ = 1;
};

}  // namespace stribeck::sim
