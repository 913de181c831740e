#pragma once
/// --to moteus: terms periodic in the motor's turn as the cogging table of a moteus controller.
///
///   i(x) = scale·((1 − s)·c[k] + s·c[k+1])     1024·(x − x0)/lead = k + s, c from −127 to 127, in A of the q axis
///
/// x0 is the position of the axis at which the encoder of the motor reads zero. Source: motor.cogging_dq_scale and
/// motor.cogging_dq_comp of the moteus firmware, which adds i to the current in position mode by the commutation encoder.
/// Not modelled: terms that change their sign with the velocity, periods that are no whole part of the lead.
///
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <stribeck/targets/target.hpp>

namespace stribeck::targets {

struct MoteusText {
  std::string text;
  std::string words;
  nlohmann::ordered_json axes;
};
MoteusText moteus_text(const ExportRequest& request);

/// What the options of --to all lack for it, in a few words; empty: nothing.
std::string moteus_lacks(const ExportRequest& request);

}  // namespace stribeck::targets
