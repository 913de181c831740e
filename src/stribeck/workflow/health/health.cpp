#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <utility>

#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/log/column_names.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/circle_logs.hpp>
#include <stribeck/workflow/excitation.hpp>
#include <stribeck/workflow/health/health.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/judge/circle_track.hpp>
#include <stribeck/workflow/log/logs_by_axis.hpp>
#include <stribeck/workflow/machine/axis_units.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

namespace health = ident::health;

std::string checked_date(const std::string& place, const std::string& date) {
  if (!health::day_of(date))
    refuse_option(place, fmt::format("got {}, expected a day as 2026-11-23", io::in_quotes(date)));
  return date;
}

/// The words of --map for the circle, or those for the logs of the axes. A position x belongs to the circle where one of y stands beside
/// it.
std::vector<std::string> maps_for(const std::vector<std::string>& maps, bool circle) {
  const auto word_of = [](const std::string& text) { return text.substr(0, text.find('=')); };
  const auto is_there = [&](const char* word) {
    return std::any_of(maps.begin(), maps.end(), [&](const std::string& m) { return word_of(m) == word; });
  };
  const bool both = is_there("y");
  std::vector<std::string> out;
  for (const std::string& text : maps) {
    const std::string word = word_of(text);
    const bool of_circle = is_word_of_circle(word) && (word != "x" || both);
    if (of_circle == circle) out.push_back(text);
  }
  return out;
}

/// The day that logs say themselves, as `# date: 2026-11-23` or with a time behind it.
class DateOfLogs {
 public:
  void add(const std::string& path, const io::Log& log) {
    std::string here;
    for (const auto& [key, value] : log.metadata) {
      if (io::lower_case(key) == "date" && health::day_of(value.substr(0, 10))) here = value.substr(0, 10);
    }
    if (here.empty())
      refuse_option("--date",
                    fmt::format("missing, and {} does not say its day: expected --date 2026-11-23, or "
                                "\"# date: 2026-11-23\" in the log",
                                path));
    if (!found_.empty() && here != found_)
      refuse_option("--date", fmt::format("missing, and {} is of {} but {} of {}: expected logs of one day",
                                          source_, found_, path, here));
    found_ = here;
    source_ = path;
  }
  [[nodiscard]] const std::string& found() const { return found_; }

 private:
  std::string found_, source_;
};

const ArchiveFile* first_of(const std::vector<ArchiveFile>& files, const std::string& axis) {
  for (const ArchiveFile& f : files) {
    if (f.test.axis == axis) return &f;
  }
  return nullptr;
}

/// Refuses a motion whose numbers cannot be compared with those of the first test.
void require_same_motion(const health::Measured& measured, const std::string& sources,
                         const ArchiveFile& first, bool rotary) {
  const std::vector<std::string> why =
      health::motion_differs(measured.motion, first.test.measured->motion, rotary);
  if (why.empty()) return;
  throw io::InputError({sources,
                        0,
                        {},
                        fmt::format("the motion is not that of {}: {} (repeat that motion, or begin another "
                                    "archive)",
                                    first.path, report::joined(why, "; "))});
}

double turn_of(const HealthOptions& o, const AxisDescription& axis) {
  if (!o.turn.empty()) return travel_si("--turn", o.turn, quantity("m", "mm").positive(), axis.rotary);
  if (!axis.drive) return 0.0;
  const DriveData& d = *axis.drive;
  if (d.pulley_diameter) return kPi * *d.pulley_diameter;
  return d.lead.value_or(d.travel_per_turn.value_or(0.0));
}

/// Measures all tests of a command before it adds any: a log that is refused leaves the archive as it was.
class Session {
 public:
  Session(const HealthOptions& options, const ArchiveFolder& archive)
      : options_(options),
        archive_(archive),
        description_(read_description(options.machine)),
        machine_(as_machine(description_)),
        files_(archive.read(description_.name)) {}

