#pragma once
/// G-code through LinuxCNC's own stand-alone interpreter, run as a separate program: rs274 -g PROGRAM.
///
/// The interpreter begins at x = y = z = 0 in millimetres without offsets and reads no variables. Its tools 1 to 999 have no
/// length and no radius; G43.1 sets lengths. Subroutines in files are searched in the working directory. Its output is read line by
/// line and not stored. The interpreter ends with this program, however this program ends, and after 200 000 lines without a motion.
/// Real time: no.
/// Errors: InputError with the line of the program where the interpreter names one; how to install it where it is missing.

#include <optional>
#include <stribeck/io/gcode/canonical.hpp>
#include <string>
#include <vector>

namespace stribeck::io {

struct InterpreterOptions {
  std::string command = "rs274";  ///< looked for in PATH
  double seconds = 120.0;         ///< time limit, also of the processor time
  double silent_seconds = 15.0;   ///< time limit for the next line
};

struct PartProgram {
  std::vector<CanonicalMove> moves;
  bool inches = false;  ///< places are known to 2.54 µm only
  bool tools = false;   ///< tools or their offsets were used; they have length and radius 0
  std::optional<ForeignFeed> foreign_feed;
};

PartProgram read_part_program(const std::string& file, const InterpreterOptions& options = {});

}  // namespace stribeck::io
