#pragma once
/// What the dashboard computes, without threads and without sockets: `stribeck serve` (site.hpp) lets threads do it, the page that
/// computes in a browser (offline/) does it at once.
///
///   GET  /api/machines  /api/machine?id=   what can be chosen
///   POST /api/what-if  /api/machine-file   WhatIfRequest as JSON
///   POST /api/logs?name=                   bytes of a log → its id
///   POST /api/inspect  /api/identify       IdentifyRequest as JSON
///   POST /api/forget?id=                   removes a log
///   GET  /results/page?id=                 the page of an identification
///
/// An error is {"error": text} with 400 (request) or 422 (no result); {"outdated": true} where a newer request of the same page came.
/// Real time: no.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <apps/web/http.hpp>
#include <apps/web/identify_view.hpp>
#include <apps/web/machines.hpp>
#include <apps/web/newest.hpp>
#include <apps/web/uploads.hpp>
#include <apps/web/what_if.hpp>

namespace stribeck::web {

/// A request that is understood: who asks, how long it takes, and the work, which does not throw.
struct Answer {
  enum class Takes { kNothing, kMilliseconds, kSeconds, kMinutes };
  Takes takes = Takes::kNothing;
  std::string client = {};  ///< of whom only the newest request counts
  std::function<Response(const Newest::IsOld&)> work;
};

Response response_of(const nlohmann::ordered_json& json);
/// {"outdated": true}
Response outdated_response();

class Answers {
 public:
  /// Machine files of the folder are offered beside those that are built in.
  Answers(const std::filesystem::path& folder, std::string version);

  /// Absent: nothing here has this address. Work of kind kNothing must run while the request still exists.
  [[nodiscard]] std::optional<Answer> find(const Request& request);

  /// What the work answers, or its error as one.
  [[nodiscard]] Response caught(const std::function<Response()>& work) const;

  [[nodiscard]] Uploads& uploads() { return uploads_; }
  [[nodiscard]] const Uploads& uploads() const { return uploads_; }
  [[nodiscard]] WhatIf& what_if() { return what_if_; }

 private:
  [[nodiscard]] std::optional<Answer> get(const Request& request);
  [[nodiscard]] std::optional<Answer> post(const Request& request);

  Machines machines_;
  Uploads uploads_;
  WhatIf what_if_{machines_};
  IdentifyView identify_;
};

}  // namespace stribeck::web
