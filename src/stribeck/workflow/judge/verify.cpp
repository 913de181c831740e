#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <stribeck/ident/drive/drive_fit.hpp>
#include <stribeck/ident/drive/smoothing/before_filter.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/ident/residual/residual.hpp>
#include <stribeck/ident/shown.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/said_once.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/workflow/judge/missed_force.hpp>
#include <stribeck/workflow/judge/own_logs.hpp>
#include <stribeck/workflow/judge/untested.hpp>
#include <stribeck/workflow/judge/verify.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

using ident::replay::expected_shift;
using ident::replay::kMostGivenShift;
using report::VerifyReportInput;

constexpr double kReproduced =
    0.02;  // of the force: a controller that differs by more is not that of the log

struct Model {
  std::string file;
  std::string axis;  ///< as its file says; empty: it does not
  friction::AxisModel model;
  double told_from = 0.0;  ///< slowest speed whose friction the logs behind the file tell [m/s]
  std::optional<double> control_period{};  ///< as its file says [s]
};

constexpr double kMostGrowth = 4.6;  // ln 100: of a deviation in open loop
constexpr double kMostGain =
    0.5;  // of a velocity loop in one row: beyond it the loop of a log rings or runs away

/// Force per velocity in the loop of a controller [N·s/m].
double velocity_gain(const ident::replay::ReplayController& c) {
  if (const auto* pd = std::get_if<ident::replay::PdLaw>(&c.law)) return pd->damping;
  return std::get<ident::replay::CascadeLaw>(c.law).velocity_gain;
}

/// A file of another kind breaks nearly every rule of an axis file, so one message replaces all of them.
template <class T>
T read_one(const std::string& path, const std::string& hint) {
  try {
    return io::read_toml<T>(path);
  } catch (const io::NotToml& e) {
    io::Problem why = e.problems().front();
    why.message += fmt::format(" ({})", hint);
    throw io::InputError(std::move(why));
  } catch (const io::InputError& e) {
    io::Problem first = e.problems().front();
    const std::size_t more = e.problems().size() - 1;
    if (more > 0) first.message += fmt::format("; {} more problem{} ({})", more, more == 1 ? "" : "s", hint);
    throw io::InputError(std::move(first));
  }
}

bool same_name(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  });
}

/// How the logs are read with the drive of their axis, as the machine file has it. The axis is that of --axis, of the axis files, or the
/// only one in the logs.
LogOptions read_as_axis(const VerifyOptions& o, const std::vector<Model>& models) {
  const MachineDescription machine = read_description(o.machine);
  LogOptions options = o.log;
  if (options.axis.empty() && !models.empty()) options.axis = models.front().axis;
  for (const auto& [name, axis] : machine.axes) {
    if (same_name(name, options.axis)) options.axis = name;
  }
  std::vector<std::string> names;
  for (const LogsOfAxis& one : logs_by_axis(machine, o.logs, options)) {
    if (one.logs.size() == o.logs.size()) {
      names.push_back(one.axis);
      options = one.options;
    }
  }
  if (names.size() == 1) return options;
  if (names.empty() && o.log.axis.empty() && !models.empty() && !options.axis.empty())
    throw io::InputError(
        {models.front().file, 0, "axis",
         fmt::format(
             "is of axis {}, and not every log is one of that axis (give the axis file of the logs, or say with --axis for which axis of {} "
             "they are taken)",
             io::in_quotes(options.axis), o.machine)});
  refuse_option("--axis", names.empty()
                              ? fmt::format("got {}, expected an axis of {} that every log is of",
                                            io::in_quotes(options.axis), o.machine)
                              : fmt::format("missing: the logs are of axes {}", fmt::join(names, ", ")));
}

