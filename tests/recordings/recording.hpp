#pragma once
/// Where the recordings of real machines are. They are not part of the project: without them tests are skipped
/// and counted. Included by tests only.

#include <cstdlib>
#include <filesystem>
#include <stribeck/ident/log/record.hpp>
#include <stribeck/workflow/log/log_axis.hpp>
#include <string>

namespace stribeck::test {

/// Path of a recording below STRIBECK_DATA_DIR; "" when it is not there.
inline std::string recording(const std::string& name) {
  const char* given = std::getenv("STRIBECK_DATA_DIR");
  const std::filesystem::path root = given != nullptr ? given : STRIBECK_SOURCE_DIR "/../shared/data";
  return std::filesystem::exists(root / name) ? (root / name).string() : std::string();
}

/// A record of the columns as they stand, without any repair.
inline ident::log::Record plain_record(const io::Log& log, const workflow::LogOptions& options) {
  const ident::log::RawLog raw = workflow::logged_axis(log, options).runs.at(0);
  ident::log::Record record;
  record.source = log.source;
  record.t = raw.x.t;
  record.x = raw.x.y;
  record.r = raw.r.y;
  record.v = raw.v.y;
  record.f = raw.f.y;
  record.sample_time = (record.t.back() - record.t.front()) / static_cast<double>(record.t.size() - 1);
  return record;
}

}  // namespace stribeck::test

/// The path in `name`, or the test is skipped.
#define STRIBECK_RECORDING(variable, name)                        \
  const std::string variable = ::stribeck::test::recording(name); \
  if (variable.empty()) GTEST_SKIP() << "no recordings; set STRIBECK_DATA_DIR"
