#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include <apps/web/machines.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::web {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBuiltIn = "built-in/";
constexpr std::string_view kFolder = "folder/";
constexpr std::uintmax_t kLargestFile = 1U << 20;
constexpr std::size_t kMostFiles = 200;

/// A file itself in the folder, not one that a link leads to elsewhere.
bool is_inside(const fs::path& file, const fs::path& folder) {
  std::error_code wrong;
  const fs::path real = fs::canonical(file, wrong);
  return !wrong && real.parent_path() == folder && fs::is_regular_file(real, wrong) &&
         fs::file_size(real, wrong) <= kLargestFile && !wrong;
}

/// A file of another verb, such as a study or an axis file, is no machine file that is wrong.
bool looks_like_machine(const std::string& text, const std::string& name) {
  try {
    const io::Node root = io::parse_toml(text, name);
    return root.find("axes") != nullptr && root.find("sample_time") != nullptr;
  } catch (const io::InputError&) {
    return false;
  }
}

}  // namespace

Machines::Machines(const fs::path& folder) : folder_(fs::canonical(folder)) {}

std::vector<MachineName> Machines::names() const {
  std::vector<MachineName> all;
  for (const std::string& name : workflow::built_in_machines())
    all.push_back({std::string(kBuiltIn) + name, "machines/" + name + ".toml"});
  std::vector<std::string> files;
  std::error_code wrong;
  for (fs::directory_iterator i(folder_, wrong), end; !wrong && i != end; i.increment(wrong)) {
    if (i->path().extension() == ".toml" && is_inside(i->path(), folder_))
      files.push_back(i->path().filename().string());
  }
  std::sort(files.begin(), files.end());
  if (files.size() > kMostFiles) files.resize(kMostFiles);
  for (const std::string& file : files) all.push_back({std::string(kFolder) + file, file});
  return all;
}

std::pair<sim::Machine, MachineName> Machines::read(const std::string& id) const {
  const std::vector<MachineName> all = names();
  const auto found = std::find_if(all.begin(), all.end(), [&](const MachineName& m) { return m.id == id; });
  if (found == all.end()) {
    throw io::InputError(
        {"request", 0, "machine",
         "got " + io::in_quotes(id) + ", expected a machine of the list (load the page again)"});
  }
  if (id.starts_with(kBuiltIn)) return {workflow::built_in_machine(id.substr(kBuiltIn.size())), *found};
  return {workflow::read_virtual_machine((folder_ / found->file).string()), *found};
}

nlohmann::ordered_json Machines::list() const {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const MachineName& m : names()) {
    nlohmann::ordered_json one{{"id", m.id}, {"file", m.file}, {"name", m.file}, {"refused", nullptr}};
    try {
      if (m.id.starts_with(kFolder) &&
          !looks_like_machine(io::read_text((folder_ / m.file).string()), m.file))
        continue;
      const sim::Machine machine = read(m.id).first;
      one["name"] = machine.name;
    } catch (const std::exception& e) {
      one["refused"] = e.what();
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace stribeck::web
