#pragma once
/// The identification half of `stribeck reproduce`: tables and figures of chapter 2 and of §4.4.1, §4.4.2,
/// from logs of the virtual machines alone.
///
///   ident-A   pulses: unbiased against simple least squares; jogs       Table 2.1, figs 2.11, 2.13
///   ident-B   jogs, nonlinear fit, mass from a sine                     Tables 2.2, 4.2, figs 2.14, 4.4
///   ident-C   velocity–friction map, Gaussians                          Table 2.3, fig 2.20
///   ident-D   position–friction map, eccentric term                     Tables 2.4, 4.3, figs 2.28, 2.29
///   verify    driven with the measured force of an unseen run           figs 2.30, 2.31
///
/// The true parameters of the machine are shown beside the results; they enter none of them.
///
/// Real time: no.
/// Errors: ident::Refused.

#include <cstdint>
#include <stribeck/report/pages/reproduction.hpp>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// Sections in the order of `ids`; v2 is the biaxial table, v3 the triaxial machine tool. The result does not depend on the
/// number of threads (0: as many as the computer has).
std::vector<report::ReproducedSection> reproduce_identification(const std::vector<std::string>& ids,
                                                                const sim::Machine& v2,
                                                                const sim::Machine& v3, std::uint64_t seed,
                                                                unsigned threads);

}  // namespace stribeck::workflow
