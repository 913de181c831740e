#include <fmt/core.h>

#include <cmath>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/log/record_limits.hpp>

namespace stribeck::ident::log {
namespace {

void check_column(const Record& record, const char* name, const std::vector<double>& column,
                  std::vector<std::string>& found) {
  if (column.size() != record.t.size()) {
    found.push_back(record.source + fmt::format(": column {} has {} rows, expected {} as in column t", name,
                                                column.size(), record.t.size()));
    return;
  }
  for (std::size_t k = 0; k < column.size(); ++k) {
    if (!(std::abs(column[k]) < kAbsurd)) {
      found.push_back(
          record.source +
          fmt::format(": column {}, row {}: {:g} is too large for any machine; repair or cut the log, or "
                      "check its unit",
                      name, k, column[k]));
      return;
    }
  }
}

}  // namespace

std::vector<std::string> problems(const Record& record) {
  std::vector<std::string> found;
  if (!(record.sample_time > 0.0) || !std::isfinite(record.sample_time)) {
    found.push_back(record.source +
                    fmt::format(": sample time is {:g} s, expected a positive number", record.sample_time));
  }
  if (record.t.size() < kFewestRows) {
    found.push_back(record.source +
                    fmt::format(": {} rows, expected at least {}", record.t.size(), kFewestRows));
  }
  check_column(record, "t", record.t, found);
  check_column(record, "x", record.x, found);
  check_column(record, "f", record.f, found);
  if (!record.r.empty()) check_column(record, "r", record.r, found);
  if (!record.v.empty()) check_column(record, "v", record.v, found);
  if (!found.empty()) return found;
  for (std::size_t k = 1; k < record.t.size(); ++k) {
    const double step = record.t[k] - record.t[k - 1];
    if (std::abs(step - record.sample_time) > kJitter * record.sample_time) {
      found.push_back(
          record.source +
          fmt::format(": column t, row {}: step of {:g} s, expected {:g} s; resample or cut the log", k, step,
                      record.sample_time));
      break;
    }
  }
  return found;
}

}  // namespace stribeck::ident::log