std::vector<Model> read_models(const VerifyOptions& o, LogOptions& log) {
  std::vector<Model> models;
  bool rotary = false;
  const auto add = [&](const std::string& path, const sim::AxisFile& file, const std::string& axis) {
    models.push_back(
        {path, axis, file.model, file.uncertainty ? file.uncertainty->told_from : 0.0, file.control_period});
    if (models.size() > 1 && rotary != file.rotary.value_or(false))
      throw io::InputError({path, 0, "rotary",
                            "one of the axis files is of a rotary axis, another is not (verify them apart)"});
    rotary = file.rotary.value_or(false);
  };
  for (const std::string& path : o.axis_files) {
    if (describes_machine(path))
      throw io::InputError(
          {path, 0, "axes",
           "is a machine file, expected an axis file as identify -o writes it (give it behind the "
           "machine file, and the log last)"});
    const auto file =
        read_one<sim::AxisFile>(path, "expected an axis file as identify -o writes it; the log comes last");
    add(path, file, file.axis.value_or(""));
  }
  for (const auto& [name, file] : o.models) add(name, file, file.axis.value_or(o.log.axis));
  if (!o.machine.empty()) {
    log = read_as_axis(o, models);
    if (log.drive.rotary != rotary)
      throw io::InputError(
          {models.front().file, 0, "rotary",
           fmt::format("the axis file is of {} axis, but axis {} of {} is {} (give the file of that axis)",
                       rotary ? "a rotary" : "a linear", log.axis, o.machine,
                       log.drive.rotary ? "rotary" : "linear")});
  }
  if (!models.empty()) log.drive.rotary = rotary;
  if (log.drive.rotary && log.drive.lead.empty()) log.drive.lead = "360 deg";
  return models;
}

/// The model of one axis on the log of another.
void compare_axes(const std::vector<Model>& models, const io::Log& log, const std::string& chosen,
                  std::vector<std::string>& warnings) {
  std::string logged = chosen;
  if (logged.empty()) {
    for (const auto& [key, value] : log.metadata) {
      if (key == "axis") logged = value;
    }
  }
  if (logged.empty()) return;
  for (const Model& m : models) {
    if (m.axis.empty() || same_name(m.axis, logged)) continue;
    warnings.push_back(fmt::format("{} was identified for axis {}, but {} is a log of axis {}", m.file,
                                   m.axis, log.source, logged));
  }
}

/// The shift that was given [s].
std::optional<double> given_shift(const VerifyOptions& o, const ident::log::Record& record) {
  if (o.force_shift.empty()) return std::nullopt;
  const double shift = option_si("--force-shift", o.force_shift, quantity("s", "ms"));
  if (std::abs(shift) > kMostGivenShift * record.sample_time) {
    refuse_option("--force-shift",
                  fmt::format("got {}, expected at most {:.4g} ms, {:g} rows of this log, either way",
                              io::in_quotes(o.force_shift), 1e3 * kMostGivenShift * record.sample_time,
                              kMostGivenShift));
  }
  return shift;
}

/// What belongs to the record and not to the axis, in words. `expected`: the shift of the model [s]; absent: one was given. `held`: how
/// long a command stands is not known and was taken for one row of so many seconds; 0: it is known.
void note_differences(const std::string& file, const ident::replay::ForceError& e,
                      const std::optional<double>& expected, double held, const ident::Shown& shown,
                      std::vector<std::string>& warnings) {
  if (e.shifted && expected) {
    const double off = e.shift - *expected;
    warnings.push_back(fmt::format(
        "{}: in this log the force is {:.3g} ms {} than its motion, {:.3g} ± {:.2g} ms {} than in the model{}{}; the time shift was removed "
        "before the comparison (the force of the model is a command that is held)",
        file, 1e3 * std::abs(e.shift), e.shift > 0.0 ? "later" : "earlier", 1e3 * std::abs(off),
        1e3 * e.shift_half, off > 0.0 ? "later" : "earlier",
        e.or_pre_sliding ? ", or it rises over a distance after each reversal: the model has no pre-sliding, "
                           "and this motion does not tell which (identify with slow jogs)"
                         : "",
        off > 0.0 && off < 0.5 * held
            ? ", or the log has every n-th command: the machine file as the first argument says how long one stands"
            : ""));
  }
  for (const ident::replay::RecordPhase& p : e.phases) {
    if (!p.differs) continue;
    // What remains of a sine of which another of the same size is taken off.
    const double left = 2.0 * std::abs(std::sin(0.5 * (p.found - p.stored)));
    warnings.push_back(fmt::format(
        "{}: the periodic term of {} has the phase {:.2f} ± {:.2f} rad in this log and {:.2f} rad in the file (another homing position); with the stored phase a compensation would {}",
        file, shown.length(p.period), p.found, p.half_width, p.stored,
        left > 1.0 ? std::string("add to the force in place of taking it off")
                   : fmt::format("leave {:.0f} % of it", 100.0 * left)));
  }
}

