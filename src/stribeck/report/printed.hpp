#pragma once
/// Values that the thesis prints for the biaxial table, shown beside results. Never an input of a computation.
///
/// Source: Bui, doctoral thesis, Toyohashi University of Technology, Tables 3.1 (3 mm/s) and 3.2 (9.5 mm/s):
/// averages of 10 trials on hardware. SD is above RMS in 11 of the 12 rows, which one signal cannot have
/// (docs/corrections-to-the-thesis.md, C-16): the SD column is shown, not compared.
/// Real time: no.

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stribeck/sim/metrics.hpp>
#include <string_view>

namespace stribeck::report {

struct PrintedRow {
  std::string_view controller;
  double max_contour_error_um = 0.0;
  double quadrant_glitch_um = 0.0;
  double rms_um = 0.0;
  double sd_um = 0.0;

  /// The printed value of a figure; absent for most figures.
  [[nodiscard]] constexpr std::optional<double> of(sim::Figure::OfRun figure) const noexcept {
    if (figure == &sim::Metrics::max_contour_error) return max_contour_error_um;
    if (figure == &sim::Metrics::quadrant_glitch) return quadrant_glitch_um;
    if (figure == &sim::Metrics::rms) return rms_um;
    if (figure == &sim::Metrics::sd) return sd_um;
    return {};
  }
};

struct PrintedTable {
  std::string_view source;
  double speed = 0.0;  ///< [m/s]
  std::array<PrintedRow, 6> rows;

  [[nodiscard]] constexpr const PrintedRow* find(std::string_view controller) const noexcept {
    for (const PrintedRow& r : rows) {
      if (r.controller == controller) return &r;
    }
    return nullptr;
  }
};

inline constexpr PrintedTable kTable31{"thesis, Table 3.1",
                                       3e-3,
                                       {{{"a", 15.72, 15.72, 7.73, 11.21},
                                         {"b", 7.36, 7.36, 1.14, 1.56},
                                         {"c", 3.54, 3.32, 0.85, 1.34},
                                         {"d", 13.81, 13.81, 2.98, 3.04},
                                         {"e", 3.71, 3.71, 0.43, 0.58},
                                         {"f", 5.43, 5.43, 0.55, 0.73}}}};

inline constexpr PrintedTable kTable32{"thesis, Table 3.2",
                                       9.5e-3,
                                       {{{"a", 12.74, 12.74, 6.88, 9.73},
                                         {"b", 5.38, 4.98, 2.23, 3.19},
                                         {"c", 3.08, 2.99, 1.29, 1.81},
                                         {"d", 16.72, 16.72, 3.98, 3.38},
                                         {"e", 3.82, 2.41, 1.01, 1.38},
                                         {"f", 1.56, 1.56, 0.49, 0.94}}}};

inline constexpr std::array kBiaxialTables{kTable31, kTable32};

/// The table that was printed for this speed [m/s], or null.
constexpr const PrintedTable* find_printed(std::span<const PrintedTable> tables, double speed) noexcept {
  for (const PrintedTable& t : tables) {
    const double d = t.speed - speed;
    if (d < 1e-9 && d > -1e-9) return &t;
  }
  return nullptr;
}

}  // namespace stribeck::report
