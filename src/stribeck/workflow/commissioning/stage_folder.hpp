#pragma once
/// What is done, as plain folders: FOLDER/STAGE with result.json and the records of that stage.
///
/// A stage works in FOLDER/.STAGE, which is renamed when the stage is complete: a folder without the dot is whole, also after a power cut
/// or a kill. Its result names the key of the stage, the SHA-256 of what it depends on: the inputs and the result before it. Where the
/// key is another one, the stage counts as not done.
/// Real time: no.
/// Errors: InputError of files.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <stribeck/io/json.hpp>

namespace stribeck::workflow::commissioning {

class StageFolder {
 public:
  /// `inputs`: text on which every stage depends.
  StageFolder(std::string folder, std::vector<std::string> stages, const std::string& inputs);

  /// Whether this stage and all before it are done.
  [[nodiscard]] bool done(const std::string& stage) const { return result(stage).has_value(); }
  /// Absent: not done.
  [[nodiscard]] std::optional<io::Json> result(const std::string& stage) const;
  /// First stage that is missing before this one; empty: none is.
  [[nodiscard]] std::string missing_before(const std::string& stage) const;

  /// An empty folder to work in.
  std::string begin(const std::string& stage);
  /// Renames it into place. The stages behind it are then no longer done.
  void finish(const std::string& stage, io::Json result);

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + '/' + name; }

 private:
  std::string folder_;
  std::vector<std::string> stages_;
  std::string inputs_;
};

}  // namespace stribeck::workflow::commissioning