/// Rows at rest do not count against a model.
void note_rest(const Model& m, const ident::replay::ForceError& e, std::vector<std::string>& warnings) {
  if (!e.of_rests()) return;
  const bool bristles = friction::has_pre_sliding(m.model.friction.dynamics);
  warnings.push_back(fmt::format(
      "{}: in {:.0f} % of the rows the axis {}; the model is judged in the others: there the error is {:.3g} %, "
      "in all rows {:.3g} % ({})",
      m.file, 100.0 * (e.at_rest + e.unsettled),
      bristles
          ? "stands, where its force lies anywhere within its friction, and the encoder hardly shows how the bristles are strained"
          : "stands or has just turned round, where a model without pre-sliding knows no force",
      100.0 * e.moving_relative, 100.0 * e.own_relative,
      bristles ? "verify with a motion without rests"
               : "identify the pre-sliding with slow jogs, or verify with a longer motion without rests"));
}

/// The record without the force of a drive that gives way between motor and table, which no axis file holds, and a note; absent where
/// that is not what a model misses. It is the same for all models.
std::optional<ident::log::Record> as_of_rigid_drive(const std::vector<Model>& models,
                                                    const ident::log::Record& record,
                                                    const ident::replay::ForceOptions& force,
                                                    std::vector<std::string>& notes) {
  constexpr double kMuch = 0.05;      // of the force
  constexpr double kMuchLess = 0.5;   // of the error
  constexpr double kSameMass = 0.15;  // of the mass of the file
  constexpr double kSlowest =
      4.0;  // [Hz]: the third harmonic of friction in a slow sine looks like a slower one
  for (const Model& m : models) {
    const double with = ident::replay::force_error(m.model, record, force).moving_relative;
    if (!(with > kMuch)) continue;
    ident::Result model;
    model.mass = m.model.mass;
    model.load = m.model.load;
    model.friction = m.model.friction;
    model.given_shift = force.shift.value_or(expected_shift(m.model, record, force.control_period));
    const auto elastic = ident::residual::diagnose({record}, model).elastic;
    if (!elastic || elastic->frequency < kSlowest ||
        std::abs(elastic->mass - model.mass) > kSameMass * model.mass)
      continue;
    ident::log::Record rigid = record;
    take_off(*elastic, *model.given_shift / record.sample_time, rigid);
    const double without = ident::replay::force_error(m.model, rigid, force).moving_relative;
    if (!(without < kMuchLess * with)) continue;
    notes.push_back(fmt::format(
        "{}: the drive of this log gives way between motor and table ({:.0f} % of the mass swings at {:.3g} Hz), which no axis file holds; that force was estimated from this log and taken off it before the comparison; with it {} misses {:.3g} % of the force where the axis moves, and without it {:.3g} %",
        record.source, 100.0 * std::min(1.0, elastic->table_mass / elastic->mass), elastic->frequency, m.file,
        100.0 * with, 100.0 * without));
    return rigid;
  }
  return {};
}

