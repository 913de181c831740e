#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <apps/web/identify_view.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/report/pages/identify_report.hpp>
#include <stribeck/report/parameters.hpp>
#include <stribeck/report/shell_words.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/identify_text.hpp>
#include <stribeck/workflow/inspect.hpp>

namespace stribeck::web {

struct IdentifyView::Result {
  report::IdentifyReportInput page;
};

namespace {

workflow::LogOptions log_options(const IdentifyRequest& r) {
  workflow::LogOptions o;
  o.axis = r.axis;
  o.maps = r.maps;
  o.gain = r.gain;
  o.lead = r.lead;
  o.where = r.where;
  o.runs = r.runs;
  o.sample_time = r.sample_time;
  return o;
}

template <class E>
E word(const std::string& key, const std::string& text) {
  const auto value = enum_value<E>(text);
  if (!value)
    throw io::InputError({"request", 0, key, "got " + io::in_quotes(text) + ", expected a word of the list"});
  return *value;
}

workflow::IdentifyOptions identify_options(const IdentifyRequest& r) {
  workflow::IdentifyOptions o;
  o.method = word<workflow::Method>("method", r.method);
  o.model = word<workflow::ModelChoice>("model", r.model);
  o.mass = r.mass;
  return o;
}

io::Log read(const Upload& upload, const workflow::LogOptions& options) {
  io::Log log = workflow::read_log(upload.file.string(), options);
  log.source = upload.name;
  return log;
}

/// The command that does the same with the user's own files.
std::string command_of(const IdentifyRequest& r, const std::vector<report::InputFile>& logs) {
  std::string words = "stribeck identify";
  for (const report::InputFile& log : logs) words += " " + report::shell_quoted(log.file);
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words += fmt::format(" {} {}", option, report::shell_quoted(value));
  };
  add("--axis", r.axis);
  for (const std::string& m : r.maps) add("--map", m);
  add("--gain", r.gain);
  add("--lead", r.lead);
  for (const std::string& w : r.where) add("--where", w);
  for (const std::string& w : r.runs) add("--runs", w);
  add("--sample-time", r.sample_time);
  add("--mass", r.mass);
  if (r.method != "auto") add("--method", r.method);
  if (r.model != "auto") add("--model", r.model);
  return words + " -o axis.toml --report report";
}

/// Units and parameters as the page of the result has them: those of JSON are of a linear axis also where the axis turns.
nlohmann::ordered_json shown_of(const ident::Result& result) {
  const report::ShownUnits units = report::units_of(result);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const ident::Parameter& p : result.parameters) {
    const report::ShownParameter s = report::shown(p, units);
    const auto number = [](double x) {
      return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
    };
    all.push_back({{"name", p.name},
                   {"value", number(s.value)},
                   {"unit", s.unit},
                   {"ci95", {number(s.low), number(s.high)}},
                   {"identifiable", p.identifiable}});
  }
  return {{"rotary", units.in_degrees()},
          {"force", units.force},
          {"velocity", units.velocity},
          // Of velocities in mm/s where the axis is one, otherwise in its own unit.
          {"per_velocity", units.linear() ? units.per_velocity * 1e-3 : 1.0},
          {"parameters", std::move(all)}};
}

}  // namespace

nlohmann::ordered_json IdentifyView::inspect(const IdentifyRequest& r) const {
  const workflow::LogOptions options = log_options(r);
  workflow::LogOptions whole = options;
  std::erase_if(whole.maps, [](const std::string& map) { return map.starts_with(workflow::kNotUsed); });
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::string& id : r.logs) {
    const Upload upload = uploads_.find(id);
    io::Log log = read(upload, options);
    const workflow::Inspection found = workflow::inspect(log, options);
    nlohmann::ordered_json one = found.json;
    // A column that is left out can be chosen again.
    if (whole.maps.size() < options.maps.size()) {
      log = read(upload, whole);
      one["columns"] = workflow::inspect(log, whole).json["columns"];
    }
    // What the quantities of "axis" begin with.
    for (std::size_t i = 0; i < log.columns.size(); ++i) one["columns"][i]["header"] = log.columns[i].header;
    one["id"] = id;
    one["usable"] = found.usable;
    one["text"] = found.text;
    all.push_back(std::move(one));
  }
  return {{"logs", std::move(all)}};
}

nlohmann::ordered_json IdentifyView::identify(const IdentifyRequest& r) {
  const workflow::LogOptions options = log_options(r);
  const workflow::IdentifyOptions how = identify_options(r);
  workflow::check_options(how);
  std::vector<io::Log> logs;
  std::vector<report::InputFile> inputs;
  for (const std::string& id : r.logs) {
    const Upload upload = uploads_.find(id);
    logs.push_back(read(upload, options));
    inputs.push_back({upload.name, io::sha256_of_file(upload.file.string())});
  }
  const auto [axis, found] = workflow::identify_logs(logs, options, how);
  logs.clear();
  nlohmann::ordered_json json = workflow::to_json(found, axis.axis);
  json["text"] = workflow::text_of(found, axis.axis);
  json["axis_file"] = nullptr;
  json["axis_file_refused"] = nullptr;
  try {
    json["axis_file"] = workflow::axis_file_text(found, axis, version_);
  } catch (const io::InputError& e) {
    json["axis_file_refused"] = e.problems().front().message;
  }
  const std::string command = command_of(r, inputs);
  json["command"] = command;

  auto result = std::make_shared<Result>();
  result->page = workflow::page_of(found, axis);
  json["shown"] = shown_of(result->page.results.front());
  result->page.command = command;
  result->page.version = version_;
  result->page.inputs = std::move(inputs);
  const std::lock_guard lock(mutex_);
  kept_.emplace_back(std::to_string(next_++), std::move(result));
  if (kept_.size() > kMostKept) kept_.erase(kept_.begin());
  json["id"] = kept_.back().first;
  return json;
}

std::string IdentifyView::page(const std::string& id) const {
  std::shared_ptr<const Result> result;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const auto& k) { return k.first == id; });
    if (found == kept_.end())
      throw io::InputError(
          {"request", 0, "id", "got " + io::in_quotes(id) + ", which is not here any more (identify again)"});
    result = found->second;
  }
  return report::identify_report(result->page);
}

std::string IdentifyView::in_words(std::string message) const {
  const std::string prefix = uploads_.folder().string() + "/";
  for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix, at)) {
    std::size_t end = message.find('/', at + prefix.size());
    end = end == std::string::npos ? at + prefix.size() : end + 1;
    message.erase(at, end - at);
  }
  return message;
}

}  // namespace stribeck::web
