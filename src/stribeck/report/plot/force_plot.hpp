#pragma once
/// The force of an axis over time: measured, modelled, and the difference.
/// Real time: no.

#include <stribeck/report/plot/plot.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::report {

inline constexpr std::string_view kMeasuredColor = "#9aa0a6";

struct ForceOverTime {
  std::string source;            ///< the record
  std::vector<double> t;         ///< [s]
  std::vector<double> measured;  ///< [N], or in the log's own unit
  std::vector<double> modelled;
};

/// `color` is that of the model.
Plot force_plot(const ForceOverTime& force, std::string title, const std::string& unit,
                const std::string& color);

}  // namespace stribeck::report