/// The record with the force before a filter of the drive, which no axis file holds, and a note; absent where no filter is what a model
/// misses. The filter is found without the models, so it is the same for all.
std::optional<ident::log::Record> as_before_filter(const std::vector<Model>& models,
                                                   const ident::log::Record& record,
                                                   const ident::replay::ForceOptions& force,
                                                   std::vector<std::string>& notes) {
  constexpr double kMuch = 0.02;     // of the force
  constexpr double kMuchLess = 0.8;  // of the error
  constexpr double kLate = 0.5;      // rows
  std::optional<ident::log::Record> before;
  for (const Model& m : models) {
    const ident::replay::ForceError with = ident::replay::force_error(m.model, record, force);
    ident::replay::ForceOptions found = force;
    found.shift.reset();
    const double late = force.shift ? ident::replay::force_error(m.model, record, found).shift : with.shift;
    if (!(with.moving_relative > kMuch) || !(late > kLate * record.sample_time)) continue;
    if (!before) {
      ident::drive::DriveFitOptions options;
      options.dynamics = false;
      options.control_period = force.control_period;
      if (force.shift) options.shift = *force.shift / record.sample_time;
      try {
        const ident::Result own = ident::drive::identify_drive({record}, options);
        if (!own.filter) return {};
        ident::drive::take_off(*own.filter, before.emplace(record));
      } catch (const ident::Refused&) {
        return {};
      }
    }
    const double without = ident::replay::force_error(m.model, *before, force).moving_relative;
    if (!(without < kMuchLess * with.moving_relative)) continue;
    notes.push_back(fmt::format(
        "{}: the drive smoothed the force of this log by a filter of {:.3g} ms, which no axis file holds; it was found in this log and taken off the force before the comparison; with it {} misses {:.3g} % of the force where the axis moves, and without it {:.3g} %",
        record.source, 1e3 * before->filter->time, m.file, 100.0 * with.moving_relative, 100.0 * without));
    return before;
  }
  return {};
}

/// Rows beyond the ends of the model's spring, where its force stays.
void note_beyond_spring(const Model& m, const ident::log::Record& record,
                        std::vector<std::string>& warnings) {
  constexpr double kSome = 0.01;
  const auto& spring = m.model.friction.spring;
  if (!spring) return;
  const auto outside = std::count_if(record.x.begin(), record.x.end(),
                                     [&](double x) { return x < spring->lowest() || x > spring->highest(); });
  if (static_cast<double>(outside) < kSome * static_cast<double>(record.x.size())) return;
  const ident::Shown shown(record);
  const std::string where =
      !spring->from ? "above " + shown.length(*spring->to)
      : !spring->to ? "below " + shown.length(*spring->from)
                    : fmt::format("beyond {} to {}", shown.length(*spring->from), shown.length(*spring->to));
  warnings.push_back(fmt::format(
      "{}: {} of {} rows lie {}, where the force of the model's spring stays (identify a log of the whole travel)",
      m.file, outside, record.x.size(), where));
}

class Verification {
 public:
  explicit Verification(const VerifyOptions& o) : o_(o), log_(o.log), models_(read_models(o, log_)) {
    if (!o.controller.empty())
      controller_ = read_one<ident::replay::ReplayController>(o.controller,
                                                              "expected a controller, kind cascade or pd");
    page_.axis = log_.axis;
    page_.limits = o.limits;
    for (const std::string& path : o.axis_files) {
      const std::vector<std::string> own = notes_on_own_logs(path, o.logs);
      page_.warnings.insert(page_.warnings.end(), own.begin(), own.end());
    }
  }

  VerifyReportInput run() {
    for (std::size_t i = 0; i < o_.logs.size(); ++i)
      add_log(o_.logs[i], o_.read.empty() ? read_log(o_.logs[i], log_) : o_.read[i]);
    if (page_.parts.empty())
      throw ident::Refused(why_.empty() ? o_.logs.front() + ": no part can be replayed" : why_);
    page_.warnings = report::said_once(page_.warnings, o_.logs);
    return std::move(page_);
  }

