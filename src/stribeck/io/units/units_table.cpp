// Units without the units library: a table, and a reader of products, quotients and powers.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <stribeck/core/number_text.hpp>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/units/unit_text.hpp>
#include <stribeck/io/units/units_table.hpp>
#include <string>

namespace stribeck::io::detail {
namespace {

/// Powers of metre, kilogram, second, ampere, kelvin and radian.
using Powers = std::array<int, 6>;

struct TableUnit {
  double factor = 1.0;
  Powers powers{};
};

enum class Prefixes { kNone, kSymbols, kNames };

struct Row {
  std::string_view name;
  double factor;
  Powers powers;
  Prefixes prefixes = Prefixes::kNone;
};

constexpr double kPound = 0.45359237;       // [kg]
constexpr double kGravity = 9.80665;        // [m/s²], for forces named after a mass
constexpr double kInch = 0.0254;            // [m]
constexpr double kOunce = 28.349523125e-3;  // [kg]
constexpr double kDegree = kPi / 180.0;     // [rad]
constexpr double kTurn = 2.0 * kPi;         // [rad]
constexpr Powers kForce{1, 1, -2};
constexpr Powers kLength{1};
constexpr Powers kMass{0, 1};
constexpr Powers kTime{0, 0, 1};
constexpr Powers kAngle{0, 0, 0, 0, 0, 1};
constexpr Prefixes kSymbols = Prefixes::kSymbols;
constexpr Prefixes kNames = Prefixes::kNames;

constexpr std::array kUnits{
    Row{"m", 1.0, kLength, kSymbols},
    Row{"g", 1e-3, kMass, kSymbols},
    Row{"t", 1e3, kMass, kSymbols},
    Row{"s", 1.0, kTime, kSymbols},
    Row{"A", 1.0, {0, 0, 0, 1}, kSymbols},
    Row{"K", 1.0, {0, 0, 0, 0, 1}, kSymbols},
    Row{"rad", 1.0, kAngle, kSymbols},
    Row{"N", 1.0, kForce, kSymbols},
    Row{"Pa", 1.0, {-1, 1, -2}, kSymbols},
    Row{"bar", 1e5, {-1, 1, -2}, kSymbols},
    Row{"J", 1.0, {2, 1, -2}, kSymbols},
    Row{"W", 1.0, {2, 1, -3}, kSymbols},
    Row{"V", 1.0, {2, 1, -3, -1}, kSymbols},
    Row{"ohm", 1.0, {2, 1, -3, -2}, kNames},
    Row{"H", 1.0, {2, 1, -2, -2}, kSymbols},
    Row{"Hz", 1.0, {0, 0, -1}, kSymbols},
    Row{"meter", 1.0, kLength, kNames},
    Row{"metre", 1.0, kLength, kNames},
    Row{"gram", 1e-3, kMass, kNames},
    Row{"second", 1.0, kTime, kNames},
    Row{"sec", 1.0, kTime},
    Row{"ampere", 1.0, {0, 0, 0, 1}, kNames},
    Row{"kelvin", 1.0, {0, 0, 0, 0, 1}, kNames},
    Row{"radian", 1.0, kAngle, kNames},
    Row{"newton", 1.0, kForce, kNames},
    Row{"volt", 1.0, {2, 1, -3, -1}, kNames},
    Row{"watt", 1.0, {2, 1, -3}, kNames},
    Row{"hertz", 1.0, {0, 0, -1}, kNames},
    Row{"micron", 1e-6, kLength, kNames},
    Row{"Nm", 1.0, {2, 1, -2}, kSymbols},
    Row{"Arms", 1.0, {0, 0, 0, 1}},
    Row{"Aeff", 1.0, {0, 0, 0, 1}},
    Row{"min", 60.0, kTime},
    Row{"minute", 60.0, kTime},
    Row{"h", 3600.0, kTime},
    Row{"hr", 3600.0, kTime},
    Row{"hour", 3600.0, kTime},
    Row{"day", 86400.0, kTime},
    Row{"deg", kDegree, kAngle},
    Row{"Grad", kDegree, kAngle},
    Row{"degree", kDegree, kAngle},
    Row{"arc_degree", kDegree, kAngle},
    Row{"\u00B0", kDegree, kAngle},
    Row{"arcminute", kDegree / 60.0, kAngle},
    Row{"arcsecond", kDegree / 3600.0, kAngle},
    Row{"rev", kTurn, kAngle},
    Row{"revolution", kTurn, kAngle},
    Row{"U", kTurn, kAngle},
    Row{"rpm", kTurn / 60.0, {0, 0, -1, 0, 0, 1}},
    Row{"%", 0.01, {}},
    Row{"percent", 0.01, {}},
    Row{"pct", 0.01, {}},
    Row{"permille", 1e-3, {}},
    Row{"promille", 1e-3, {}},
    Row{"ppm", 1e-6, {}},
    Row{"count", 1.0, {}},
    Row{"in", kInch, kLength},
    Row{"inch", kInch, kLength},
    Row{"inches", kInch, kLength},
    Row{"ft", 12.0 * kInch, kLength},
    Row{"foot", 12.0 * kInch, kLength},
    Row{"feet", 12.0 * kInch, kLength},
    Row{"mil", 1e-3 * kInch, kLength},
    Row{"ipm", kInch / 60.0, {1, 0, -1}},
    Row{"IPM", kInch / 60.0, {1, 0, -1}},
    Row{"lb", kPound, kMass},
    Row{"lbs", kPound, kMass},
    Row{"pound", kPound, kMass},
    Row{"lbf", kPound* kGravity, kForce},
    Row{"avoirdupois_ounce", kOunce, kMass},
    Row{"ozf", 2.780139e-1, kForce},
    Row{"kgf", kGravity, kForce},
    Row{"gf", 1e-3 * kGravity, kForce},
    Row{"pi", kPi, {}},
};

struct Prefix {
  std::string_view symbol;
  std::string_view name;
  double factor;
};
constexpr std::array kPrefixes{
    Prefix{"T", "tera", 1e12},  Prefix{"G", "giga", 1e9},   Prefix{"M", "mega", 1e6},
    Prefix{"k", "kilo", 1e3},   Prefix{"h", "hecto", 1e2},  Prefix{"da", "deka", 1e1},
    Prefix{"d", "deci", 1e-1},  Prefix{"c", "centi", 1e-2}, Prefix{"m", "milli", 1e-3},
    Prefix{"u", "micro", 1e-6}, Prefix{"\u00B5", "", 1e-6}, Prefix{"\u03BC", "", 1e-6},
    Prefix{"n", "nano", 1e-9},  Prefix{"p", "pico", 1e-12},
};

bool is_figure(char c) { return c >= '0' && c <= '9'; }

const Row* row_of(std::string_view name) {
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), [&](const Row& r) { return r.name == name; });
  return found == kUnits.end() ? nullptr : &*found;
}

