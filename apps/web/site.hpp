#pragma once
/// What the dashboard answers: pages, machines, what-if, identification. It knows nothing of sockets, so tests and the fuzzer ask it
/// directly.
///
///   GET  /  /identify  /*.js  /*.css       the pages
///        /api/machines … /results/page     what is computed: answers.hpp
///   GET  /live  /api/live  /api/live/events          the stream, as server-sent events
///   POST /api/live/start                   LiveRequest as JSON
///   POST /api/live/stop  record  save  discard  identify
///
/// Nothing outside the folder, the built-in files and the session's own temporary folder is read; nothing outside the latter is
/// written, but the recordings of a stream, which go to the folder. Errors as in answers.hpp, and 503 (busy).
/// Threads: safe. Real time: no.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include <apps/web/answers.hpp>
#include <apps/web/guard.hpp>
#include <apps/web/http.hpp>
#include <apps/web/live/live_view.hpp>
#include <apps/web/newest.hpp>

namespace stribeck::web {

struct SiteOptions {
  std::filesystem::path folder = ".";
  std::string token;  ///< empty: none is asked for
  std::string version;
  std::optional<workflow::SamplerOptions> sampler = {};         ///< the stream to show
  std::vector<std::shared_ptr<workflow::LiveSink>> sinks = {};  ///< who gets the rows of every stream
};

class Site {
 public:
  explicit Site(const SiteOptions& options);

  [[nodiscard]] Admission admit(const Request& head) const;
  /// The reply is called once, here or from another thread.
  void answer(Request request, Reply reply);

  /// Ends the threads. False: one did not end in time.
  bool stop(std::chrono::milliseconds patience);
  /// A recording of the view Live that runs is saved; the destructor does it as well.
  void save_recording() { live_.save_what_runs(); }
  [[nodiscard]] const std::filesystem::path& session_folder() const { return answers_.uploads().folder(); }

 private:
  void get(const Request& request, const Reply& reply);
  void post(const Request& request, const Reply& reply);
  void post_live(const Request& request, const Reply& reply);
  void computed(const Request& request, const Reply& reply);
  template <class T>
  [[nodiscard]] std::optional<T> read(const Request& request, const Reply& reply) const;
  void later(Newest& thread, const std::string& client, const Reply& reply,
             std::function<Response(const Newest::IsOld&)> work);

  Guard guard_;
  Answers answers_;
  LiveView live_;
  std::atomic<std::uint64_t> live_asked_{0};
  Newest knobs_;            ///< what must answer at once
  Newest slower_;           ///< looking into logs, pages
  Newest files_;            ///< recordings: none of the others may delay them
  Newest identifications_;  ///< minutes, for which no other page may wait
};

}  // namespace stribeck::web
