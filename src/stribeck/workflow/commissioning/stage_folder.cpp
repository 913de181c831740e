#include <filesystem>
#include <nlohmann/json.hpp>

#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/sha256.hpp>
#include <stribeck/workflow/commissioning/stage_folder.hpp>

namespace stribeck::workflow::commissioning {

namespace fs = std::filesystem;

StageFolder::StageFolder(std::string folder, std::vector<std::string> stages, const std::string& inputs)
    : folder_(std::move(folder)), stages_(std::move(stages)), inputs_(io::hexadecimal(io::sha256(inputs))) {}

std::optional<io::Json> StageFolder::result(const std::string& stage) const {
  std::string key = inputs_;
  for (const std::string& one : stages_) {
    const std::string file = path(one) + "/result.json";
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return std::nullopt;
    const std::string text = io::read_text(file);
    io::Json result = io::Json::parse(text, nullptr, false);
    if (!result.is_object() || result.value("key", "") != key) return std::nullopt;
    if (one == stage) return result;
    key = io::hexadecimal(io::sha256(text));
  }
  return std::nullopt;
}

std::string StageFolder::missing_before(const std::string& stage) const {
  for (const std::string& one : stages_) {
    if (one == stage) break;
    if (!done(one)) return one;
  }
  return {};
}

std::string StageFolder::begin(const std::string& stage) {
  const std::string work = path('.' + stage);
  std::error_code error;
  fs::remove_all(work, error);
  io::make_directory(work);
  return work;
}

void StageFolder::finish(const std::string& stage, io::Json result) {
  std::string key = inputs_;
  for (const std::string& one : stages_) {
    if (one == stage) break;
    key = io::hexadecimal(io::sha256(io::read_text(path(one) + "/result.json")));
  }
  result["key"] = key;
  const std::string work = path('.' + stage);
  io::write_atomically(work + "/result.json", io::dump(result));
  const std::string old = path(".old-" + stage);
  std::error_code error;
  fs::remove_all(old, error);
  if (fs::exists(path(stage), error)) fs::rename(path(stage), old, error);
  if (!error) fs::rename(work, path(stage), error);
  if (error) throw io::InputError({path(stage), 0, {}, "cannot be written: " + error.message()});
  fs::remove_all(old, error);
}

}  // namespace stribeck::workflow::commissioning