/// "newtons" is "newton".
const Row* row_of_name(std::string_view name) {
  if (const Row* row = row_of(name)) return row;
  const bool plural = name.size() > 3 && name.back() == 's';
  const Row* row = plural ? row_of(name.substr(0, name.size() - 1)) : nullptr;
  return row != nullptr && row->name.size() > 3 ? row : nullptr;
}

std::optional<TableUnit> named(std::string_view name) {
  if (const Row* row = row_of_name(name)) return TableUnit{row->factor, row->powers};
  for (const Prefix& p : kPrefixes) {
    for (const auto& [text, kind] : {std::pair{p.symbol, kSymbols}, {p.name, kNames}}) {
      if (text.empty() || !name.starts_with(text)) continue;
      const Row* row = row_of_name(name.substr(text.size()));
      if (row != nullptr && row->prefixes == kind) return TableUnit{p.factor * row->factor, row->powers};
    }
  }
  return {};
}

TableUnit raised(const TableUnit& u, int power) {
  TableUnit out{std::pow(u.factor, power), u.powers};
  for (int& p : out.powers) p *= power;
  return out;
}

TableUnit times(const TableUnit& a, const TableUnit& b, int power) {
  const TableUnit factor = raised(b, power);
  TableUnit out{a.factor * factor.factor, a.powers};
  for (std::size_t i = 0; i < out.powers.size(); ++i) out.powers[i] += factor.powers[i];
  return out;
}

