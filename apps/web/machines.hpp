#pragma once
/// The machine files that a user may choose: those that are built in, and those in the folder that is served. Only names of this list
/// lead to a file; a name that a request makes up leads nowhere.
/// Real time: no.
/// Errors: InputError.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stribeck/sim/machine.hpp>
#include <string>
#include <vector>

namespace stribeck::web {

struct MachineName {
  std::string id;    ///< "built-in/biaxial-table" or "folder/mine.toml"
  std::string file;  ///< as messages name it: "machines/biaxial-table.toml", "mine.toml"
};

class Machines {
 public:
  /// The folder must exist.
  explicit Machines(const std::filesystem::path& folder);

  [[nodiscard]] std::vector<MachineName> names() const;
  /// A virtual machine. Throws for an unknown id, and for a file that is none.
  [[nodiscard]] std::pair<sim::Machine, MachineName> read(const std::string& id) const;

  /// [{"id", "name", "origin", "refused"}]: files of the folder that are no machine are left out, those that are wrong say why.
  [[nodiscard]] nlohmann::ordered_json list() const;

 private:
  std::filesystem::path folder_;  ///< canonical
};

}  // namespace stribeck::web
