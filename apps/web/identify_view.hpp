#pragma once
/// Logs that a page sent, identified as `identify` does it.
/// Real time: no.
/// Errors: InputError, ident::Refused.

#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <stribeck/core/fields.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <apps/web/uploads.hpp>

namespace stribeck::web {

/// Options as those of the verb.
struct IdentifyRequest {
  std::vector<std::string> logs;
  std::string axis;
  std::vector<std::string> maps;
  std::string gain;
  std::string lead;
  std::vector<std::string> where;
  std::vector<std::string> runs;
  std::string sample_time;
  std::string method = "auto";
  std::string model = "auto";
  std::string mass;
  std::string client;

  static constexpr auto fields() {
    using I = IdentifyRequest;
    return std::tuple{
        field("logs", &I::logs, "ids of logs that were sent"),
        field("axis", &I::axis, "as --axis of identify").or_default(),
        field("maps", &I::maps, "as --map of identify").or_default(),
        field("gain", &I::gain, "as --gain of identify").or_default(),
        field("lead", &I::lead, "as --lead of identify").or_default(),
        field("where", &I::where, "as --where of identify").or_default(),
        field("runs", &I::runs, "as --runs of identify").or_default(),
        field("sample_time", &I::sample_time, "as --sample-time of identify").or_default(),
        field("method", &I::method, "as --method of identify").or_default(),
        field("model", &I::model, "as --model of identify").or_default(),
        field("mass", &I::mass, "as --mass of identify").or_default(),
        field("client", &I::client, "name of the asking page, of which only the newest request is computed")
            .or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    if (logs.empty() || logs.size() > Uploads::kMostFiles) report("logs", "expected 1 to 32 logs");
    if (client.size() > 64) report("client", "expected at most 64 characters");
  }
};

class IdentifyView {
 public:
  IdentifyView(Uploads& uploads, std::string version) : uploads_(uploads), version_(std::move(version)) {}

  /// What the logs hold: {"logs": [what identify --inspect --json writes, with "text"]}.
  [[nodiscard]] nlohmann::ordered_json inspect(const IdentifyRequest& request) const;

  /// What identify --json writes, with "text", "axis_file" (null: "axis_file_refused" says why), "command" and "id" of the result.
  nlohmann::ordered_json identify(const IdentifyRequest& request);

  /// The page of a result that is kept. Throws for an unknown id.
  [[nodiscard]] std::string page(const std::string& id) const;

  /// A message without the folder of the session, which means nothing to the user.
  [[nodiscard]] std::string in_words(std::string message) const;

 private:
  struct Result;
  static constexpr std::size_t kMostKept = 4;

  Uploads& uploads_;
  std::string version_;
  mutable std::mutex mutex_;
  std::vector<std::pair<std::string, std::shared_ptr<const Result>>> kept_;  ///< the newest last
  std::uint64_t next_ = 1;
};

}  // namespace stribeck::web
