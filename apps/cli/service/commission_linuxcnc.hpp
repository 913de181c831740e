#pragma once
/// `commission --linuxcnc`: the dialogue with the person at a running machine.
/// Real time: no. Errors: InputError, commissioning::Stopped becomes exit code 1.

#include <apps/cli/shared.hpp>
#include <stribeck/workflow/commissioning/commissioning.hpp>

namespace stribeck::cli {

struct RunningArguments {
  workflow::commissioning::Options what;
  bool yes = false;   ///< motions begin without a question
  bool undo = false;  ///< gives back what was changed, and ends
};

int commission_running(const Common& common, const RunningArguments& arguments);

}  // namespace stribeck::cli