 private:
  void add_log(const std::string& name, const io::Log& log) {
    page_.source += (page_.source.empty() ? "" : ", ") + name;
    page_.warnings.insert(page_.warnings.end(), log.notes.begin(), log.notes.end());
    compare_axes(models_, log, log_.axis, page_.warnings);
    const ident::log::Conditioned clean = condition_log(log, log_, &page_.warnings);
    for (const ident::log::Finding& f : clean.findings) page_.warnings.push_back(f.text);
    const bool alone = o_.logs.size() == 1 && clean.records.size() == 1;
    for (const ident::log::Record& record : clean.records) {
      try {
        add_part(record);
      } catch (const ident::Refused& e) {
        // A piece of a cut log may be too short or stand still; the other pieces still count.
        if (alone) throw;
        if (why_.empty()) why_ = e.what();
        page_.warnings.push_back(fmt::format("a part is left out: {}", e.what()));
      }
    }
  }

  void add_part(const ident::log::Record& logged) {
    if (logged.force_unit != "N" || logged.position_unit != "m") {
      refuse_option(
          "--gain",
          fmt::format(
              "missing: an axis file holds newtons and metres, the log has {} and {} (or give the machine file, which knows the drive, before the axis file)",
              logged.force_unit, logged.position_unit));
    }
    std::vector<std::string> notes;
    ident::replay::ForceOptions force;
    force.shift = given_shift(o_, logged);
    force.control_period = period_of_control();
    const std::optional<ident::log::Record> before = as_before_filter(models_, logged, force, notes);
    const std::optional<ident::log::Record> rigid =
        as_of_rigid_drive(models_, before ? *before : logged, force, notes);
    const ident::log::Record& record = rigid ? *rigid : before ? *before : logged;
    report::VerifiedPart part;
    ident::replay::ReplayOptions closed;
    if (controller_) {
      part.controller = ident::replay::check_controller(*controller_, record);
      note_controller(record, *part.controller);
      closed.added = part.controller->added;
    }
    for (const Model& m : models_) part.models.push_back(score(m, record, force, closed, notes));
    page_.warnings.insert(page_.warnings.end(), notes.begin(), notes.end());
    part.record = record;
    page_.parts.push_back(std::move(part));
  }

  /// Of the machine file, or else of the first axis file that tells it [s]; 0: not known.
  [[nodiscard]] double period_of_control() const {
    if (const double period = control_period(log_); period > 0.0) return period;
    for (const Model& m : models_)
      if (m.control_period) return *m.control_period;
    return 0.0;
  }

  report::VerifiedModel score(const Model& m, const ident::log::Record& record,
                              ident::replay::ForceOptions force, ident::replay::ReplayOptions closed,
                              std::vector<std::string>& notes) const {
    report::VerifiedModel one;
    one.name = m.file;
    const auto [low, high] = std::minmax_element(record.x.begin(), record.x.end());
    one.travel = *high - *low;
    force.of_log = true;
    force.told_from = m.told_from;
    one.force = ident::replay::force_error(m.model, record, force);
    const double expected = expected_shift(m.model, record, force.control_period);
    note_differences(m.file, one.force, force.shift ? std::nullopt : std::optional(expected),
                     force.control_period > 0.0 ? 0.0 : record.sample_time, ident::Shown(record), notes);
    note_rest(m, one.force, notes);
    one.told_from = m.told_from;
    if (std::string missed = missed_in_words(m.file, m.model, one.force, record); !missed.empty())
      notes.push_back(std::move(missed));
    if (100.0 * one.force.moving_relative <= o_.limits.usable) {
      for (std::string& text : untested_in_words(m.file, m.model, record, o_.limits.good))
        notes.push_back(std::move(text));
    }
    note_beyond_spring(m, record, notes);
    ident::replay::ReplayOptions open;
    const double most = kMostGivenShift * record.sample_time;
    const double shift = force.shift.value_or(one.force.shifted ? one.force.shift : expected);
    open.delay = -std::clamp(shift, -most, most) - 0.5 * record.sample_time;
    run_open(m, record, open, one, notes);
    // A measured force stands late in the log and acts at once.
    closed.delay = std::max(0.0, open.delay);
    if (controller_) run_closed(m, record, closed, one, notes);
    if (const std::size_t outside = one.open.restarted.outside; outside > 0) {
      notes.push_back(
          fmt::format("{}: {} of {} rows are at velocities outside the range of the identified model", m.file,
                      outside, record.x.size()));
    }
    return one;
  }

