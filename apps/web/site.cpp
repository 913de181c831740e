#include <algorithm>
#include <nlohmann/json.hpp>

#include <apps/web/assets.hpp>
#include <apps/web/json_request.hpp>
#include <apps/web/site.hpp>
#include <stribeck/io/file.hpp>

namespace stribeck::web {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kRequestLimit = 64 << 10;
constexpr int kNotFound = 404;
constexpr int kBusy = 503;

/// Nothing but this site, no code inside a page.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

Response not_found() { return error_response(kNotFound, "there is no such page"); }

}  // namespace

Site::Site(const SiteOptions& o)
    : guard_(o.token),
      answers_(o.folder, o.version),
      live_(answers_.what_if(), {std::filesystem::canonical(o.folder), o.sampler, o.sinks}) {}

Admission Site::admit(const Request& head) const {
  if (auto refused = guard_.check(head)) return {0, std::move(refused)};
  if (head.method != "POST") return {0, {}};
  return {path_of(head.target) == "/api/logs" ? Uploads::kLargest : kRequestLimit, {}};
}

void Site::answer(Request request, Reply reply) {
  if (auto refused = guard_.check(request)) return reply(std::move(*refused));
  if (request.method == "POST") return post(request, reply);
  get(request, reply);
}

bool Site::stop(std::chrono::milliseconds patience) {
  const bool first = knobs_.stop(patience);
  const bool second = slower_.stop(patience);
  const bool third = files_.stop(patience);
  const bool fourth = identifications_.stop(patience);
  return first && second && third && fourth;
}

void Site::later(Newest& thread, const std::string& client, const Reply& reply,
                 std::function<Response(const Newest::IsOld&)> work) {
  const bool taken = thread.post(client, {[this, reply, work = std::move(work)](const Newest::IsOld& is_old) {
                                            reply(answers_.caught([&] { return work(is_old); }));
                                          },
                                          [reply] { reply(outdated_response()); }});
  if (!taken) reply(error_response(kBusy, "too many pages ask at once (try again in a moment)"));
}

void Site::get(const Request& r, const Reply& reply) {
  const std::string_view path = path_of(r.target);
  const std::string_view wanted = path == "/"           ? "/index.html"
                                  : path == "/identify" ? "/identify.html"
                                  : path == "/live"     ? "/live.html"
                                                        : path;
  const auto all = assets();
  const auto asset = std::find_if(all.begin(), all.end(), [&](const Asset& a) { return a.path == wanted; });
  if (asset != all.end()) {
    return reply({200,
                  std::string(asset->type),
                  std::string(asset->text),
                  {{"Content-Security-Policy", std::string(kPolicy)}}});
  }
  if (path == "/api/live") return reply(response_of(live_.state()));
  if (path == "/api/live/events") return reply(live_.events());
  computed(r, reply);
}

/// What takes no time at once, the rest in the thread for its kind.
void Site::computed(const Request& r, const Reply& reply) {
  auto answer = answers_.find(r);
  if (!answer) return reply(not_found());
  if (answer->takes == Answer::Takes::kNothing) return reply(answer->work([] { return false; }));
  Newest& thread = answer->takes == Answer::Takes::kMilliseconds ? knobs_
                   : answer->takes == Answer::Takes::kSeconds    ? slower_
                                                                 : identifications_;
  later(thread, answer->client, reply, std::move(answer->work));
}

template <class T>
std::optional<T> Site::read(const Request& r, const Reply& reply) const {
  T request;
  Response refused = answers_.caught([&] {
    request = read_request<T>(r.body);
    return Response{};
  });
  if (refused.status == 200) return request;
  reply(std::move(refused));
  return {};
}

void Site::post(const Request& r, const Reply& reply) {
  if (path_of(r.target).starts_with("/api/live/")) return post_live(r, reply);
  computed(r, reply);
}

/// Files are written and machines identified by another thread, so that no page waits for a disk.
void Site::post_live(const Request& r, const Reply& reply) {
  const std::string_view what = path_of(r.target).substr(std::string_view("/api/live/").size());
  if (what == "start") {
    const auto request = read<LiveRequest>(r, reply);
    if (!request) return;
    return later(knobs_, "live " + request->client, reply, [this, request](const Newest::IsOld& is_old) {
      return response_of(live_.start(*request, is_old));
    });
  }
  const auto done = [&](auto work) {
    // A name of its own: another page must not take this one's place.
    later(files_, "live " + std::string(what) + std::to_string(++live_asked_), reply,
          [work](const Newest::IsOld&) { return response_of(work()); });
  };
  if (what == "stop") return done([this] { return live_.stop(); });
  if (what == "record") return done([this] { return live_.record(); });
  if (what == "save") return done([this] { return live_.save(); });
  if (what == "discard") return done([this] { return live_.discard(); });
  if (what == "identify") {
    return done([this] {
      const std::filesystem::path file = live_.saved();
      const Upload u = answers_.uploads().add(file.filename().string(), io::read_text(file.string()));
      return Json{{"id", u.id}, {"name", u.name}, {"bytes", u.bytes}};
    });
  }
  reply(not_found());
}

}  // namespace stribeck::web
