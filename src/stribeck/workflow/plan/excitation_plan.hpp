#pragma once
/// Which logs to record of an axis, chosen by what is wanted of it: `stribeck excite --for`.
///
///   every method is tried on a virtual axis (plan/expected.hpp); the one that tells most of what is wanted comes first, of equals the
///   shorter one; then the one that adds most, until everything is narrow enough, the time is over, or nothing adds
///
/// Narrow enough: mass ± 2 %, friction ± 3 % from a tenth to half of the speed limit or beyond, break-away distance ± 20 %, delay ± a fifth of a period.
/// Real time: no.
/// Errors: InputError; ident::Refused where no method tells anything of what is wanted.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/workflow/plan/expected.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

struct PlanOptions {
  std::string machine;         ///< file
  std::string axis;            ///< name
  std::vector<Wanted> wanted;  ///< empty: everything
  double longest = 300.0;      ///< of all logs together [s]
  std::string known;           ///< axis file of an earlier identification; empty: none
};

struct ExcitationPlan {
  PlanOptions options;
  std::vector<CandidateLog> candidates;  ///< every method, alone
  std::vector<std::size_t> chosen;       ///< of them, in the order to record
  ExpectedHalf together;                 ///< what the chosen ones tell
  [[nodiscard]] double duration() const;
};

/// `progress`: (done, all) of the logs that are tried, alone and with others.
ExcitationPlan plan_excitation(const PlanOptions& options, const Progress& progress = {});

/// The command that plans the logs for what an identification left open, as a sentence; empty: nothing is open. The names of files are
/// printed as they come: quoted for a shell where they have to be.
std::string next_log(std::vector<Wanted> open, const ident::Result& r, const std::string& machine,
                     const std::string& axis, const std::string& axis_file);

/// As a table with a sentence for what stays open.
std::string text_of(const ExcitationPlan& plan);
nlohmann::ordered_json to_json(const ExcitationPlan& plan);

}  // namespace stribeck::workflow
