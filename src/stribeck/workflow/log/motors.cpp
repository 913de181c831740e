// Axes with several motors: which columns are theirs, and what one of them stands for.
#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/log/motors.hpp>
#include <stribeck/workflow/log/names/column_words.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

/// Whether the number at this place counts motors: behind the name of the axis or behind a word for a motor. Elsewhere it may count axes.
bool counts_motors(const std::string& name, std::size_t at, const std::string& axis) {
  std::string before = lower_case(name.substr(0, at));
  before.erase(before.find_last_not_of(" _-") + 1);
  const auto ends = [&](std::string_view word) { return !word.empty() && before.ends_with(word); };
  return ends(lower_case(axis)) || ends("motor") || ends("drive") || ends("antrieb");
}

/// The columns of the other motors of an axis: "Y1 Current", "Y2 Current"; "Motor1 A", "Motor2 A"; empty where one is missing.
std::vector<const io::Column*> of_other_motors(const io::Log& log, const std::string& axis,
                                               const io::Column& first, int motors) {
  const std::string& name = header_of(first);
  for (auto at = name.find('1'); at != std::string::npos; at = name.find('1', at + 1)) {
    if (!counts_motors(name, at, axis)) continue;
    std::vector<const io::Column*> all;
    for (int k = 2; k <= motors; ++k) {
      std::string other = name;
      other.replace(at, 1, std::to_string(k));
      const io::Column* c = log.find(other);
      if (c == nullptr || c->unit_text != first.unit_text || c->values.size() != first.values.size()) break;
      all.push_back(c);
    }
    if (all.size() + 1 == static_cast<std::size_t>(motors)) return all;
  }
  return {};
}

/// Correlation of two columns about their means (motors may be preloaded against each other); 0 where one of them is constant.
double correlation(const io::Column& a, const io::Column& b) {
  const std::size_t rows = std::min(a.values.size(), b.values.size());
  const auto each = [&](auto&& act) {
    for (std::size_t i = 0; i < rows; ++i) {
      if (std::isfinite(a.values[i]) && std::isfinite(b.values[i])) act(a.values[i], b.values[i]);
    }
  };
  double n = 0.0, mean_a = 0.0, mean_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  each([&](double x, double y) { n += 1.0, mean_a += x, mean_b += y; });
  if (n == 0.0) return 0.0;
  mean_a /= n, mean_b /= n;
  each([&](double x, double y) {
    aa += (x - mean_a) * (x - mean_a), bb += (y - mean_b) * (y - mean_b), ab += (x - mean_a) * (y - mean_b);
  });
  constexpr double kConstant = 1e-9;  // of the mean
  if (!(aa > n * std::pow(kConstant * mean_a, 2)) || !(bb > n * std::pow(kConstant * mean_b, 2))) return 0.0;
  return ab / std::sqrt(aa * bb);
}

constexpr double kMirrored = -0.8;

/// Sorts out the motors that turn the other way round for the same direction of the axis, and says what becomes of all.
void take_mirrored_apart(NamedColumn& from, int motors, std::vector<std::string>& notes) {
  std::string text =
      fmt::format("the axis has {} motors; {} and the same columns of the other motors are added", motors,
                  io::in_quotes(header_of(*from.column)));
  for (const io::Column* other : from.beside) {
    const double r = correlation(*from.column, *other);
    if (r > kMirrored) continue;
    from.against.push_back(other);
    text += fmt::format(
        ", but {} is subtracted: it runs against the first one (correlation {:.2f}), as the force of a motor that is "
        "mounted the other way round does",
        io::in_quotes(header_of(*other)), r);
  }
  for (const io::Column* other : from.against) std::erase(from.beside, other);
  notes.push_back(std::move(text));
}

/// A sum given with --map is used unchanged.
void note_mirrored(const NamedColumn& from, std::vector<std::string>& notes) {
  for (const io::Column* other : from.beside) {
    const double r = correlation(*from.column, *other);
    if (r > kMirrored) continue;
    notes.push_back(fmt::format(
        "{} runs against {} (correlation {:.2f}), and their sum leaves little of either: of a motor that is mounted the other way round "
        "the force counts with the other sign (leave --map out: with motors in the machine file it is subtracted)",
        io::in_quotes(header_of(*other)), io::in_quotes(header_of(*from.column)), r));
  }
}

