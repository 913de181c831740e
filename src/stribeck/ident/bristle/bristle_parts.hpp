#pragma once
/// Inside of bristle_fit.hpp: the values that each step hands to the next, from the logs to the result.
///
///   bristle_path.cpp    the rows near reversals, with sub-steps and window
///   bristle_model.cpp   residuals of each law over them
///   bristle_solve.cpp   least squares, covariance, prediction of what was left out
///   bristle_laws.cpp    fit of each law: starts, priors, damping that does not differ from zero
///   bristle_part.cpp    GMS judged on a part of many reversals
///   bristle_report.cpp  parameters with intervals; what was determined, or why nothing
///   bristle_fit.cpp     order of these steps, choice between the laws
///
/// Inside ident only: includes Eigen. Real time: no.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/bristle/bristle_fit.hpp>
#include <stribeck/ident/bristle/bristle_model.hpp>
#include <stribeck/ident/bristle/bristle_path.hpp>
#include <stribeck/ident/bristle/bristle_solve.hpp>
#include <stribeck/ident/shown.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::bristle {

/// Units of the log.
struct Units {
  std::string length;
  std::string force;

  [[nodiscard]] std::string shown_length() const { return length == "m" ? "mm" : length; }
};

/// All that is known before anything is fitted.
struct Given {
  const std::vector<log::Record>* records = nullptr;
  const friction::AxisModel* known = nullptr;
  BristleOptions options;
  BristleData data;
  Units units;
  Shown shown;           ///< for sentences
  bool open = true;      ///< every log is open loop
  double stroke = 0.0;   ///< [m]
  double quantum = 0.0;  ///< step of the encoder, from its noise [m]
  double level = 0.0;    ///< friction at rest, mean of the directions [N]
};

/// The rows that are fitted, and the scales of the parameters. `setting` points to the path beside it.
struct Rows {
  BristlePath path;
  Setting setting;
  std::vector<char> every_row;
  double noise = 1.0;  ///< standard deviation of a row [N]

  Rows() = default;
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;
};

/// A fitted law, with everything that is needed to judge it.
struct Fitted {
  Solution solution;
  std::vector<Index> free;
  Prior prior;
  Spread spread;
  int own = 0;
  double break_away = 0.0;
  double half = 0.0;  ///< 95 % half width of the logarithm of the break-away distance
};

// bristle_laws.cpp
/// Whether the damping (parameter number `damping`) was found above zero.
inline bool has_damping(const Fitted& f, Index damping) { return f.solution.p(damping) > 0.0; }
/// Repeats the fit of LuGre from the first guess on: the pieces are cut by the break-away distance that the fit before found.
/// Returns an empty text, or why LuGre could not be fitted.
std::string fit_lugre(const Given& given, double guess, Rows& rows, Fitted& lugre);
Fitted fit_static(const Given& given, const Rows& rows);
/// Starts from the solution of LuGre. Empty where no start converges.
std::optional<Fitted> fit_gms(const Given& given, const Rows& rows, const Fitted& lugre);
inline Index gms_damping(int elements) { return 2 * elements; }

// bristle_part.cpp
/// Pairs of neighbouring pieces, spread evenly, so that both directions are there: about `most` rows. No piece with an
/// unknown start.
BristlePath part_of(const BristlePath& from, std::size_t most);
/// The pairs with the fewest rows: at least `least_pieces` pieces if there are so many, then about `most` rows. For logs with
/// jogs so slow that one piece holds more rows than all others together.
BristlePath shortest_of(const BristlePath& from, std::size_t most, std::size_t least_pieces);
/// Each piece cut behind a stretch, so that about `most` rows are left; at least four stretches of each. For long motion without
/// sliding in between, such as that after programmed forces, which is one piece.
BristlePath shortened(const BristlePath& from, std::size_t most);
/// A part of many reversals with what is known of the law, without the unknown starts. False: the whole is cheap enough.
bool lay_part(const Rows& rows, const Fitted& lugre, Rows& part, Fitted& few);
/// GMS as a candidate where a part of many reversals shows clearly that it predicts worse than LuGre: the fit over all of
/// them, ten times as long as the rest, tells nothing more. Its RMS and error are shares of those of LuGre. Empty: it
/// must be fitted.
std::optional<Candidate> gms_refused(const Given& given, const Rows& rows, const Fitted& lugre);

// bristle_report.cpp
void report_lugre(const Given& given, const Rows& rows, Fitted& lugre, BristleFit& out);
/// Whether no law could be told from this log, whatever GMS says: after report_lugre(), with out.rows_per_reversal.
bool beyond_any_law(const Given& given, const Fitted& lugre, const BristleFit& out);
void report_gms(const Given& given, const Rows& rows, Fitted& gms, BristleFit& out);
/// Writes what the chosen law says, or why this log does not determine it. `best` and `chosen` are indices of models.
void answer(const Given& given, const Rows& rows, const Fitted& law, std::size_t best, std::size_t chosen,
            BristleFit& out);

}  // namespace stribeck::ident::bristle
