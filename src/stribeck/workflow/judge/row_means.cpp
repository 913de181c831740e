#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <stribeck/ident/residual/residual.hpp>
#include <stribeck/workflow/judge/row_means.hpp>

namespace stribeck::workflow {
namespace {

constexpr double kSlowRows = 5e-3;        // [s]: in shorter ones no acceleration changes much
constexpr double kHalfARow = 0.15;        // by which the shift may be off
constexpr double kMeansAreBetter = 0.95;  // of the error on held-out motion

void take_off_means(std::vector<double>& f) {
  const std::vector<double> logged = f;
  for (std::size_t k = 1; k + 1 < f.size(); ++k)
    f[k] -= (logged[k - 1] - 2.0 * logged[k] + logged[k + 1]) / 12.0;
}

}  // namespace

std::optional<AxisRecords> without_row_means(const AxisRecords& logged, const Identification& found,
                                             const Identify& method) {
  const double period = logged.records.front().sample_time;
  if (found.result.filter || found.result.given_shift || period < kSlowRows) return {};
  if (std::abs(ident::residual::shift_in_rows(found.result, period) - 0.5) > kHalfARow) return {};
  AxisRecords mended = logged;
  for (ident::log::Record& r : mended.records) take_off_means(r.f);
  const double before = method(logged, Depth::kSteady).result.held_out_rms;
  const double after = method(mended, Depth::kSteady).result.held_out_rms;
  if (!(after < kMeansAreBetter * before)) return {};
  return mended;
}

}  // namespace stribeck::workflow
