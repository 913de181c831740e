#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include <stribeck/core/number_text.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/workflow/commissioning/changed_values.hpp>

namespace stribeck::workflow::commissioning {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> value_of(RunningMachine& machine, const std::string& name) {
  for (const HalItem& p : machine.parameters(name)) {
    if (p.name == name) return p.value;
  }
  return std::nullopt;
}

/// HAL prints seven digits.
bool same_value(const std::string& a, const std::string& b) {
  const double x = number_in(a);
  const double y = number_in(b);
  if (std::isnan(x) || std::isnan(y)) return std::isnan(x) == std::isnan(y);
  return std::abs(x - y) <= 1e-6 * std::max(std::abs(x), std::abs(y));
}

io::Json read_changes(const std::string& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return io::Json::array();
  io::Json all = io::Json::parse(io::read_text(file), nullptr, false);
  if (!all.is_array()) throw io::InputError({file, 0, {}, "is no list of changed values (remove it)"});
  return all;
}

}  // namespace

void ChangedValues::set(const std::vector<std::pair<std::string, std::string>>& values) {
  io::Json all = read_changes(file_);
  std::vector<std::vector<std::string>> commands;
  for (const auto& [name, value] : values) {
    commands.push_back({"setp", name, value});
    bool known = false;
    for (io::Json& one : all) {
      if (one.value("name", "") != name) continue;
      one["now"] = value;
      known = true;
    }
    if (known) continue;
    const std::optional<std::string> before = value_of(machine_, name);
    if (!before) throw MachineError("HAL has no parameter " + name);
    all.push_back({{"name", name}, {"before", *before}, {"now", value}});
  }
  io::write_atomically(file_, io::dump(all));
  machine_.hal(commands);
}

bool end_safely(RunningMachine& machine, const std::string& file) {
  const auto done = [](const auto& step) {
    try {
      step();
      return true;
    } catch (const std::exception&) {
      return false;
    }
  };
  std::error_code ignored;
  const bool changed = fs::exists(file, ignored);
  const bool off = !changed || done([&] { machine.switch_off(); });
  done([&] { machine.stop(); });
  done([&] { machine.end_record(); });
  return off && done([&] { ChangedValues(machine, file).give_back(); });
}

void ChangedValues::give_back() {
  std::vector<std::vector<std::string>> commands;
  for (const io::Json& one : read_changes(file_)) {
    const std::string name = one.value("name", "");
    const std::optional<std::string> now = value_of(machine_, name);
    if (now && same_value(*now, one.value("now", "")))
      commands.push_back({"setp", name, one.value("before", "")});
  }
  if (!commands.empty()) machine_.hal(commands);
  keep();
}

void ChangedValues::keep() {
  std::error_code ignored;
  fs::remove(file_, ignored);
}

std::vector<std::pair<std::string, std::string>> setp_lines(const std::string& hal) {
  std::vector<std::pair<std::string, std::string>> out;
  std::istringstream lines(hal);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string command;
    std::string name;
    std::string value;
    if (words >> command >> name >> value && command == "setp") out.emplace_back(name, value);
  }
  return out;
}

}  // namespace stribeck::workflow::commissioning