  void measure() {
    if (options_.logs.empty() && options_.circles.empty()) return;
    LogOptions of_axes = options_.log;
    if (!options_.circles.empty()) of_axes.maps = maps_for(options_.log.maps, false);
    const std::string date =
        options_.date.empty() ? date_of_all(of_axes) : checked_date("--date", options_.date);
    std::vector<ArchivedTest> tests;
    for (const LogsOfAxis& one : logs_by_axis(description_, options_.logs, of_axes)) {
      measure_axis(one, date, tests);
    }
    if (!options_.circles.empty()) measure_circle(date, tests);
    for (const ArchivedTest& test : tests) {
      archive_.add(test, files_);
      const auto same = std::find_if(files_.begin(), files_.end(), [&](const ArchiveFile& f) {
        return f.test.checksum == test.checksum && f.test.axis == test.axis;
      });
      added_.push_back(same->path);
    }
  }

  [[nodiscard]] report::HealthReportInput judge() {
    report::HealthReportInput input;
    input.machine = description_.name;
    input.archive = archive_.path();
    input.added = added_;
    input.limits = options_.limits;
    const double since =
        options_.since.empty() ? -kInfinity : *health::day_of(checked_date("--since", options_.since));
    for (std::size_t i = 0; i < description_.axes.size(); ++i) {
      const auto& [name, axis] = description_.axes[i];
      add_axis(name, since, axis.rotary, input);
      if (input.axes.empty() || input.axes.back().name != name) continue;
      auto& motion = input.axes.back().motion;
      motion = motion_commands(options_.machine, description_, i, turn_of(options_, axis));
      // Another motion than that of the archive would be refused.
      if (const ArchiveFile* first = first_of(files_, name); first != nullptr && first->test.measured) {
        const AxisUnits& u = units_of(axis.rotary);
        const auto& made = first->test.measured->motion;
        motion.insert(
            motion.begin(),
            fmt::format("# the motion of {}, from {:.5g} to {:.5g} {}; a new archive may begin with:",
                        first->path, u.per_metre * made.travel[0], u.per_metre * made.travel[1], u.travel));
      }
    }
    add_axis(std::string(ArchivedTest::kCircle), since, false, input);
    input.remarks = remarks_;
    if (input.axes.empty())
      throw io::InputError(
          {archive_.path(),
           0,
           {},
           "holds no test that counts (give logs of the repeated motion, or another --since)"});
    return input;
  }

 private:
  [[nodiscard]] std::string date_of_all(const LogOptions& of_axes) const {
    DateOfLogs date;
    for (const std::string& path : options_.logs) date.add(path, read_log(path, of_axes));
    for (const std::string& path : options_.circles) date.add(path, read_circle_log(path));
    return date.found();
  }

  /// Whether these logs are in the archive already; says so.
  [[nodiscard]] bool known(const std::string& axis, const std::string& checksum, const std::string& sources) {
    const auto same = std::find_if(files_.begin(), files_.end(), [&](const ArchiveFile& f) {
      return f.test.axis == axis && f.test.checksum == checksum;
    });
    if (same == files_.end()) return false;
    remarks_.push_back(fmt::format("{}: already in the archive as {}, not added again", sources, same->path));
    return true;
  }

  [[nodiscard]] ArchivedTest begin(const std::string& axis, const std::vector<std::string>& logs,
                                   const std::string& checksum, const std::string& date) const {
    ArchivedTest test;
    test.date = date;
    test.machine = description_.name;
    test.axis = axis;
    test.logs = logs;
    test.checksum = checksum;
    test.temperature = options_.temperature;
    return test;
  }

  void measure_axis(const LogsOfAxis& one, const std::string& date, std::vector<ArchivedTest>& tests) {
    const std::string sources = report::joined(one.logs, ", ");
    const std::string checksum = checksum_of(one.logs);
    if (known(one.axis, checksum, sources)) return;
    const AxisRecords axis = read_axis(one.logs, one.options);
    for (const std::string& note : axis.notes) remarks_.push_back(note);
    const AxisDescription& described =
        description_.axes[axis_index(machine_, options_.machine, one.axis)].second;
    const ArchiveFile* first = first_of(files_, one.axis);
    const health::Plan plan = first != nullptr ? health::plan_of(*first->test.measured)
                                               : health::plan_of(axis.records, turn_of(options_, described));
    ArchivedTest test = begin(one.axis, one.logs, checksum, date);
    test.measured = health::measure(axis.records, plan);
    if (first != nullptr) require_same_motion(*test.measured, sources, *first, described.rotary);
    if (first == nullptr && test.measured->places.empty())
      remarks_.push_back(
          fmt::format("axis {}: the motion does not tell friction along the travel from friction by speed; "
                      "jogs over the same stretch do",
                      one.axis));
    if (!test.measured->mass)
      remarks_.push_back(fmt::format(
          "axis {}: the motion does not determine the mass; constant-acceleration does", one.axis));
    tests.push_back(std::move(test));
  }

