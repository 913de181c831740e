#pragma once
/// From the columns of a log to a record for identification: which column is what, in which unit, and how a
/// voltage, current, torque or percentage becomes a force.

#include <stribeck/ident/record.hpp>
#include <stribeck/io/log.hpp>
#include <string>
#include <vector>

namespace stribeck::cli {

struct LogOptions {
  std::string axis;
  std::vector<std::string> maps;  ///< quantity=column [unit]
  std::string gain;               ///< force per volt, ampere, newton metre or percent; empty: none
};

/// Throws io::InputError naming file and column.
ident::Record make_record(const io::Log& log, const LogOptions& options);

}  // namespace stribeck::cli
