#pragma once
/// Words on a drive that takes a velocity or a position as its command, beside which a force has another place.
/// Real time: no.

#include <fmt/format.h>
#include <stribeck/core/fields.hpp>
#include <stribeck/targets/steady/steady_target.hpp>
#include <string>

namespace stribeck::targets {

/// What the force of an export is added to: `usual`, or the force offset of a drive that takes no force.
inline std::string place_of_force(const Axis& axis, const char* usual) {
  return axis.model.drive_loop ? "the force (torque) offset of the drive" : usual;
}

/// A sentence, begun with a space, for a drive that takes no force as its command; empty: it takes one.
inline std::string words_of_drive_loop(const Axis& axis) {
  const auto& loop = axis.model.drive_loop;
  if (!loop) return {};
  std::string words = fmt::format(
      " {} says that the drive of axis {} takes a {} (drive_loop): a force must not be added to that command, it goes to the force "
      "(torque) offset of the drive.",
      axis.file, axis.name, enum_name(loop->mode));
  if (loop->force_offset) return words;
  words += " The file says that the drive has no such offset (drive_loop.force_offset): check it";
  return words + (loop->mode == friction::DriveMode::kVelocity
                      ? "; without one --to pid writes the velocity that makes the force."
                      : ".");
}

}  // namespace stribeck::targets
