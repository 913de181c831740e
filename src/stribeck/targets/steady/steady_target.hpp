#pragma once
/// Targets that hold the steady friction of an axis: tables of a control, source code, models of simulators.
///
/// Such a target is one source file with a function that turns an Axis into a Form. What all of them share stands here: reading the
/// axis files, the options, the error that the form makes, and writing the file.
///
///   write(axis)   the text, and the friction that the target will give, held(v), after its rounding
///   error         |held(v) − F(v)|, largest and RMS, over speeds from the slowest to the fastest in both directions
///
/// Forces [N], velocities [m/s]. Load and mass are written where the target has a place for them; periodic terms and pre-sliding only
/// where the form says so. What it leaves out is told.
///
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <functional>
#include <optional>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/friction/drive_numbers.hpp>
#include <stribeck/targets/pulse/table_force.hpp>
#include <stribeck/targets/target.hpp>
#include <string>
#include <vector>

namespace stribeck::targets {

struct PulseTask;

/// One axis on its way into another program.
struct Axis {
  std::string name;
  std::string file;
  std::string said;  ///< what the file calls the axis; empty: it does not say it
  friction::AxisModel model;
  bool rotary = false;      ///< carried at a radius of 1 m
  double slowest = 0.0;     ///< smallest speed that counts [m/s]
  double fastest = 0.0;     ///< [m/s]; 0: not known
  double identified = 0.0;  ///< speed up to which both directions were identified [m/s]; 0: not known
  double widest = 0.0;      ///< the same of the direction that goes farther
  double told_from = 0.0;   ///< smallest speed whose friction the logs tell [m/s]; 0: not known
  std::size_t number = 0;   ///< of the axis in a control, see axis_numbers()
  double gain = 1.0;        ///< force of one unit of the control [N]; NaN: not given
  std::string unit;         ///< name of that unit: "%", "A"
  double lead = 0.0;        ///< travel per turn of the motor [m]; NaN: not given
  double resolution = 0.0;  ///< step of the encoder [m]; NaN: not given
  std::optional<friction::DriveNumbers> drive{};  ///< as its file says; absent: it does not
  std::optional<double> control_period{};         ///< the same [s]

  /// Steady friction without load and periodic terms [N].
  [[nodiscard]] double friction(double v) const noexcept;
};

/// What the target was given of one axis.
struct Form {
  std::string text;
  std::function<double(double)> held;  ///< its friction [N] at a velocity [m/s]
  double from = 0.0;      ///< below this speed it passes through zero, and no error is told [m/s]
  bool periodic = false;  ///< terms periodic in position are in it
  bool pre_sliding = false;
  std::optional<friction::BuildUp>
      bristles{};     ///< with which its code lets the friction build up after a reversal
  bool mass = false;  ///< the mass is in it
  bool load = false;
  std::string to_do;  ///< where it is typed, and what to check first
};

struct SteadyText;

/// All axes in the file of a target that is not their texts, one after the other.
struct Packed {
  std::string bytes;
  std::string words;  ///< what is in it; empty: nothing to tell
};

/// A file that a target writes beside that of the axes, the same for all axes.
struct Beside {
  std::string_view name;
  std::string_view text;
};

/// What a target needs beside the axis file.
enum class SteadyNeeds { kNothing, kGain, kGainAndLead, kLead };

/// The unit in which the control counts; --gain is brought to it.
enum class GainUnit {
  kAny,
  kPercent,   ///< of the rated torque or current
  kPerMille,  ///< the same
  kBits,      ///< of a converter of 16 bits: 32 767 are 100 %, and 10 V
};

struct SteadyTarget {
  std::string_view name;
  std::string_view what;       ///< what is written, in a few words
  std::string_view comment{};  ///< begins a comment line: "#"; "(*" is closed with "*)"
  SteadyNeeds needs = SteadyNeeds::kNothing;
  Form (*write)(const Axis&);
  std::string_view extension = ".txt";  ///< of the file in the folder of --to all
  std::string_view begin{};             ///< lines around those of all axes
  std::string_view end{};
  /// Makes the file from the axes, what is known of them so far, and the typed command; null: the file is the texts of the axes, one
  /// after the other.
  Packed (*pack)(const std::vector<Axis>&, const SteadyText&, const std::string& command) = nullptr;
  bool simulator = false;  ///< no force of a control comes from it
  /// Lines for the way in which the force comes and goes around a reversal, which are found where --controller tells the loop; rounds it
  /// to what the lines say. Null: the control has none.
  std::string (*build_up)(TableForce&, double period) = nullptr;
  /// Also without such lines, --controller has the contour error on a circle predicted.
  bool on_circle = false;
  /// Lines before those of the axes that depend on all of them; null: none.
  std::string (*head)(const std::vector<Axis>&) = nullptr;
  /// Refuses names of axes that the target cannot hold beside each other; null: it holds all.
  void (*check_names)(const std::vector<Axis>&) = nullptr;
  std::optional<Beside> beside{};
  bool takes_gain = false;   ///< --gain may be given, though nothing needs it
  bool takes_lead = false;   ///< the same of --lead
  bool encoder = false;      ///< takes the step of the encoder
  bool linear_only = false;  ///< has no place for a rotary axis
  GainUnit counts = GainUnit::kAny;

  [[nodiscard]] bool needs_gain() const {
    return needs == SteadyNeeds::kGain || needs == SteadyNeeds::kGainAndLead;
  }
  [[nodiscard]] bool takes_circle() const { return build_up != nullptr || on_circle; }
  [[nodiscard]] bool needs_lead() const {
    return needs == SteadyNeeds::kLead || needs == SteadyNeeds::kGainAndLead;
  }
};

/// All of them, in the order of help.
std::span<const SteadyTarget* const> steady_targets();

/// Writes all axes of the request into one file.
Exported write_steady(const SteadyTarget& target, const ExportRequest& request);

/// Writes the file that goes with that of the axes into the same folder. One that is there and differs is kept. Returns its path and what
/// was done, in a sentence; empty texts where the target has none.
struct WrittenBeside {
  std::string file;
  std::string words;
};
WrittenBeside write_beside(const SteadyTarget& target, const std::string& output);

/// The bytes of that file, what is in it, and the errors of all axes.
struct SteadyText {
  std::string text;
  nlohmann::ordered_json json;
  std::string words;
  std::vector<TableForce> tables;  ///< what the target gives, for each axis
  nlohmann::ordered_json circle;   ///< prediction, where the target has one of its own
};
SteadyText steady_text(const SteadyTarget& target, const ExportRequest& request);

/// The axes of the request with gain, lead and step of the encoder, without speeds.
std::vector<Axis> axes_of(const ExportRequest& request);

/// The circle of the request for these targets; absent without --controller.
std::optional<PulseTask> circle_task(std::string_view target, const ExportRequest& request);

/// Refuses the options that only --to linuxcnc takes.
void refuse_linuxcnc_options(const ExportRequest& request);

}  // namespace stribeck::targets
