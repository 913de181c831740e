#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>

#include <stribeck/io/error.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/workflow/log/columns.hpp>
#include <stribeck/workflow/log/runs.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

const io::Column& column_for(const io::Log& log, const std::string& option, const std::string& name) {
  const io::Column* c = log.find(name);
  if (c == nullptr) {
    std::string message;
    try {
      static_cast<void>(log.at(name));
    } catch (const io::InputError& e) {
      message = e.problems().front().message;
    }
    refuse_option(option, message);
  }
  const std::size_t rows = c->texts.empty() ? c->values.size() : c->texts.size();
  if (rows != log.rows)
    refuse_option(option, fmt::format("column {} has {} rows of {}, expected all", io::in_quotes(name), rows,
                                      log.rows));
  return *c;
}

std::optional<double> as_number(const std::string& text) {
  // Whatever the decimal sign of the process that calls is.
  double value = 0.0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

std::vector<std::uint8_t> rows_with(const io::Log& log, const std::string& where) {
  const auto equals = where.rfind('=');
  if (equals == std::string::npos || equals == 0)
    refuse_option("--where", fmt::format("got {}, expected COLUMN=VALUE", io::in_quotes(where)));
  const std::string value = where.substr(equals + 1);
  const io::Column& c = column_for(log, "--where", where.substr(0, equals));
  const auto number = as_number(value);
  const auto refuse = [&](std::string message) {
    throw io::InputError({log.source, 0, "--where", std::move(message)});
  };
  if (c.texts.empty() && !number)
    refuse(fmt::format("got {}, expected a number as in column {}", io::in_quotes(value),
                       io::in_quotes(c.name)));
  std::vector<std::uint8_t> has(log.rows);
  for (std::size_t k = 0; k < log.rows; ++k)
    has[k] = (c.texts.empty() ? c.values[k] == *number : c.texts[k] == value) ? 1 : 0;
  if (std::find(has.begin(), has.end(), 1) == has.end())
    refuse(fmt::format("no row has {}", io::in_quotes(where)));
  return has;
}

Selection select_rows(const io::Log& log, const LogOptions& options) {
  Selection s;
  if (options.where.empty() && options.runs.empty()) return s;
  s.all = false;
  std::vector<std::uint8_t> counts(log.rows, 1);
  for (const std::string& text : options.where) {
    const std::vector<std::uint8_t> has = rows_with(log, text);
    for (std::size_t k = 0; k < log.rows; ++k) counts[k] = counts[k] != 0 && has[k] != 0 ? 1 : 0;
  }
  std::vector<const io::Column*> marks;
  for (const std::string& name : options.runs) marks.push_back(&column_for(log, "--runs", name));
  std::size_t last = 0;
  for (std::size_t k = 0; k < log.rows; ++k) {
    if (counts[k] == 0) continue;
    bool begins = s.runs.empty();
    for (const io::Column* c : marks) {
      if (begins) break;
      begins = c->texts.empty() ? c->values[k] != c->values[last] : c->texts[k] != c->texts[last];
    }
    if (begins) s.runs.emplace_back();
    s.runs.back().push_back(k);
    last = k;
  }
  if (s.runs.empty()) refuse_option("--where", "no row is left");
  return s;
}

std::string run_name(const io::Log& log, const LogOptions& options, std::size_t row) {
  std::string name;
  for (const std::string& column : options.runs) {
    const io::Column& c = *log.find(column);
    name += (name.empty() ? "" : ", ") + column + "=" +
            (c.texts.empty() ? io::number_text(c.values[row]) : c.texts[row]);
  }
  return name.empty() ? log.source : log.source + " (" + name + ")";
}

std::string marks_of_runs(const io::Log& log, const std::vector<double>& t) {
  std::vector<std::size_t> starts;
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (t[k] < t[k - 1]) starts.push_back(k);
  }
  if (starts.empty() || t.size() != log.rows) return {};
  std::string names;
  for (const io::Column& c : log.columns) {
    const bool text = !c.texts.empty();
    if ((text ? c.texts.size() : c.values.size()) != log.rows) continue;
    std::size_t inside = 0;
    std::size_t at_start = 0;
    std::size_t next = 0;
    for (std::size_t k = 1; k < log.rows && inside == 0; ++k) {
      const bool start = next < starts.size() && starts[next] == k;
      if (start) ++next;
      if (!(text ? c.texts[k] != c.texts[k - 1] : c.values[k] != c.values[k - 1])) continue;
      ++(start ? at_start : inside);
    }
    if (inside == 0 && at_start > 0) names += (names.empty() ? "" : ", ") + io::in_quotes(header_of(c));
  }
  return names;
}

}  // namespace stribeck::workflow
