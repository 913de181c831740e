#pragma once
/// Inside of periodic.hpp: the values that each step hands to the next, from the rows to the terms.
///
///   periodic_rows.cpp      rows → Data: groups, passes, weights; removes a polynomial from each pass
///   periodic_spectrum.cpp  Data, residual → Residual: power at every frequency, its background, candidates
///   periodic_fit.cpp       all terms together, by Gauss–Newton
///   periodic_result.cpp    terms with intervals, harmonics, what cannot be determined
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
  double spread = 0.0;  ///< variance of x inside the group
  double e = 0.0;       ///< mean
  double blur = 0.0;    ///< mean [m]
  double weight = 0.0;  ///< rows, tapered
  double sign = 1.0;    ///< −1 for backward motion
};

/// A stretch of one direction.
struct Pass {
  std::size_t first = 0;
  std::size_t last = 0;  ///< index after the last one
};

/// A term during the fit: a·sin(2πf·u) + b·cos(2πf·u), u measured from the middle of the travel.
struct Line {
  double f = 0.0;
  double start = 0.0;  ///< frequency at which the spectrum showed it
  double a = 0.0;
  double b = 0.0;
  Form form = kSame;
  bool exact = false;  ///< f is known
};

/// The rows as they are fitted.
struct Data {
  double low = 0.0;       ///< [m]
  double length = 0.0;    ///< of the travel [m]
  double middle = 0.0;    ///< [m]
  double shortest = 0.0;  ///< shortest period that is searched [m]
  double longest = 0.0;   ///< [m]
  bool both = false;      ///< the rows have both directions
  bool standstill = false;
  Shown shown = {};
  log::Passed passed = nullptr;  ///< as in PeriodicRows
  std::vector<Group> groups;
  std::vector<Pass> passes;
  VectorXd root;       ///< square roots of the weights
  MatrixXd basis;      ///< of the polynomials of all passes
  VectorXd e;          ///< weighted residual, without the polynomials
  double total = 0.0;  ///< |e|²
};

/// Frequencies of the spectrum, and the position of each group.
struct FrequencyGrid {
  double spread = 0.0;   ///< length of an evenly covered travel that would resolve periods equally well [m]
  std::size_t size = 0;  ///< of the transformation
  double step = 0.0;     ///< of frequency [1/m]
  std::size_t lowest = 1;
  std::size_t highest = 1;
  std::vector<std::size_t> bin;
  std::array<std::vector<Complex>, 2> weight;
  mutable Eigen::FFT<double> fft;
};

/// Residual beside the terms, and its spectrum.
struct Residual {
  VectorXd e;
  std::array<std::vector<double>, kForms> power, amplitude, background, lines;
};

// periodic_rows.cpp
/// Refuses columns that do not belong together. Returns false, with a note, where the rows cannot show a period.
/// `behind`: the low-pass of the log counts.
bool measure(const PeriodicRows& rows, const PeriodicOptions& options, bool behind, Data& data,
             PeriodicResult& result);
/// Joins rows of one pass over a short travel to one group. Returns false, with a note, where these are too few.
bool join(const PeriodicRows& rows, Data& data, PeriodicResult& result);
/// Computes tapers, and an orthonormal basis of the polynomial of each pass under the weights.
void prepare_passes(Data& data);
/// Removes the polynomials from a weighted column.
void project(const Data& data, Eigen::Ref<VectorXd> column);

// periodic_spectrum.cpp
inline constexpr int kHighestHarmonic = 12;

FrequencyGrid frequencies(const Data& data);
/// Reduction of the residual's power by a term, and its amplitude, in both forms.
void spectrum(const Data& data, const FrequencyGrid& grid, Residual& left);
/// The candidate that is tried next; absent when nothing stands out. `apart`: least distance from a term of its form [1/travel].
std::optional<Line> strongest(const Data& data, const FrequencyGrid& grid, const Residual& left,
                              const PeriodicOptions& options, const std::vector<Line>& found,
                              const std::vector<double>& rejected, bool any, double apart = 2.0);
/// Mean power of the residual around a term, and the number of lines of the spectrum that the mean is taken over.
std::pair<double, double> local(const Data& data, const FrequencyGrid& grid, const Residual& left,
                                const Line& line, std::size_t form);
/// Whether a term stands out of the background beside it when the term itself is removed.
bool stands(const Data& data, const FrequencyGrid& grid, const Residual& left, const Line& line);

// periodic_fit.cpp
/// Share of the amplitude that remains in the mean of a group; 0 where the low-pass of the log leaves next to nothing.
double damping(const Data& data, const Group& group, double f);
/// Weighted, projected columns sin, cos and, with amplitudes, ∂/∂f of a term.
void columns(const Data& data, const Line& line, Eigen::Ref<MatrixXd> out, bool slope);
/// Fits all terms together, with the periods that are not exact; false when one diverges. Writes the residual into `e`.
bool refine(const Data& data, double tolerance, std::vector<Line>& lines, VectorXd& e);
/// A known period has no column of its own: makes row and column of that unknown those of a unit matrix. The period of line j is the unknown
/// first + j·stride.
void hold_exact(const std::vector<Line>& lines, MatrixXd& gram, Index first, Index stride);

// periodic_result.cpp
/// The spectrum in at most 400 lines, each the largest of its neighbourhood.
void write_spectrum(const FrequencyGrid& grid, const Residual& left, PeriodicResult& result);
/// Terms with intervals; `left` is their residual.
void report(const Data& data, const FrequencyGrid& grid, const Residual& left, const PeriodicOptions& options,
            const std::vector<Line>& found, PeriodicResult& result);
/// A line that does not count, but is stronger than all terms that do; false: there is none.
bool note_rejected(const Data& data, const FrequencyGrid& grid, const Residual& left,
                   const std::vector<Line>& found, const std::vector<double>& rejected,
                   PeriodicResult& result);
/// What rows that show no term leave undetermined.
void report_none(const Data& data, PeriodicResult& result);

}  // namespace stribeck::ident::map::periodic
