#pragma once
/// Options of the targets with a pulse, which the others refuse.
/// Real time: no.

#include <stribeck/targets/target.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::targets {

inline void refuse_pulse_options(const ExportRequest& o) {
  const auto refuse = [](const char* option) {
    workflow::refuse_option(
        option,
        "applies only to --to sinumerik, tnc and fanuc, and with --controller also to isg, c, structured-text, cia402 and all");
  };
  if (!o.controller.empty()) refuse("--controller");
  if (!o.machine.empty()) refuse("--machine");
  if (!o.period.empty()) refuse("--period");
  if (!o.size.empty()) refuse("--size");
}

}  // namespace stribeck::targets
