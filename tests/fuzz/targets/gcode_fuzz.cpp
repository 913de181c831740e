// The calls that LinuxCNC's interpreter prints: finite moves, or an InputError with the program.
#include <cmath>
#include <stribeck/io/gcode/canonical.hpp>
#include <tests/fuzz/targets/log_checks.hpp>

namespace stribeck::fuzz {

std::vector<std::string> seeds() {
  return {
      "    1 N..... USE_LENGTH_UNITS(CANON_UNITS_MM)\n    2 N..... SET_G5X_OFFSET(1, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "    3 N..... SET_G92_OFFSET(0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n    4 N..... SET_XY_ROTATION(30.0000)\n"
      "    5 N..... SET_FEED_REFERENCE(CANON_XYZ)\n    6 N..... ON_RESET()\n    7 N..... SELECT_TOOL(5)\n    8 N..... START_CHANGE()\n"
      "    9 N..... CHANGE_TOOL(5)\n   10 N..... SET_FEED_RATE(60.0000)\n"
      "   11 N..... STRAIGHT_TRAVERSE(1.0000, 2.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "   12 N..... STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "   13 N..... SELECT_PLANE(CANON_PLANE_XY)\n"
      "   14 N..... ARC_FEED(10.0000, 0.0000, 0.0000, 0.0000, 1, 0.0000, 0.0000, 0.0000, 0.0000)\n"
      "   15 N..... DWELL(0.5000)\n   16 N..... SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.0010)\n"
      "   17 N..... SET_FEED_MODE(0, 0)\n   18 N..... STOP_SPINDLE_TURNING(0)\n   19 N..... PROGRAM_END()\n"};
}

std::vector<std::string> words() {
  return {"USE_LENGTH_UNITS(CANON_UNITS_INCHES)",
          "SELECT_PLANE(CANON_PLANE_XZ)",
          "SELECT_PLANE(CANON_PLANE_YZ)",
          "ARC_FEED(",
          "STRAIGHT_FEED(",
          "STRAIGHT_TRAVERSE(",
          "SET_FEED_RATE(",
          "DWELL(",
          "NURBS_FEED(",
          "SET_TOOL_LENGTH_OFFSET(",
          "SET_XY_ROTATION(",
          "N..... ",
          ", "};
}

void one(std::string_view input) {
  io::CanonicalReader reader("fuzz.ngc");
  try {
    while (!input.empty()) {
      const std::size_t end = std::min(input.find('\n'), input.size());
      reader.line(input.substr(0, end));
      input.remove_prefix(std::min(end + 1, input.size()));
    }
  } catch (const io::InputError& e) {
    check(e, "fuzz.ngc");
  }
  for (const io::CanonicalMove& m : reader.moves()) {
    for (std::size_t i = 0; i < 3; ++i)
      demand(std::isfinite(m.to[i]) && std::isfinite(m.centre[i]) && std::isfinite(m.normal[i]),
             "a place that is not finite");
    demand(m.feed > 0.0 && std::isfinite(m.dwell) && m.dwell >= 0.0, "a feed or a dwell that cannot be");
  }
}

}  // namespace stribeck::fuzz
