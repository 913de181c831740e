#pragma once
/// Where the recordings of real machines are. They are not part of the project: without them tests are skipped
/// and counted. Included by tests only.

#include <cstdlib>
#include <filesystem>
#include <string>

namespace stribeck::test {

/// Path of a recording below STRIBECK_DATA_DIR; "" when it is not there.
inline std::string recording(const std::string& name) {
  const char* given = std::getenv("STRIBECK_DATA_DIR");
  const std::filesystem::path root = given != nullptr ? given : STRIBECK_SOURCE_DIR "/../shared/data";
  return std::filesystem::exists(root / name) ? (root / name).string() : std::string();
}

}  // namespace stribeck::test

/// The path in `name`, or the test is skipped.
#define STRIBECK_RECORDING(variable, name)                        \
  const std::string variable = ::stribeck::test::recording(name); \
  if (variable.empty()) GTEST_SKIP() << "no recordings; set STRIBECK_DATA_DIR"