  /// The runs in open loop, unless an error of the velocity grows in them so that they tell nothing.
  static void run_open(const Model& m, const ident::log::Record& record,
                       const ident::replay::ReplayOptions& options, report::VerifiedModel& one,
                       std::vector<std::string>& notes) {
    try {
      one.open = ident::replay::replay_open_loop(m.model, record, options);
    } catch (const ident::replay::Diverged& e) {
      one.open = ident::replay::not_replayed(record);
      notes.push_back(fmt::format("{}: no run in open loop is shown: {}", m.file, e.what()));
      return;
    }
    one.drift = ident::replay::drift_band(m.model, record, one.force, one.open);
    if (!(one.drift.growth > kMostGrowth)) return;
    notes.push_back(fmt::format(
        "{}: no run in open loop is shown: on this motion friction falls with speed for so long that an error of the velocity grows {}, however good the model is; judge by the error of the force",
        m.file,
        one.drift.growth > std::log(1e6) ? "more than a million times"
                                         : fmt::format("{:.0f} times", std::exp(one.drift.growth))));
    one.open = ident::replay::not_replayed(record);
    one.drift = {};
  }

  /// The closed loop, unless the rows are too far apart for it.
  void run_closed(const Model& m, const ident::log::Record& record,
                  const ident::replay::ReplayOptions& options, report::VerifiedModel& one,
                  std::vector<std::string>& notes) const {
    const double gain = velocity_gain(*controller_) * record.sample_time / m.model.mass;
    if (gain > kMostGain) {
      notes.push_back(fmt::format(
          "{}: no closed loop is shown: its velocity loop settles in {:.3g} ms and the rows of {} are {:.3g} ms apart, so that it would ring; record the rows of the control's period",
          m.file, 1e3 * m.model.mass / velocity_gain(*controller_), record.source, 1e3 * record.sample_time));
      return;
    }
    try {
      one.closed = ident::replay::replay_closed_loop(m.model, *controller_, record, options);
    } catch (const ident::replay::Diverged& e) {
      notes.push_back(fmt::format("{}: no closed loop is shown: {}", m.file, e.what()));
    }
  }

  void note_controller(const ident::log::Record& record, const ident::replay::ControllerCheck& check) {
    if (!check.added.empty()) {
      page_.warnings.push_back(fmt::format(
          "{}: the controller makes the logged command except in {:.3g} % of the rows, where {:.3g} N RMS was added to it; the closed loop gets the same",
          record.source, 100.0 * check.added_share, check.added_rms));
    } else if (check.relative > kReproduced) {
      page_.warnings.push_back(fmt::format(
          "{}: {} does not make the logged command out of the logged positions (it differs by {:.3g} % of the force): the closed loop compares two controllers; check its gains, its units and --gain",
          record.source, o_.controller, 100.0 * check.relative));
    }
  }

  const VerifyOptions& o_;
  LogOptions log_;
  std::vector<Model> models_;
  std::optional<ident::replay::ReplayController> controller_;
  VerifyReportInput page_;
  std::string why_;  ///< first part that was refused
};

}  // namespace

VerifyReportInput verify(const VerifyOptions& options) { return Verification(options).run(); }

}  // namespace stribeck::workflow
