#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include <apps/web/machines.hpp>
#include <apps/web/offline/offline_page.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>

namespace stribeck::web {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kNoMachines = R"(id="machines">{}</script>)";

/// Beside an installed program, and beside one in the folder where it was built.
fs::path found_page() {
  std::error_code wrong;
  const fs::path folder = fs::read_symlink("/proc/self/exe", wrong).parent_path();
  const std::array<fs::path, 2> places{folder / "../share/stribeck/stribeck.html",
                                       folder / "../offline/stribeck.html"};
  for (const fs::path& place : places) {
    if (fs::is_regular_file(place, wrong)) return place;
  }
  throw io::InputError({places.front().lexically_normal().string(),
                        0,
                        {},
                        "no such file: this program came without the page that computes in a browser "
                        "(tools/make-offline-page of the source makes it)"});
}

}  // namespace

std::string offline_page(const std::vector<std::pair<std::string, std::string>>& machines) {
  const fs::path file = found_page();
  std::string page = io::read_text(file.string());
  const auto at = page.find(kNoMachines);
  if (at == std::string::npos)
    throw io::InputError(
        {file.string(), 0, {}, "expected a page of tools/make-offline-page of this version"});
  nlohmann::ordered_json all = nlohmann::ordered_json::object();
  for (const auto& [name, text] : machines) all[name] = text;
  std::string json = all.dump();
  // No text of a file ends the script.
  for (auto less = json.find('<'); less != std::string::npos; less = json.find('<', less))
    json.replace(less, 1, "\\u003c");
  return page.replace(at, kNoMachines.size(), R"(id="machines">)" + json + "</script>");
}

std::vector<std::pair<std::string, std::string>> machine_files(const std::string& folder) {
  constexpr std::string_view kFolder = "folder/";
  std::vector<std::pair<std::string, std::string>> all;
  const Machines machines(folder);
  for (const auto& one : machines.list()) {
    const std::string id = one["id"];
    if (id.starts_with(kFolder))
      all.emplace_back(one["file"], io::read_text((fs::path(folder) / std::string(one["file"])).string()));
  }
  return all;
}

}  // namespace stribeck::web
