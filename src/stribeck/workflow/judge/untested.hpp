#pragma once
/// What a log cannot test of a model, however well the model fits it.
///
///   mass        an error of it by the share s makes s·m·a of the force: a log hardly tests it where s = 30 % makes less than the limit
///               of "good"
///   direction   a log that moves one way alone tells nothing of the friction of the other
///
/// a is the second difference of the position over 10 ms, so that steps of an encoder count little.
/// Not modelled: friction at speeds that the log does not reach.
/// Real time: no. Errors: none.

#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/log/record.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// A sentence for each; `good`: the limit of the error of the force [%].
std::vector<std::string> untested_in_words(const std::string& file, const friction::AxisModel& model,
                                           const ident::log::Record& record, double good);

}  // namespace stribeck::workflow
