#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <string_view>

#include <stribeck/io/file.hpp>
#include <stribeck/workflow/judge/own_logs.hpp>

namespace stribeck::workflow {
namespace {

/// The logs that the first line of an axis file names: "…, identified from a.csv, b.csv by stribeck …".
std::vector<std::string> logs_in_head(const std::string& path) {
  constexpr std::string_view kFrom = "identified from ", kBy = " by stribeck ";
  const std::string text = io::read_text(path);
  const std::string head = text.substr(0, text.find('\n'));
  const auto from = head.find(kFrom), by = head.rfind(kBy);
  if (!head.starts_with('#') || from == std::string::npos || by == std::string::npos || by < from) return {};
  std::vector<std::string> logs;
  std::string rest = head.substr(from + kFrom.size(), by - from - kFrom.size());
  for (auto comma = rest.find(", "); comma != std::string::npos; comma = rest.find(", ")) {
    logs.push_back(rest.substr(0, comma));
    rest.erase(0, comma + 2);
  }
  logs.push_back(rest);
  return logs;
}

}  // namespace

std::vector<std::string> notes_on_own_logs(const std::string& model, const std::vector<std::string>& logs) {
  namespace fs = std::filesystem;
  std::vector<std::string> notes;
  const std::vector<std::string> known = logs_in_head(model);
  for (const std::string& log : logs) {
    const bool own = std::any_of(known.begin(), known.end(), [&](const std::string& k) {
      return fs::path(k).filename() == fs::path(log).filename();
    });
    if (own)
      notes.push_back(fmt::format(
          "{}: its first line names {} among the logs that it was identified from: if that is this file, its error does not show how right the "
          "model is (verify on a log that identify has not seen)",
          model, fs::path(log).filename().string()));
  }
  return notes;
}

}  // namespace stribeck::workflow
