#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stribeck/core/numbers.hpp>
#include <stribeck/ident/excitation/excitation.hpp>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/process/outside_program.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/io/write_at_once.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/uncertainty/design.hpp>
#include <stribeck/workflow/board/identification.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/identify.hpp>

namespace stribeck::workflow {
namespace {

using ident::excitation::ExcitationMethod;

/// Separates the noise of the board's logs, and its rough estimates, from all else.
constexpr std::uint64_t kBoardLogs = 0x626f6172;
constexpr double kRough = 0.1;  ///< by how much mass and friction may be wrong before the pulses
constexpr int kHeldOutPeriods = 3;

ident::excitation::RoughDrive rough_estimate(const sim::MachineAxis& axis, std::uint64_t seed,
                                             std::uint64_t stream) {
  ident::Result curve;
  curve.mass = axis.plant.total_mass();
  constexpr int kPoints = 20;
  for (int i = -kPoints; i <= kPoints; ++i) {
    if (i == 0) continue;
    const double v = 0.9 * axis.limits.speed * i / kPoints;
    const double f = true_force(axis, v);
    curve.curve.push_back({v, f, f, f});
  }
  ident::excitation::RoughDrive drive = ident::excitation::rough_drive(curve);
  const auto wrong = [&](std::uint64_t which) {
    return 1.0 + kRough * (2.0 * sim::random_share(seed ^ kBoardLogs, stream, which) - 1.0);
  };
  drive.mass *= wrong(10);
  const double friction = wrong(11);
  drive.coulomb *= friction;
  drive.viscous *= friction;
  return drive;
}

ident::excitation::Excitation held_out_motion(const sim::Machine& machine, const sim::MachineAxis& axis) {
  const sim::Commissioning& c = axis.commissioning;
  ident::excitation::SineDesign sine{c.sine_offset, 0.6 * c.sine_amplitude, 1.3 * c.sine_frequency,
                                     kHeldOutPeriods};
  sine.from_middle = true;
  return ident::excitation::design_sine({axis.limits.travel_min, axis.limits.travel_max, axis.limits.speed,
                                         axis.limits.acceleration, axis.force_limit()},
                                        machine.sample_time, sine);
}

BoardAnswer from_result(const ident::Result& result, friction::AxisModel model) {
  BoardAnswer answer{std::move(model), {}, {}};
  for (const ident::CurvePoint& p : result.curve) {
    if (std::isfinite(p.ci_low) && std::isfinite(p.ci_high))
      answer.curve.push_back({p.velocity, p.ci_low, p.ci_high});
  }
  if (std::isfinite(result.mass_interval.low) && std::isfinite(result.mass_interval.high))
    answer.mass = {result.mass_interval.low, result.mass_interval.high};
  return answer;
}

/// Two finite numbers, the lower one first.
std::optional<std::array<double, 2>> interval_in(const nlohmann::json& json, const char* key) {
  if (!json.contains(key) || json[key].is_null()) return {};
  const nlohmann::json& pair = json[key];
  if (!pair.is_array() || pair.size() != 2)
    throw std::runtime_error(fmt::format("{}: expected two numbers", key));
  if (pair[0].is_null() || pair[1].is_null()) return {};
  const std::array<double, 2> ends{pair[0].get<double>(), pair[1].get<double>()};
  if (!(ends[0] <= ends[1])) throw std::runtime_error(fmt::format("{}: expected the lower end first", key));
  return ends;
}

/// Intervals from a JSON as `identify --json` writes it, or one with these keys alone.
void take_intervals(const std::string& file, BoardAnswer& answer) {
  try {
    const auto json = nlohmann::json::parse(io::read_text(file));
    answer.mass = interval_in(json, "mass_ci95_kg");
    if (!json.contains("curve")) return;
    double last = -std::numeric_limits<double>::infinity();
    for (const nlohmann::json& point : json["curve"]) {
      const double v = 1e-3 * point.at("velocity_mm_per_s").get<double>();
      if (!(v >= last)) throw std::runtime_error("curve: expected ascending velocities");
      last = v;
      if (const auto ends = interval_in(point, "ci95_N")) answer.curve.push_back({v, (*ends)[0], (*ends)[1]});
    }
  } catch (const std::exception& e) {
    throw io::ProgramFailed(fmt::format("{}: {}", std::filesystem::path(file).filename().string(), e.what()));
  }
}

BoardAnswer read_answer(const std::string& stem) {
  if (!std::filesystem::exists(stem + ".toml"))
    throw io::ProgramFailed("no answer: there is no " +
                            std::filesystem::path(stem + ".toml").filename().string());
  BoardAnswer answer{io::read_toml<sim::AxisFile>(stem + ".toml").model, {}, {}};
  if (std::filesystem::exists(stem + ".json")) take_intervals(stem + ".json", answer);
  return answer;
}

}  // namespace

std::string name_of(const BoardMachine& board, std::size_t axis) {
  return board.name + "-" + board.machine.axes[axis].first;
}

BoardLogs board_logs(const BoardMachine& board, std::uint64_t seed, std::uint32_t machine, std::size_t axis) {
  const sim::MachineAxis& a = board.machine.axes[axis].second;
  const std::uint64_t stream = 16 * static_cast<std::uint64_t>(machine) + axis;
  const auto noise = [&](std::uint64_t which) { return sim::random_bits(seed ^ kBoardLogs, stream, which); };
  BoardLogs out;
  const auto add = [&](const char* name, const ident::excitation::Excitation& e, std::uint64_t which) {
    out.logs.push_back(as_log(play(board.machine, axis, e.r, e.force, noise(which))));
    out.logs.back().source = fmt::format("{}-{}.csv", name_of(board, axis), name);
  };
  add("pulses", design(board.machine, axis, ExcitationMethod::kPulses, 0, rough_estimate(a, seed, stream)),
      0);
  add("sine", design(board.machine, axis, ExcitationMethod::kSine, kSinePeriods), 1);
  const auto unseen = held_out_motion(board.machine, a);
  out.held_out = as_record(play(board.machine, axis, unseen.r, {}, noise(2)), "held-out motion");
  return out;
}

std::vector<std::string> write_logs(const BoardLogs& logs, const BoardMachine&, std::size_t,
                                    const std::string& folder) {
  std::vector<std::string> paths;
  for (const io::Log& log : logs.logs) {
    paths.push_back(folder + "/" + log.source);
    const io::WriteAtOnce now;  // other programs read it before the end of the command
    io::write_atomically(paths.back(), io::csv_text(log));
  }
  return paths;
}

const std::vector<BuiltInIdentifier>& built_in_identifiers() {
  using enum ident::Method;
  static const std::vector<BuiltInIdentifier> all{
      {"auto", "Stribeck, method auto", kAuto},
      {"least-squares", "Model A: Coulomb and viscous, from the pulses", kLeastSquaresA, true},
      {"velocity-map", "Model C: Gaussian-augmented map", kVelocityMap},
      {"position-map", "Model D: terms periodic in position", kPositionMap}};
  return all;
}

BoardAnswer answer_of(const BuiltInIdentifier& how, const BoardLogs& logs, const std::string& axis) {
  std::vector<io::Log> read = logs.logs;
  if (how.pulses_only) read.resize(1);
  LogOptions options;
  options.axis = axis;
  const AxisRecords records = axis_records(read, options);
  IdentifyOptions method;
  method.method = how.method;
  const Identification found = identify(records, method);
  return from_result(found.result, axis_file_model(found, records));
}

BoardAnswer answer_of(const BoardEntry& entry, const BoardMachine& board, std::size_t axis,
                      const std::vector<std::string>& logs, const std::string& folder, double seconds) {
  if (!entry.answers.empty()) return read_answer(entry.answers + "/" + name_of(board, axis));
  const std::string stem = folder + "/" + name_of(board, axis) + "-" + entry.name;
  std::vector<std::string> words = io::split_command(entry.command, entry.name);
  words.push_back(stem + ".toml");
  words.insert(words.end(), logs.begin(), logs.end());
  // An answer of an earlier run in the same folder is none of this one.
  for (const char* ending : {".toml", ".json"}) std::filesystem::remove(stem + ending);
  io::ProgramLimits limits;
  limits.seconds = seconds;
  limits.processor_seconds = seconds;
  limits.folder = entry.folder;
  io::run_to_end(words, limits);
  return read_answer(stem);
}

AnswerScore full_score(const BoardAnswer& answer, const sim::MachineAxis& axis, const BoardLogs& logs) {
  AnswerScore s = score_answer(answer, axis);
  s.held_out_error = 100.0 * ident::replay::force_error(answer.model, logs.held_out).filed_relative;
  if (!std::isfinite(s.curve_error) || !std::isfinite(s.mass_error))
    throw io::ProgramFailed("its friction is not a finite number at every speed");
  return s;
}

}  // namespace stribeck::workflow
