#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/identify.hpp>
#include <stribeck/workflow/log/fingerprint.hpp>
#include <stribeck/workflow/stages/sorted_logs.hpp>

namespace stribeck::workflow {
namespace {

namespace fs = std::filesystem;

/// Whether a JSON file is a result of this program, and not a log.
bool is_result(const fs::path& file) {
  constexpr std::size_t kHead = 400;
  std::string head(kHead, ' ');
  std::ifstream(file, std::ios::binary).read(head.data(), static_cast<std::streamsize>(kHead));
  return head.find("\"schema\"") != std::string::npos && head.find("\"stribeck.") != std::string::npos;
}

/// The files of the folder in the order of their names; hidden ones and those of this program are left out.
std::vector<std::string> files_in(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    static constexpr std::array<std::string_view, 5> kOthers{".toml", ".html", ".ngc", ".hal", ".md"};
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') || !entry.is_regular_file()) continue;
    if (std::find(kOthers.begin(), kOthers.end(), entry.path().extension().string()) != kOthers.end())
      continue;
    if (entry.path().extension() == ".json" && is_result(entry.path())) continue;
    files.push_back(entry.path().string());
  }
  if (error) throw io::InputError({folder, 0, {}, "cannot be read: " + error.message()});
  std::sort(files.begin(), files.end());
  return files;
}

/// The logs of an axis that are no copies; a model that is verified on a copy is verified on itself.
class Recordings {
 public:
  /// Adds a log, or takes it in place of one whose rows it holds. The note says which is left out; empty: none.
  std::string add(const std::string& file, Fingerprint print, std::vector<std::string>& logs) {
    for (const auto& [name, other] : known_) {
      if (print.within(other)) return copy_note(file, name);
    }
    std::string notes;
    const auto held = [&](const auto& one) {
      if (!one.second.within(print)) return false;
      std::erase(logs, one.first);
      notes += (notes.empty() ? "" : "; ") + copy_note(one.first, file);
      return true;
    };
    std::erase_if(known_, held);
    known_.emplace_back(file, std::move(print));
    logs.push_back(file);
    return notes;
  }

 private:
  std::vector<std::pair<std::string, Fingerprint>> known_;
};

}  // namespace

std::vector<LogsOfAxis> sorted_logs(const StageOptions& o, const MachineDescription& machine,
                                    std::vector<std::string>& skipped) {
  std::vector<LogsOfAxis> all;
  for (const auto& [name, axis] : machine.axes) {
    if (o.log.axis.empty() || o.log.axis == name) {
      all.push_back({name, o.log, {}});
      all.back().options.axis = name;
    }
  }
  std::vector<Recordings> recordings(all.size());
  for (const std::string& file : files_in(o.folder)) {
    const auto take = [&](const LogsOfAxis& one) {
      const AxisRecords read = measured(read_axis({file}, one.options));
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].axis != one.axis) continue;
        const std::string copy = recordings[i].add(file, Fingerprint(read.records), all[i].logs);
        if (!copy.empty()) skipped.push_back(fmt::format("axis {}: {}", one.axis, copy));
        all[i].options = one.options;
      }
    };
    const auto or_skip = [&](const auto& act, const std::string& axis) {
      const auto skip = [&](const std::string& why) {
        skipped.push_back(axis.empty() ? why : fmt::format("axis {}: {}", axis, why));
      };
      try {
        act();
      } catch (const io::InputError& e) {
        skip(e.what());
      } catch (const ident::Refused& e) {
        skip(e.what());
      }
    };
    or_skip(
        [&] {
          const std::vector<LogsOfAxis> found = logs_by_axis(machine, {file}, o.log);
          for (const LogsOfAxis& one : found)
            or_skip([&] { take(one); }, found.size() > 1 ? one.axis : std::string());
        },
        {});
  }
  return all;
}

}  // namespace stribeck::workflow
