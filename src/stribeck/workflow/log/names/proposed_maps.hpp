#pragma once
/// Options that a user can copy where a log lacks units or names.
///
/// Real time: no.

#include <stribeck/io/log/log.hpp>
#include <string>
#include <string_view>

namespace stribeck::workflow {

/// `--map x="y_act mm"`, in quotes that the name itself does not have, so that a shell keeps it.
std::string map_option(std::string_view what, const std::string& column);

/// `--map t="time s" --map x="y_act mm" --map force="y_force N"`: what the names suggest, with the unit of the file or else a usual one;
/// "" where time, position and force of the axis cannot be guessed. `axis`: "" where the log has one.
std::string proposed_maps(const io::Log& log, const std::string& axis);

/// The axis that the name of a column tells, in lower case; "" where it tells none.
std::string axis_in_name(const io::Column& column);

}  // namespace stribeck::workflow
