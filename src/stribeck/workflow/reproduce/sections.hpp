#pragma once
/// The sections on identification, each from the studies of the axes of one machine.
/// Real time: no.

#include <stribeck/workflow/reproduce/axis_study.hpp>
#include <stribeck/workflow/reproduce/drawing.hpp>
#include <vector>

namespace stribeck::workflow::reproduction {

ReproducedSection section_a(const std::vector<Study>& all);
/// Sections of the biaxial table, and of the triaxial machine tool.
ReproducedSection section_b_table(const std::vector<Study>& all);
ReproducedSection section_b_tool(const std::vector<Study>& all);
ReproducedSection section_c(const std::vector<Study>& all);
ReproducedSection section_d(const std::vector<Study>& all);
ReproducedSection section_verify(const Study& study);

}  // namespace stribeck::workflow::reproduction
