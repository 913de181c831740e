#pragma once
/// Shows what a log contains and which parameters can be identified from it, for `identify --inspect LOG`. It identifies nothing and
/// refuses nothing: the reason why a log cannot be used is part of the answer.
/// docs/reference/json.md has every key. Real time: no.

#include <nlohmann/json.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <string>

namespace stribeck::workflow {

struct Inspection {
  std::string text;  ///< as text for people
  nlohmann::ordered_json json;
  bool usable = false;  ///< it contains records that can be used
};

Inspection inspect(const io::Log& log, const LogOptions& options);

}  // namespace stribeck::workflow
