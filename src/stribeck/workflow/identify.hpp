#pragma once
/// Mass and friction of an axis from its logs: reads them, chooses a method, identifies.
///
///   const auto axis = workflow::read_axis({"log.csv"}, {});
///   const auto found = workflow::identify(axis, {});
///   found.result.mass, found.result.mass_interval
///
/// Method::kAuto uses
///   the position map           for an axis that is held at standstill or moves in one direction only,
///   jog                        for runs of constant speed,
///   the fit of the whole drive otherwise; where that does not determine the mass and most rows are of constant speed, jog, with a
///                              warning that the mass is not known.
///
/// Real time: no.
/// Errors: InputError for logs and options, ident::Refused where the logs do not determine the answer.

#include <array>
#include <cstddef>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/lost_motion/lost_motion.hpp>
#include <stribeck/ident/methods/idim_ls.hpp>
#include <stribeck/ident/methods/jog/jog.hpp>
#include <stribeck/ident/methods/least_squares_a.hpp>
#include <stribeck/ident/residual/residual.hpp>
#include <stribeck/ident/result.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/log/log_options.hpp>
#include <stribeck/workflow/machine/of_machine_file.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::workflow {

using ident::Method;

/// The friction law that is fitted. kAsymmetric: viscous and Coulomb friction for each direction.
enum class ModelChoice { kAuto, kConventional, kGaussian, kAsymmetric };

/// Texts contain their unit, as a user gives them; empty: identified, or chosen from the data.
struct IdentifyOptions {
  Method method = Method::kAuto;
  ModelChoice model = ModelChoice::kAuto;
  ident::methods::Solver solver = ident::methods::Solver::kDerivatives;
  std::optional<int> terms{};  ///< Gaussians of each direction
  std::string mass{};          ///< known equivalent mass, "57.65 N s2/mm"
  std::string force_shift{};   ///< known time by which the force is later in the log than its motion, "2 ms"
  std::string cut_off{};       ///< of the low-pass filter, "50 Hz"
  std::string turn{};          ///< known travel of one turn, "10 mm"
  /// Logs in other units than an axis file holds are refused before anything is computed.
  bool for_axis_file = false;
};

/// Records of one axis from all its logs, and the findings from reading them.
struct AxisRecords {
  std::vector<ident::log::Record> records;
  std::size_t runs = 0;                                   ///< number of separate runs
  bool one_direction = false;                             ///< all of them move in the same direction
  std::vector<std::string> notes;                         ///< each begins with the name of its log
  std::string sources;                                    ///< names of the logs
  std::string axis;                                       ///< name of the axis; empty: none was given
  bool rotary = false;                                    ///< travel is the arc at a radius of 1 m
  std::vector<ident::lost_motion::Positions> encoders{};  ///< of logs with two positions
  std::string irregular{};      ///< a log whose rows were taken at irregular times; empty: none
  std::string commanded{};      ///< a log whose position is its command; empty: none
  double control_period = 0.0;  ///< of the machine file [s]; 0: not known
  bool balanced = false;        ///< the machine file says that nothing pulls the axis
  bool weighted = false;        ///< the machine file says that a load pulls the axis
  bool as_commanded = false;    ///< the shift of the force is not searched: it is taken as held for each row
};

struct Identification {
  ident::Result result;
  bool holding_only = false;            ///< the axis was held at standstill: neither mass nor friction
  std::vector<ident::Result> beside{};  ///< results of other logs (other days, standstill), shown beside it
  std::optional<ident::methods::LeastSquaresA> model_a{};            ///< of Method::kLeastSquaresA
  std::optional<ident::methods::IdimResult::Published> published{};  ///< of Method::kIdimLs
  std::optional<ident::residual::Quality>
      quality{};  ///< what the model leaves; absent: not a model of velocity
  std::optional<ident::residual::Elastic> elastic{};  ///< whose force was taken off the logs before the fit
  std::optional<ident::lost_motion::LostMotion> lost_motion{};  ///< absent: one encoder only
};

/// Refuses options that the method would not use.
void check_options(const IdentifyOptions& options);

/// Reads and cleans logs of one axis.
AxisRecords read_axis(const std::vector<std::string>& logs, const LogOptions& options);
/// The same with logs that were read already.
AxisRecords axis_records(const std::vector<io::Log>& logs, const LogOptions& options);

/// Throws ident::Refused when the position of a log is its command; else the same.
AxisRecords measured(AxisRecords axis);

/// The result with all warnings. Refuses a mass that is not determined, unless the method determines no mass.
Identification identify(const AxisRecords& axis, const IdentifyOptions& options);

/// Both, for logs of any kind: those at standstill, where others move, are identified by themselves and stand beside.
std::pair<AxisRecords, Identification> identify_logs(const std::vector<std::string>& logs,
                                                     const LogOptions& options, const IdentifyOptions& how);
/// The same with logs that were read already.
std::pair<AxisRecords, Identification> identify_logs(const std::vector<io::Log>& logs,
                                                     const LogOptions& options, const IdentifyOptions& how);

/// Throws ident::Refused when a result is no answer: a mass that is not positive or not determined, or numbers that are not finite.
void require_determined(const ident::Result& result, const std::string& source);

/// The content of an axis file.
friction::AxisModel as_model(const ident::Result& result);

/// Why no reader takes an axis file; empty: it is sound.
std::string why_unreadable(const std::string& axis_file);

/// Refused with place --output unless these are newtons and metres.
void require_axis_file_units(const std::string& force_unit, const std::string& position_unit);
/// The content of an axis file; refused with place --output unless the result holds for both directions in newtons and metres.
friction::AxisModel axis_file_model(const Identification& found, const AxisRecords& axis);
/// With the lost motion, where it is one (lost_motion_of()), and what the machine file says of the drive.
sim::AxisFile axis_file(const Identification& found, const AxisRecords& axis,
                        const OfMachineFile& known = {});
/// What is to be compensated: absent where nothing is lost or the interval of the sum contains zero. Where backlash and wind-up are
/// not told apart, their sum stands as backlash. mass: of the axis [kg].
std::optional<control::LostMotionParams> lost_motion_of(const ident::lost_motion::LostMotion& found,
                                                        double mass);
/// The axis file itself; `version` is that of the program.
std::string axis_file_text(const Identification& found, const AxisRecords& axis, std::string_view version,
                           const OfMachineFile& known = {});

}  // namespace stribeck::workflow

template <>
struct stribeck::EnumNames<stribeck::workflow::ModelChoice> {
  using M = stribeck::workflow::ModelChoice;
  static constexpr std::array names{std::pair{M::kAuto, std::string_view{"auto"}},
                                    std::pair{M::kGaussian, std::string_view{"gaussian"}},
                                    std::pair{M::kConventional, std::string_view{"conventional"}},
                                    std::pair{M::kAsymmetric, std::string_view{"asymmetric"}}};
};
