#pragma once
/// One axis of a virtual machine along a reference, as a control would log it: `stribeck simulate --reference`.
/// Real time: no.
/// Errors: InputError naming the reference or the option.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stribeck/io/log/log.hpp>
#include <stribeck/sim/recording.hpp>
#include <stribeck/workflow/reference_file.hpp>
#include <string>

namespace stribeck::workflow {

struct AxisRun {
  std::string machine;  ///< its name
  std::string axis;
  std::uint64_t seed = 1;
  sim::Recording recording;
  std::optional<EndStop> end_stop;  ///< where the recording ends
  io::Log log;                      ///< the recording
};

/// `file`: where the machine comes from, for messages. `reference`: a table as excite writes it.
AxisRun run_axis(const sim::Machine& machine, const std::string& file, const std::string& axis,
                 const io::Log& reference, std::uint64_t seed);

nlohmann::ordered_json to_json(const AxisRun& run);

}  // namespace stribeck::workflow
