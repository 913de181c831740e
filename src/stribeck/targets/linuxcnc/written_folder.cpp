#include <fmt/format.h>
#include <zlib.h>
#include <filesystem>
#include <map>
#include <sstream>

#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/targets/linuxcnc/written_folder.hpp>

namespace stribeck::targets::linuxcnc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecord = "written.txt";

/// Length and CRC-32: detects an edited text, but no intended forgery.
std::string mark_of(std::string_view text) {
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size());
  return fmt::format("{} {:08x}", text.size(), crc);
}

/// Marks by file name from the last export; empty where there is no record.
std::map<std::string, std::string> recorded(const fs::path& folder) {
  std::map<std::string, std::string> marks;
  std::error_code ignored;
  if (!fs::is_regular_file(folder / kRecord, ignored)) return marks;
  std::istringstream lines(io::read_text((folder / kRecord).string()));
  for (std::string line; std::getline(lines, line);) {
    const auto blank = line.find(' ');
    if (!line.starts_with('#') && blank != std::string::npos)
      marks[line.substr(0, blank)] = line.substr(blank + 1);
  }
  return marks;
}

}  // namespace

WrittenFolder write_folder(const std::string& folder, const std::string& comment, const NamedTexts& files) {
  const auto path = [&](const std::string& name) { return (fs::path(folder) / name).string(); };
  const auto marks = recorded(folder);
  std::string record =
      comment +
      "# Length and CRC-32 of what export wrote: a file that was changed since is not written over.\n";
  for (const auto& [name, text] : files) record += fmt::format("{} {}\n", name, mark_of(text));

  WrittenFolder out;
  std::vector<std::string> foreign;
  NamedTexts open;
  std::error_code ignored;
  for (const auto& [name, text] : files) {
    io::check_writable(path(name));
    out.files.push_back(name);
    const std::string there = fs::exists(path(name), ignored) ? mark_of(io::read_text(path(name))) : "";
    const auto found = marks.find(name);
    const std::string before = found == marks.end() ? "" : found->second;
    if (there.empty() || there == before) {
      open.emplace_back(name, text);
    } else if (there != mark_of(text)) {
      // Edited, but the text to write has not changed: the edited file is kept.
      (before == mark_of(text) ? out.kept : foreign).push_back(name);
    }
  }
  io::check_writable(path(kRecord));
  if (!foreign.empty()) {
    throw io::InputError(
        {folder,
         0,
         {},
         fmt::format("{} {} not as export left {}, and would be overwritten (rename or remove {}, or "
                     "choose another folder)",
                     report::listed(foreign), foreign.size() == 1 ? "is" : "are",
                     foreign.size() == 1 ? "it" : "them", foreign.size() == 1 ? "it" : "them")});
  }
  for (const auto& [name, text] : open) {
    const auto what = text.starts_with("#!") ? io::FileIs::kProgram : io::FileIs::kData;
    io::write_atomically(path(name), text, what);
  }
  // Last: until then the old record holds for what has not been written yet.
  io::write_atomically(path(kRecord), record);
  out.files.emplace_back(kRecord);
  return out;
}

}  // namespace stribeck::targets::linuxcnc
