#pragma once
/// The view "Live": one stream at a time, of a virtual machine that a page starts or of the sampler that the command names, sent to
/// pages as server-sent events.
///
/// An event is a JSON object: "id" of the stream (0: none), "layout" when the stream is new to the page, bins with the extremes of
/// every channel ("first", "missed", "t", "low", "high"), new "glitches", and "state". A page that takes them too slowly finds "missed" bins;
/// a recording never lacks a row.
/// Bounds: kMostPages pages; memory as workflow/live/live_stream.hpp says.
/// Threads: safe. Real time: no.
/// Errors: InputError, sim::Refused, Outdated.

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stribeck/core/fields.hpp>
#include <stribeck/workflow/live/sampler_stream.hpp>
#include <stribeck/workflow/live/simulated_stream.hpp>
#include <string>
#include <vector>

#include <apps/web/http.hpp>
#include <apps/web/what_if.hpp>

namespace stribeck::web {

/// A virtual machine that runs.
struct LiveRequest {
  std::string machine;
  std::string motion;
  std::string size;
  std::string speed;
  std::string controller;
  double friction = 1.0;
  double times = 1.0;
  std::uint64_t seed = 1;
  std::string client;

  static constexpr auto fields() {
    using L = LiveRequest;
    return std::tuple{
        field("machine", &L::machine, "id of the list of machines"),
        field("motion", &L::motion, "as of what if; the path must be closed").or_default(),
        field("size", &L::size, "as --size of compare").or_default(),
        field("speed", &L::speed, "as --speed of compare").or_default(),
        field("controller", &L::controller, "id of the experiment, or name of a built-in controller"),
        field("friction", &L::friction, pure_number().at_least(0.1).at_most(10.0),
              "factor of the level of friction, which the controller does not know")
            .or_default(),
        field("times", &L::times, pure_number().at_least(0.1).at_most(100.0),
              "so many times as fast as the clock")
            .or_default(),
        field("seed", &L::seed, "of the noise").or_default(),
        field("client", &L::client, "name of the asking page").or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (client.size() > 64) report("client", "expected at most 64 characters");
  }
};

struct LiveOptions {
  std::filesystem::path folder;  ///< for recordings
  std::optional<workflow::SamplerOptions> sampler{};
  std::vector<std::shared_ptr<workflow::LiveSink>> sinks{};
};

class LiveView {
 public:
  static constexpr int kMostPages = 8;

  /// Opens the sampler at once.
  LiveView(WhatIf& what_if, LiveOptions options);
  /// Saves a recording that runs.
  ~LiveView();
  /// For a program that ends without destructors.
  void save_what_runs();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /// Starts a virtual machine in place of the one that runs. One call at a time with what-if.
  nlohmann::ordered_json start(const LiveRequest& request, const WhatIf::IsOld& is_old);
  /// The virtual machine stops; what it left can still be looked at and saved.
  nlohmann::ordered_json stop();
  nlohmann::ordered_json record();
  nlohmann::ordered_json save();
  nlohmann::ordered_json discard();
  /// The file that was saved last. Throws where there is none.
  [[nodiscard]] std::filesystem::path saved() const;

  [[nodiscard]] nlohmann::ordered_json state() const;
  /// Server-sent events; 503 where too many pages look.
  Response events();

 private:
  struct Running;
  [[nodiscard]] std::shared_ptr<Running> running() const;
  /// Throws where there is none.
  [[nodiscard]] std::shared_ptr<Running> some_running() const;

  WhatIf& what_if_;
  LiveOptions options_;
  mutable std::mutex mutex_;
  std::shared_ptr<Running> running_;
  std::filesystem::path saved_;
  std::uint64_t next_ = 1;
  std::shared_ptr<std::atomic<int>> pages_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace stribeck::web
