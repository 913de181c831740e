#include <fmt/format.h>

#include <algorithm>
#include <stribeck/report/said_once.hpp>

namespace stribeck::report {
namespace {

struct Said {
  std::vector<std::string> logs;  ///< none: the text is about no log, or names it itself
  std::string text;
};

Said taken_apart(const std::string& note, const std::vector<std::string>& logs) {
  for (const std::string& log : logs) {
    const std::string head = log + ": ";
    if (note.starts_with(head)) return {{log}, note.substr(head.size())};
  }
  return {{}, note};
}

std::string in_words(const Said& said) {
  constexpr std::size_t kMost = 4;  // names
  const std::vector<std::string>& logs = said.logs;
  if (logs.empty()) return said.text;
  if (logs.size() <= kMost) return fmt::format("{}: {}", fmt::join(logs, ", "), said.text);
  return fmt::format("{}, {} and {} other logs: {}", logs[0], logs[1], logs.size() - 2, said.text);
}

}  // namespace

std::vector<std::string> said_once(const std::vector<std::string>& notes,
                                   const std::vector<std::string>& logs) {
  std::vector<Said> all;
  for (const std::string& note : notes) {
    Said one = taken_apart(note, logs);
    const auto same = std::find_if(all.begin(), all.end(), [&one](const Said& said) {
      return said.text == one.text && said.logs.empty() == one.logs.empty();
    });
    if (same == all.end())
      all.push_back(std::move(one));
    else if (!one.logs.empty() &&
             std::find(same->logs.begin(), same->logs.end(), one.logs[0]) == same->logs.end())
      same->logs.push_back(std::move(one.logs[0]));
  }
  std::vector<std::string> out;
  for (const Said& said : all) out.push_back(in_words(said));
  return out;
}

}  // namespace stribeck::report
