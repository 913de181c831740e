#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/workflow/commissioning/originals.hpp>

namespace stribeck::workflow::commissioning {
namespace {

namespace fs = std::filesystem;
using io::Json;

std::string sum_of(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) ? io::sha256_of_file(path) : std::string();
}

Json read_list(const std::string& folder) {
  const std::string file = folder + "/originals/originals.json";
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return Json::array();
  Json list = Json::parse(io::read_text(file), nullptr, false);
  if (!list.is_array())
    throw io::InputError(
        {file, 0, {}, "is not what this program wrote; restore the files beside it by hand"});
  return list;
}

[[noreturn]] void refuse_changed(const std::string& path) {
  throw io::InputError(
      {path,
       0,
       {},
       "was changed by somebody else since it was written here, and is left as it is (its original is in the folder originals; move "
       "the changed file away and give the command again)"});
}

/// Whether a file is the original or one that was written here.
bool ours(const Json& one, const std::string& sum) {
  if (sum == one.value("before", "")) return true;
  const Json& written = one.at("written");
  return std::find(written.begin(), written.end(), sum) != written.end();
}

/// Copies a file as it is into the folder of originals. Gives its entry of the list.
Json kept_original(const std::string& folder, std::size_t number, const std::string& path,
                   const std::string& text) {
  const std::string before = sum_of(path);
  const std::string kept = fmt::format("{}-{}", number, fs::path(path).filename().string());
  std::error_code error;
  if (!before.empty()) {
    fs::copy_file(path, folder + '/' + kept, fs::copy_options::overwrite_existing, error);
    if (error) throw io::InputError({path, 0, {}, "cannot be kept: " + error.message()});
  }
  return {
      {"path", path}, {"kept", kept}, {"before", before}, {"written", {io::hexadecimal(io::sha256(text))}}};
}

/// A new list of originals, renamed into place.
void keep_originals(const std::string& folder,
                    const std::vector<std::pair<std::string, std::string>>& files) {
  const std::string work = folder + "/.originals";
  std::error_code error;
  fs::remove_all(work, error);
  io::make_directory(work);
  Json list = Json::array();
  for (std::size_t i = 0; i < files.size(); ++i) {
    list.push_back(kept_original(work, i, fs::absolute(files[i].first).string(), files[i].second));
  }
  io::write_atomically(work + "/originals.json", io::dump(list));
  fs::rename(work, folder + "/originals", error);
  if (error) throw io::InputError({folder + "/originals", 0, {}, "cannot be written: " + error.message()});
}

}  // namespace

void replace_files(const std::string& folder, const std::vector<std::pair<std::string, std::string>>& files) {
  Json list = read_list(folder);
  if (list.empty()) {
    keep_originals(folder, files);
  } else {
    for (const Json& one : list) {
      if (!ours(one, sum_of(one.value("path", "")))) refuse_changed(one.value("path", ""));
    }
    for (const auto& [file, text] : files) {
      const std::string path = fs::absolute(file).string();
      const auto known = std::find_if(list.begin(), list.end(),
                                      [&](const Json& one) { return one.value("path", "") == path; });
      if (known != list.end()) {
        known->at("written").push_back(io::hexadecimal(io::sha256(text)));
      } else {
        list.push_back(kept_original(folder + "/originals", list.size(), path, text));
      }
    }
    io::write_atomically(folder + "/originals/originals.json", io::dump(list));
  }
  for (const auto& [path, text] : files) io::write_atomically(path, text);
}

std::vector<std::string> restore_files(const std::string& folder) {
  const Json list = read_list(folder);
  for (const Json& one : list) {
    const std::string now = sum_of(one.value("path", ""));
    if (!now.empty() && !ours(one, now)) refuse_changed(one.value("path", ""));
  }
  std::vector<std::string> changed;
  std::error_code error;
  for (const Json& one : list) {
    const std::string path = one.value("path", "");
    if (sum_of(path) == one.value("before", "")) continue;
    if (one.value("before", "").empty()) {
      fs::remove(path, error);
    } else {
      io::write_atomically(path, io::read_text(folder + "/originals/" + one.value("kept", "")));
    }
    if (error || sum_of(path) != one.value("before", ""))
      throw io::InputError({path, 0, {}, "could not be put back: " + error.message()});
    changed.push_back(path);
  }
  fs::remove_all(folder + "/originals", error);
  return changed;
}

std::string with_halfile(const std::string& ini, const std::string& name) {
  std::size_t at = 0;
  std::size_t place = std::string::npos;
  std::string end = "\n";
  bool inside = false;
  while (at < ini.size()) {
    std::size_t next = ini.find('\n', at);
    next = next == std::string::npos ? ini.size() : next + 1;
    std::string line = ini.substr(at, next - at);
    const bool crlf = line.ends_with("\r\n");
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) line.pop_back();
    const std::size_t first = line.find_first_not_of(" \t");
    line.erase(0, first == std::string::npos ? line.size() : first);
    if (line.starts_with('[')) inside = line.starts_with("[HAL]");
    if (inside && line.starts_with("HALFILE")) {
      const std::size_t equals = line.find('=');
      std::string value = equals == std::string::npos ? std::string() : line.substr(equals + 1);
      value.erase(0, std::min(value.find_first_not_of(" \t"), value.size()));
      if (value == name) return ini;
      place = next;
      end = crlf ? "\r\n" : "\n";
    }
    at = next;
  }
  if (place == std::string::npos) return {};
  std::string line = "HALFILE = " + name + end;
  if (ini[place - 1] != '\n') line = end + line;
  return ini.substr(0, place) + line + ini.substr(place);
}

}  // namespace stribeck::workflow::commissioning
