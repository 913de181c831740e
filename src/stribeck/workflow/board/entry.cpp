#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stribeck/io/process/outside_program.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/board/entry.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

/// The file name without folder and ending, as a name may be.
std::string name_from(const std::string& path) {
  std::filesystem::path p(path);
  if (!p.has_filename()) p = p.parent_path();
  std::string name;
  for (const char c : p.stem().string()) {
    if (name.size() == 16) break;
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += c;
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  return name.empty() ? "entry" : name;
}

/// A program that cannot be found is a slip of the pen, not an entry that fails.
void require_program(const std::string& option, const std::string& program) {
  const auto runs = [](const std::string& path) { return ::access(path.c_str(), X_OK) == 0; };
  if (program.find('/') != std::string::npos) {
    if (runs(program)) return;
  } else {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');) {
      if (runs(folder + "/" + program)) return;
    }
  }
  refuse_option(
      option,
      fmt::format(
          "{}: no such program, or it may not be run (write \"python3 {}\" for a script, ./NAME for a "
          "program in this folder)",
          io::in_quotes(program), program));
}

}  // namespace

BoardEntry read_entry(const std::string& file) {
  BoardEntry entry = io::read_toml<BoardEntry>(file);
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  for (std::string* path : {&entry.shared_object, &entry.controller, &entry.answers}) {
    if (!path->empty()) *path = (folder / *path).string();
  }
  if (!entry.command.empty()) static_cast<void>(io::split_command(entry.command, file));
  entry.folder = folder.string();
  return entry;
}

BoardEntry entry_of(const std::string& option, const std::string& text) {
  BoardEntry entry;
  std::string named = text;
  if (option == "--answers") {
    entry.track = Track::kIdentification;
    entry.answers = text;
  } else if (option == "--controller" && text.ends_with(".so")) {
    entry.shared_object = std::filesystem::absolute(text).string();
  } else if (option == "--controller" && text.ends_with(".toml")) {
    entry.controller = text;
  } else {
    entry.track = option == "--identifier" ? Track::kIdentification : Track::kControl;
    entry.command = text;
    const std::vector<std::string> words = io::split_command(text, option);
    if (!words.empty()) require_program(option, words.front());
    // "python3 fit.py" is called fit.
    for (const std::string& word : words) {
      named = word;
      if (word.find('.') != std::string::npos) break;
    }
  }
  entry.name = name_from(named);
  entry.label = text.size() <= 60 ? text : text.substr(0, 57) + "...";
  return entry;
}

void check_names(const std::vector<BoardEntry>& entries) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto same = [&](const BoardEntry& e) {
      return e.track == entries[i].track && e.name == entries[i].name;
    };
    if (std::any_of(entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(i), same))
      refuse_option("ENTRY", fmt::format("two entries of the track {} are called {} (change the name of one)",
                                         enum_name(entries[i].track), entries[i].name));
  }
}

}  // namespace stribeck::workflow
