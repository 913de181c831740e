#pragma once
/// The lines between the board and a controller that is a program. SI units, decimal point, numbers that read back bit for bit.
///
///   board → program, once:   stribeck-board 1
///                            axes 2
///                            period T
///                            axis I mass M load L delay D force_limit F resolution R stiffness S damping B
///                            friction I N V1 F1 … VN FN      steady friction of the model at ascending speeds, without load
///                            model I FILE                     the whole model as an axis file
///                            start
///   program → board, once:   ready
///   each period:             t  r1 v1 a1 x1  r2 v2 a2 x2     →     f1 f2
///                            time; reference position, velocity, acceleration and measured position of each axis → forces
///   at the end:              end
///
/// stiffness and damping: of pre-sliding, 0 where the model has none. Forces beyond ±force_limit are cut and counted.
/// Real time: no. Errors: ProgramFailed for an answer that is none; std::runtime_error from parse_setup().

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::workflow {

/// What a controller may know of an axis: the model that the board identified, and name plates.
struct BoardAxis {
  double mass = 0.0;               ///< [kg]
  double load = 0.0;               ///< [N]
  double delay = 0.0;              ///< [s]
  double force_limit = 0.0;        ///< [N]
  double resolution = 0.0;         ///< [m]
  double stiffness = 0.0;          ///< [N/m]
  double damping = 0.0;            ///< [N·s/m]
  std::vector<double> speed{};     ///< [m/s]
  std::vector<double> friction{};  ///< [N]
  std::string model_file{};
};

struct BoardSetup {
  double period = 0.0;  ///< [s]
  std::vector<BoardAxis> axes;
};

std::string setup_lines(const BoardSetup& setup);
/// Reads one of these lines; false after "start".
bool read_setup_line(std::string_view line, BoardSetup& setup);

/// As many finite numbers as `out` has, separated by blanks; false where the line holds anything else.
bool read_numbers(std::string_view line, double* out, std::size_t count);

}  // namespace stribeck::workflow