/// Whether the name says that the column is the sum of all motors: "Y Drehmoment Summe", "Y_TotalTorque".
bool is_named_sum(const std::string& header) {
  std::string word;
  std::vector<std::string> words;
  for (std::size_t i = 0; i <= header.size(); ++i) {
    const char c = i < header.size() ? header[i] : ' ';
    const bool letter = std::isalpha(static_cast<unsigned char>(c)) != 0;
    const bool begins = std::isupper(static_cast<unsigned char>(c)) != 0 && !word.empty() &&
                        std::islower(static_cast<unsigned char>(header[i - 1])) != 0;
    if (!letter || begins) words.push_back(std::exchange(word, {}));
    if (letter) word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  // "Torque setpoint total" (r0079 of SINAMICS) is what one drive asks of its motor.
  const std::string all = lower_case(header);
  const auto has = [&](std::string_view what) { return all.find(what) != std::string::npos; };
  const bool of_one = has("setpoint") || has("soll") || has("r0079") || has("r79");
  return std::any_of(words.begin(), words.end(), [&](const std::string& w) {
    return w == "sum" || w == "summe" || w == "combined" || w.starts_with("summen") ||
           (!of_one && (w == "total" || w.starts_with("gesamt")));
  });
}

/// Of a log with the force of one motor alone.
std::string each_like(int motors, const std::string& column) {
  return fmt::format(
      "the axis has {} motors; each is taken to give as much as {} says (motors that are preloaded against each other do not: the preload "
      "then counts as a load; record the force of each)",
      motors, column);
}

}  // namespace

void take_all_motors(Effort& e, const AxisColumns& columns, int motors, std::vector<std::string>& notes) {
  if (motors < 2) return;
  const std::string first = io::in_quotes(header_of(*e.from.column));
  if (e.from.beside.empty()) {
    const std::vector<const io::Column*> others =
        of_other_motors(columns.log(), columns.axis(), *e.from.column, motors);
    if (columns.mapped(e.what)) {
      if (others.empty()) {
        notes.push_back(each_like(motors, first));
        return;
      }
      std::string sum = header_of(*e.from.column);
      for (const io::Column* other : others) sum += " + " + header_of(*other);
      notes.push_back(fmt::format(
          "the axis has {} motors, and {} stands for all of them; for their sum give --map {}=\"{}\"", motors,
          first, enum_name(e.what), sum));
      return;
    }
    if (others.empty() && is_named_sum(header_of(*e.from.column))) {
      notes.push_back(fmt::format(
          "the axis has {} motors; {} is taken for the sum of what they give, as its name says (if it is that of each, give --map "
          "{}=\"{} UNIT\")",
          motors, first, enum_name(e.what), e.from.column->name));
      e.factor /= motors;
      return;
    }
    e.from.beside = others;
    if (others.empty()) {
      notes.push_back(each_like(motors, first));
    } else {
      take_mirrored_apart(e.from, motors, notes);
    }
  } else {
    note_mirrored(e.from, notes);
  }
  if (e.from.beside.size() + e.from.against.size() + 1 == static_cast<std::size_t>(motors)) {
    e.factor /= motors;
  } else if (!e.from.beside.empty()) {
    refuse_option("--map", fmt::format("got a sum of {} columns, the axis has {} motors in the machine file",
                                       e.from.beside.size() + 1, motors));
  }
}

void note_second_motor(const Effort& e, const AxisColumns& columns, int motors,
                       std::vector<std::string>& notes) {
  if (!e.from.beside.empty() || columns.mapped(e.what)) return;
  auto others = of_other_motors(columns.log(), columns.axis(), *e.from.column, 2);
  // "Y1" and "Y2" may be two axes, or the two sides of a gantry.
  if (std::string axis = columns.axis(); others.empty() && axis.size() > 1 && axis.back() == '1') {
    axis.pop_back();
    others = of_other_motors(columns.log(), axis, *e.from.column, 2);
  }
  if (others.empty()) return;
  const std::string& one = header_of(*e.from.column);
  const std::string& other = header_of(*others.front());
  notes.push_back(fmt::format(
      "{} is the column of one motor, and {} of another one is not used: where both drive the axis, {}, or their sum with the gain of "
      "one motor, --map {}=\"{} + {}\"",
      io::in_quotes(one), io::in_quotes(other),
      motors > 1
          ? "name a unit that the machine file knows (‰, %, A or N m) and no --gain, so that its scale and both columns are taken"
          : "give a machine file with motors = 2",
      enum_name(e.what), one, other));
}

}  // namespace stribeck::workflow