/// product = factor {[ · | * | . | blank | / ] factor};  factor = (number | name | "(" product ")") [power]
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}

  std::optional<TableUnit> whole() {
    const auto unit = product();
    skip_blanks();
    return unit && rest_.empty() ? unit : std::nullopt;
  }

 private:
  std::optional<TableUnit> product() {
    auto all = factor();
    while (all) {
      skip_blanks();
      if (rest_.empty() || rest_.front() == ')') break;
      const int power = take("/") || take("per ") ? -1 : 1;
      if (power == 1 && !take("\u00B7") && !take("*")) take(".");
      const auto next = factor();
      if (!next) return {};
      all = times(*all, *next, power);
    }
    return all;
  }

  std::optional<TableUnit> factor() {
    skip_blanks();
    std::optional<TableUnit> unit;
    if (take("(")) {
      unit = product();
      if (!unit || !take(")")) return {};
    } else if (!rest_.empty() && is_figure(rest_.front())) {
      const auto number = parse_number_start();
      if (!number) return {};
      return TableUnit{*number, {}};
    } else {
      const std::string_view name = take_name();
      unit = name.empty() ? std::nullopt : named(name);
      if (!unit) return {};
    }
    const auto power = take_power();
    return raised(*unit, power);
  }

  std::optional<double> parse_number_start() {
    std::size_t n = 0;
    while (n < rest_.size() && (is_figure(rest_[n]) || rest_[n] == '.')) ++n;
    if (n + 1 < rest_.size() && rest_[n] == 'e' && is_figure(rest_[n + 1]))
      n = std::min(rest_.find_first_not_of("0123456789", n + 1), rest_.size());
    const double number = number_in(rest_.substr(0, n));
    rest_.remove_prefix(n);
    if (!(number > 0.0)) return {};
    return number;
  }

  /// Letters, and what begins beyond ASCII but is no dot and no raised digit.
  std::string_view take_name() {
    if (take("%")) return "%";
    std::size_t n = 0;
    while (n < rest_.size()) {
      const auto c = static_cast<unsigned char>(rest_[n]);
      const std::string_view here = rest_.substr(n);
      const bool special = here.starts_with("\u00B7") || here.starts_with("\u00B2") ||
                           here.starts_with("\u00B3") || here.starts_with("\u207B");
      if (special || !(std::isalpha(c) != 0 || c == '_' || c >= 0x80)) break;
      ++n;
    }
    const std::string_view name = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return name;
  }

  int take_power() {
    if (take("\u00B2")) return 2;
    if (take("\u00B3")) return 3;
    for (const auto& [text, power] : {std::pair{"\u207B\u00B9", -1}, {"\u207B\u00B2", -2}}) {
      if (take(text)) return power;
    }
    const std::string_view at = rest_;
    if (!take("^")) take("**");
    const int sign = take("-") ? -1 : 1;
    if (rest_.empty() || !is_figure(rest_.front())) {
      rest_ = at;  // a sign that is none is left over and makes the text unknown
      return 1;
    }
    const int power = sign * (rest_.front() - '0');
    rest_.remove_prefix(1);
    return power;
  }

  bool take(std::string_view text) {
    if (!rest_.starts_with(text)) return false;
    rest_.remove_prefix(text.size());
    return true;
  }
  void skip_blanks() {
    while (!rest_.empty() && rest_.front() == ' ') rest_.remove_prefix(1);
  }

  std::string_view rest_;
};

std::optional<TableUnit> in_table(std::string_view text) {
  const std::string unit = readable_unit(text);
  return unit.empty() ? std::nullopt : Reader(unit).whole();
}

}  // namespace

UnitAnswer find_unit_in_table(std::string_view from, std::string_view to) {
  const auto target = in_table(to);
  if (!target)
    throw InputError(
        Problem{"", 0, "", "unit " + in_quotes(to) + " of the program is not in the table of units"});
  const auto source = in_table(from);
  if (!source) return {UnitVerdict::kUnknownUnit};
  const bool hertz = from.find("Hz") != std::string_view::npos && to.find("Hz") == std::string_view::npos;
  if (hertz || source->powers != target->powers) return {UnitVerdict::kWrongDimension};
  return {UnitVerdict::kGood, conversion_by(source->factor / target->factor)};
}

bool known_in_table(std::string_view text) {
  return !without_blanks(text).empty() && in_table(text).has_value();
}

#ifdef __EMSCRIPTEN__
UnitAnswer find_unit(std::string_view from, std::string_view to) { return find_unit_in_table(from, to); }

bool known_unit(std::string_view text) { return known_in_table(text); }
#endif

}  // namespace stribeck::io::detail