  void measure_circle(const std::string& date, std::vector<ArchivedTest>& tests) {
    const std::string checksum = checksum_of(options_.circles);
    const std::string sources = report::joined(options_.circles, ", ");
    const std::string axis{ArchivedTest::kCircle};
    if (known(axis, checksum, sources)) return;
    CircleOptions what;
    what.logs = options_.circles;
    what.size = options_.size;
    what.maps = options_.logs.empty() ? options_.log.maps : maps_for(options_.log.maps, true);
    what.together = true;
    const report::CircleReportInput judged = judge_circles(what);
    health::CircleMeasured circle;
    circle.radius = judged.radius;
    for (const report::CircleLog& log : judged.logs) {
      for (const auto& c : log.circles) circle.max_error = std::max(circle.max_error, c.max_error);
      if (!log.test) continue;
      double deviation = log.test->bidirectional.value_or(0.0);
      if (!log.test->bidirectional && !log.test->directions.empty())
        deviation = log.test->directions.front().circular_deviation;
      circle.circular_deviation = std::max(circle.circular_deviation, deviation);
      if (log.test->hysteresis)
        circle.hysteresis = std::max(circle.hysteresis.value_or(0.0), *log.test->hysteresis);
    }
    if (!(circle.circular_deviation > 0.0))
      throw io::InputError(
          {sources, 0, {}, "no whole circle (record at least one lap, better one in each direction)"});
    const ArchiveFile* first = first_of(files_, axis);
    if (first != nullptr && std::abs(first->test.circle->radius - circle.radius) > 1e-6)
      refuse_option("--size", fmt::format("got {:g} mm, expected {:g} mm as in {}", 1e3 * circle.radius,
                                          1e3 * first->test.circle->radius, first->path));
    ArchivedTest test = begin(axis, options_.circles, checksum, date);
    test.circle = circle;
    tests.push_back(std::move(test));
  }

  void add_axis(const std::string& name, double since, bool rotary, report::HealthReportInput& input) {
    report::HealthAxis axis;
    axis.name = name;
    std::size_t before = 0;
    const ArchiveFile* first = nullptr;
    for (const ArchiveFile& f : files_) {
      if (f.test.axis != name) continue;
      if (f.day < since) {
        ++before;
        continue;
      }
      require_comparable(f, first);
      if (first == nullptr) first = &f;
      axis.tests.push_back({f.day, f.test.temperature.value_or(kNaN), f.test.measured, f.test.circle});
    }
    if (axis.tests.empty()) return;
    if (before > 0)
      remarks_.push_back(fmt::format("{}: {} tests before {} do not count", name, before, options_.since));
    axis.health = health::health_of(axis.tests, options_.limits, rotary);
    input.axes.push_back(std::move(axis));
  }

  /// A file that somebody has edited, or that comes from another archive, may have other speeds or places.
  static void require_comparable(const ArchiveFile& file, const ArchiveFile* first) {
    if (first == nullptr) return;
    const bool axis = file.test.measured.has_value();
    if (axis == first->test.measured.has_value()) {
      if (!axis) return;
      const health::Measured &a = *file.test.measured, &b = *first->test.measured;
      if (a.friction.size() == b.friction.size() && a.places.size() == b.places.size() &&
          a.periodic.size() == b.periodic.size() && a.spring.has_value() == b.spring.has_value() &&
          a.unbalance.has_value() == b.unbalance.has_value())
        return;
    }
    throw io::InputError(
        {file.path, 0, "measured",
         fmt::format(
             "has other speeds, places, periods or another spring or unbalance than {} (one archive holds one motion)",
             first->path)});
  }

  const HealthOptions& options_;
  const ArchiveFolder& archive_;
  MachineDescription description_;
  sim::Machine machine_;
  std::vector<ArchiveFile> files_;
  std::vector<std::string> added_, remarks_;
};

std::string quoted(const std::string& word) {
  const bool plain = std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.' || c == '/';
  });
  return plain ? word : '"' + word + '"';
}

}  // namespace

