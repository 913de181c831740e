#pragma once
/// What a page is told of a stream.
/// Real time: no.

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include <stribeck/workflow/live/live_stream.hpp>

namespace stribeck::web {

/// Rows, losses, recording, drift of friction, and where the stream is sent.
nlohmann::ordered_json state_json(const workflow::LiveStream& stream);

/// Where a page is in a stream.
class LiveReader {
 public:
  /// The next event; empty: nothing new. `id` tells streams apart, null: there is none.
  std::string next(std::uint64_t id, const std::shared_ptr<const workflow::LiveStream>& stream);

 private:
  bool begun_ = false;
  std::uint64_t id_ = 0;
  std::uint64_t bin_ = 0;
  std::uint64_t glitch_ = 0;
  int quiet_ = 0;  ///< pieces since the last state
};

}  // namespace stribeck::web
