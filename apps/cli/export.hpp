#pragma once
/// What the verb export writes for LinuxCNC: lines of HAL for controllers, virtual drives and tables, and the whole
/// configuration of a machine.

#include <array>
#include <stribeck/friction/axis_model.hpp>
#include <stribeck/ident/nearest_polyline.hpp>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::cli {

/// The friction of an axis as the component lincurve can hold it: at most 16 points, straight lines between them.
struct Lincurve {
  ident::Polyline table;   ///< velocity [machine units/s], force [N]
  double max_error = 0.0;  ///< largest over the range [N]
  double rms_error = 0.0;  ///< over the range, every velocity counting alike [N]
};

/// The table nearest to the steady-state curve from −`fastest` to `fastest`, in the sense of the largest error (to some per cent, as
/// it is sampled), with as many points on each side as that takes; fewer than 16 where they are enough. At zero the curve jumps: two points 2·10⁻⁶ machine units/s apart, and at rest the mean of both sides.
/// Without load and without terms periodic in position, which a table of velocity cannot hold. `fastest` [m/s], `unit` [m].
Lincurve best_lincurve(const friction::AxisModel& model, double fastest, double unit);

/// What the table is worth, as a comment and as people read it; `unit` is that of its velocities.
std::string lincurve_words(const Lincurve& table, const friction::AxisModel& model, std::string_view unit);

/// setp lines of one instance of each component.
std::string controller_lines(const std::string& name, const friction::AxisModel& model, double omega,
                             const std::string& feedforward);
std::string plant_lines(const std::string& name, const sim::MachineAxis& axis);
std::string lincurve_lines(const std::string& name, const Lincurve& table);
std::string setp(const std::string& component, std::string_view parameter, double value,
                 std::string_view word = {});

/// By index, as the components take it.
inline constexpr std::array<std::string_view, 4> kFeedforward{"none", "steady", "dynamic", "reversal"};

/// What LinuxCNC may ask of an axis.
struct DrivableLimits {
  sim::AxisLimits
      limits;  ///< those of the machine file, with speed and acceleration that its drive can follow
  double friction = 0.0;  ///< most that friction and load take up to that speed [N]
  double force = 0.0;     ///< that the drive has at that speed [N]
};

/// Speed and acceleration at once: friction, terms periodic in position, load and mass times acceleration within nine tenths of the
/// drive's force, of which the acceleration gets a fifth at least. A speed of zero: friction and load leave less than that at rest.
DrivableLimits drivable_limits(const sim::MachineAxis& axis);

/// Where these limits come from, as a comment.
std::string limits_words(const DrivableLimits& d, const sim::MachineAxis& axis);

/// One axis of a configuration.
struct HalAxis {
  std::string letter;  ///< of LinuxCNC
  const sim::MachineAxis* machine = nullptr;
  DrivableLimits can;
  friction::AxisModel model;  ///< what its controllers know
};

struct Configuration {
  std::string name;          ///< of the machine
  std::string comment;       ///< how these files were made
  double sample_time = 0.0;  ///< [s]
  double omega = 0.0;        ///< [rad/s]
  std::string feedforward;   ///< empty: by the model
  std::vector<HalAxis> axes;
};

/// Letters of LinuxCNC for the axes of a machine; refuses names that it does not know and any that occur twice.
std::vector<std::string> linuxcnc_letters(const sim::Machine& machine, const std::string& file);

/// hal/play.py
extern const std::string_view kPlay;

using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// Files of the configuration by name, and their texts.
NamedTexts configuration_files(const Configuration& c);

struct WrittenFolder {
  std::vector<std::string> files;  ///< all that belong to the configuration
  std::vector<std::string>
      kept;  ///< those of them that somebody has edited, and that would be written as before
};

/// Writes files to a folder that exists, and a record of them, written.txt, beginning with the comment. What was edited since the
/// record was made, or is in no record, is never overwritten: kept where the text to write is the recorded one, else refused
/// (InputError), and then nothing is written.
WrittenFolder write_folder(const std::string& folder, const std::string& comment, const NamedTexts& files);

}  // namespace stribeck::cli
