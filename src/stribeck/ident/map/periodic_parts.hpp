#pragma once
/// Inside of periodic.hpp: values that are handed on from the rows to the terms.
///
///   periodic_rows.cpp      rows → Data: groups, passes, weights, without a polynomial for each pass
///   periodic_spectrum.cpp  Data, residual → Residual: power at every frequency, its background, candidates
///   periodic_fit.cpp       all terms together, by Gauss–Newton
///   periodic_result.cpp    terms with intervals, harmonics, what cannot be told
///
/// Inside ident only: includes Eigen. Real time: no.

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <stribeck/ident/map/periodic.hpp>
#include <unsupported/Eigen/FFT>
#include <utility>
#include <vector>

namespace stribeck::ident::map::periodic {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

enum Form : std::size_t { kSame, kReversing, kForms };

/// Neighbouring rows of one pass.
struct Group {
  double x = 0.0;       ///< mean
  double spread = 0.0;  ///< variance of x inside
  double e = 0.0;       ///< mean
  double weight = 0.0;  ///< rows, tapered
  double sign = 1.0;    ///< −1 in backward motion
};

/// A stretch of one direction.
struct Pass {
  std::size_t first = 0;
  std::size_t last = 0;  ///< one behind
};

/// A term in work: a·sin(2πf·u) + b·cos(2πf·u), u from the middle of the travel.
struct Line {
  double f = 0.0;
  double start = 0.0;  ///< where the spectrum saw it
  double a = 0.0;
  double b = 0.0;
  Form form = kSame;
};

/// The rows as they are fitted.
struct Data {
  double low = 0.0;       ///< [m]
  double length = 0.0;    ///< of the travel [m]
  double middle = 0.0;    ///< [m]
  double shortest = 0.0;  ///< period that is looked for [m]
  double longest = 0.0;   ///< [m]
  bool both = false;      ///< directions
  bool standstill = false;
  std::vector<Group> groups;
  std::vector<Pass> passes;
  VectorXd root;       ///< of the weights
  MatrixXd basis;      ///< of the polynomials, by pass
  VectorXd e;          ///< weighted, without the polynomials
  double total = 0.0;  ///< |e|²
};

/// Frequencies of the spectrum and where the groups lie in it.
struct Grid {
  double spread = 0.0;   ///< length of a travel covered evenly that would tell periods as well [m]
  std::size_t size = 0;  ///< of the transformation
  double step = 0.0;     ///< of frequency [1/m]
  std::size_t lowest = 1;
  std::size_t highest = 1;
  std::vector<std::size_t> bin;
  std::array<std::vector<Complex>, 2> weight;
  mutable Eigen::FFT<double> fft;
};

/// What the terms leave, and its spectrum.
struct Residual {
  VectorXd e;
  std::array<std::vector<double>, kForms> power, amplitude, background, lines;
};

// periodic_rows.cpp
/// Refuses columns that do not belong together; false, with a note, where the rows show no period.
bool measure(const PeriodicRows& rows, const PeriodicOptions& options, Data& data, PeriodicResult& result);
/// Rows of one pass over a short travel become one group; false, with a note, where these are too few.
bool join(const PeriodicRows& rows, Data& data, PeriodicResult& result);
/// Tapers, and an orthonormal basis of the polynomial of each pass under the weights.
void prepare_passes(Data& data);
/// Takes the polynomials out of a weighted column.
void project(const Data& data, Eigen::Ref<VectorXd> column);

// periodic_spectrum.cpp
inline constexpr int kHighestHarmonic = 12;

Grid frequencies(const Data& data);
/// Power that a term takes out of the residual, and its amplitude, in both forms.
void spectrum(const Data& data, const Grid& grid, Residual& left);
/// The candidate that is tried next; none when nothing stands out.
std::optional<Line> strongest(const Data& data, const Grid& grid, const Residual& left,
                              const PeriodicOptions& options, const std::vector<Line>& found,
                              const std::vector<double>& rejected, bool any);
/// Mean power of the residual around a term, and from how many lines of the spectrum it is taken.
std::pair<double, double> local(const Data& data, const Grid& grid, const Residual& left, const Line& line,
                                std::size_t form);
/// Whether a term stands out of the background beside it when that term is taken out.
bool stands(const Data& data, const Grid& grid, const Residual& left, const Line& line);

// periodic_fit.cpp
/// Share of the amplitude that is left after a group's mean is taken.
double damping(const Group& group, double f);
/// Weighted, projected columns sin, cos and, with amplitudes, ∂/∂f of a term.
void columns(const Data& data, const Line& line, Eigen::Ref<MatrixXd> out, bool slope);
/// All terms together, their periods too unless `exact`; false when one runs away. Leaves what they leave in `e`.
bool refine(const Data& data, bool exact, double tolerance, std::vector<Line>& lines, VectorXd& e);

// periodic_result.cpp
/// The spectrum at most 400 lines long, each the largest of its neighbourhood.
void write_spectrum(const Grid& grid, const Residual& left, PeriodicResult& result);
/// Terms with intervals; `left` is what they leave.
void report(const Data& data, const Grid& grid, const Residual& left, const PeriodicOptions& options,
            const std::vector<Line>& found, PeriodicResult& result);
/// What rows without any term do not determine.
void report_none(const Data& data, PeriodicResult& result);

}  // namespace stribeck::ident::map::periodic
