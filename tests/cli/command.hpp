#pragma once
/// Runs the command inside the test and catches what it says.

#include <gtest/gtest.h>

#include <apps/cli/commands.hpp>
#include <nlohmann/json.hpp>
#include <stribeck/io/test_folder.hpp>
#include <string>
#include <vector>

namespace stribeck::test {

struct Said {
  int code = 0;
  std::string out;
  std::string err;
};

inline Said command(std::vector<std::string> words) {
  words.insert(words.begin(), "stribeck");
  std::vector<const char*> argv;
  for (const auto& w : words) argv.push_back(w.c_str());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Said said;
  said.code = cli::run(static_cast<int>(argv.size()), argv.data());
  std::fflush(stdout);
  std::fflush(stderr);
  said.out = testing::internal::GetCapturedStdout();
  said.err = testing::internal::GetCapturedStderr();
  return said;
}

/// A JSON document without what says how it was called.
inline std::string result_of(const std::string& path) {
  auto json = nlohmann::ordered_json::parse(text_of(path));
  json.erase("made");
  return json.dump();
}

inline const std::string kMachine = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";

}  // namespace stribeck::test
