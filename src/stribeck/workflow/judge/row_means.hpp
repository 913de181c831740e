#pragma once
/// Logs of slow rows whose force is the mean over each row, as the trends of a PLC are: the mean over two rows beside a measured
/// acceleration smooths the force more than the acceleration, and the mass comes out 3 % too small with rows of 100 ms.
///
///   f_k − (f_{k−1} − 2·f_k + f_{k+1})/12
///
/// Two neighbours of this together spread a force as the second difference of the position spreads an acceleration (variance T²/6 about
/// their middle, T the time between rows; the means alone T²/3).
///
/// Means are believed where the force is half a row late and the mended force leaves less on held-out motion. Inside workflow only. Real
/// time: no. Errors: those of the method.

#include <optional>
#include <stribeck/workflow/judge/diagnosis.hpp>

namespace stribeck::workflow {

/// The same logs with that force; absent where the force of `found` is no mean over rows, or the rows are short.
std::optional<AxisRecords> without_row_means(const AxisRecords& logged, const Identification& found,
                                             const Identify& method);

}  // namespace stribeck::workflow