void check_health_options(const HealthOptions& o) {
  const bool adds = !o.logs.empty() || !o.circles.empty();
  if (!adds) {
    const LogOptions& l = o.log;
    for (const auto& [given, option] :
         {std::pair{!o.date.empty(), "--date"}, std::pair{o.temperature.has_value(), "--temperature"},
          std::pair{!l.maps.empty(), "--map"}, std::pair{!l.gain.empty(), "--gain"},
          std::pair{!l.lead.empty(), "--lead"}, std::pair{!l.where.empty(), "--where"},
          std::pair{!l.runs.empty(), "--runs"}, std::pair{!l.sample_time.empty(), "--sample-time"},
          std::pair{!l.keep.empty(), "--keep"}}) {
      if (given) refuse_option(option, "goes with logs (without any, the trend of the archive is drawn)");
    }
  }
  if (o.circles.empty() != o.size.empty())
    refuse_option(o.size.empty() ? "--size" : "--circle", o.size.empty()
                                                              ? "missing, expected the radius of the circle"
                                                              : "missing, but --size is given");
}

void check_archive(const HealthOptions& o, const std::string& archive) {
  std::error_code ignored;
  if (o.logs.empty() && o.circles.empty() && !std::filesystem::is_directory(archive, ignored))
    refuse_option("--archive", archive + ": no such folder (give logs, which begin an archive)");
}

std::string before_first_test(const HealthOptions& o, const std::string& archive) {
  std::error_code ignored;
  if (!o.logs.empty() || !o.circles.empty() || std::filesystem::exists(archive, ignored)) return {};
  const MachineDescription machine = read_description(o.machine);
  std::string out =
      archive +
      " is not there yet. The motion of the first test is that of all later ones. These commands design it:\n";
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    for (const std::string& one : motion_commands(o.machine, machine, i, turn_of(o, machine.axes[i].second)))
      out += "  " + one + '\n';
  }
  return out + "Record them, and give the logs to this command: they begin the archive.\n";
}

report::HealthReportInput check_health(const HealthOptions& options, const ArchiveFolder& archive) {
  Session session(options, archive);
  try {
    session.measure();
  } catch (const ident::Refused& e) {
    throw io::InputError({{}, 0, {}, e.what()});  // "no" is the answer for a machine that has changed
  }
  return session.judge();
}

namespace {

/// The next number of three digits below: a speed that was rounded up may have no room in the travel.
double three_digits_below(double value) {
  const double digit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::floor(value / digit * (1.0 + 1e-12)) * digit;
}

}  // namespace

std::vector<std::string> motion_commands(const std::string& file, const MachineDescription& machine,
                                         std::size_t axis, double turn) {
  const auto& [name, described] = machine.axes[axis];
  const sim::AxisLimits& l = described.limits;
  const ident::excitation::Limits limits{l.travel_min, l.travel_max, l.speed, l.acceleration,
                                         described.force_limit()};
  ident::excitation::JogDesign jog;
  jog.start = 0.5 * (l.travel_min + l.travel_max);
  const double top = ident::excitation::fastest_jog(limits, machine.sample_time, jog);
  // 60 % of the way to the end of the travel, at most what the slowest jog covers in half a minute.
  constexpr double kSlowest = 0.1, kTime = 30.0, kShare = 0.6;
  double stretch = std::min(kShare * 0.5 * (l.travel_max - l.travel_min), kSlowest * top * kTime);
  const AxisUnits& u = units_of(described.rotary);
  const double unit = turn > 0.0 && turn <= stretch ? turn : 1.0 / u.per_metre;
  if (unit <= stretch) stretch = unit * std::floor(stretch / unit);
  std::string speeds;
  for (const double share : {kSlowest, 0.25, 0.5, 1.0})
    speeds +=
        fmt::format(" \"{:.3g} {}/s\"", three_digits_below(0.999 * u.per_metre * share * top), u.travel);
  const std::string begin = fmt::format("stribeck excite {} --axis {} --method", quoted(file), quoted(name));
  return {fmt::format("{} jog --speeds{} --lead \"{:.6g} {}\" -o {}-health-jog.csv{}", begin, speeds,
                      u.per_metre * stretch, u.travel, name, gcode_option(name, name + "-health-jog")),
          fmt::format("{} constant-acceleration -o {}-health-mass.csv{}", begin, name,
                      gcode_option(name, name + "-health-mass"))};
}

}  // namespace stribeck::workflow
