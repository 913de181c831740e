#pragma once
/// The forces of an axis with several motors, such as the two sides of a gantry. Inside of the choice of the effort (effort.hpp).
///
/// Real time: no.
/// Errors: InputError naming the option.

#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/effort.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

/// The scale of a machine file is that of all motors together. Columns of each are averaged; one column stands for all, or is their
/// sum where its name says so.
void take_all_motors(Effort& e, const AxisColumns& columns, int motors, std::vector<std::string>& notes);

/// A gain of the command line is one of a single column: a note where the other motor of a gantry is left out.
void note_second_motor(const Effort& e, const AxisColumns& columns, int motors,
                       std::vector<std::string>& notes);

}  // namespace stribeck::workflow
