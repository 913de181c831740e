#include <algorithm>
#include <new>
#include <nlohmann/json.hpp>

#include <apps/web/assets.hpp>
#include <apps/web/json_request.hpp>
#include <apps/web/site.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/sim/contour_run.hpp>

namespace stribeck::web {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kRequestLimit = 64 << 10;
constexpr int kBad = 400;
constexpr int kNotFound = 404;
constexpr int kNoResult = 422;
constexpr int kFault = 500;
constexpr int kBusy = 503;

/// Nothing but this site, no code inside a page.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

Response json(const Json& value) {
  return json_response(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Response outdated() { return json_response("{\"outdated\":true}"); }

Response not_found() { return error_response(kNotFound, "there is no such page"); }

}  // namespace

Site::Site(const SiteOptions& o)
    : guard_(o.token),
      machines_(o.folder),
      identify_(uploads_, o.version),
      live_(what_if_, {std::filesystem::canonical(o.folder), o.sampler, o.sinks}) {}

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
  return first && second && third;
}

Response Site::caught(const std::function<Response()>& work) const {
  try {
    return work();
  } catch (const Outdated&) {
    return outdated();
  } catch (const io::InputError& e) {
    std::string text;
    for (const io::Problem& p : e.problems()) {
      text += (text.empty() ? "" : "; ") +
              (p.file == "request" && !p.key.empty() ? p.key + ": " + p.message : p.text());
      if (text.size() > 1000) break;
    }
    return error_response(kBad, identify_.in_words(text));
  } catch (const ident::Refused& e) {
    return error_response(kNoResult, identify_.in_words(e.what()));
  } catch (const sim::Refused& e) {
    return error_response(kNoResult, e.what());
  } catch (const std::bad_alloc&) {
    return error_response(kNoResult, "out of memory (take a shorter log)");
  } catch (const std::exception& e) {
    return error_response(kFault, identify_.in_words(e.what()));
  }
}

void Site::later(Newest& thread, const std::string& client, const Reply& reply,
                 std::function<Response(const Newest::IsOld&)> work) {
  const bool taken = thread.post(client, {[this, reply, work = std::move(work)](const Newest::IsOld& is_old) {
                                            reply(caught([&] { return work(is_old); }));
                                          },
                                          [reply] { reply(outdated()); }});
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
  const std::string id = query_value(r.target, "id").value_or("");
  if (path == "/api/machines") return reply(caught([&] { return json(machines_.list()); }));
  if (path == "/api/machine") return reply(caught([&] { return json(what_if_.form(id)); }));
  if (path == "/api/live") return reply(json(live_.state()));
  if (path == "/api/live/events") return reply(live_.events());
  if (path == "/results/page") {
    return later(slower_, "page " + id, reply, [this, id](const Newest::IsOld&) {
      return Response{200, "text/html; charset=utf-8", identify_.page(id), {}};
    });
  }
  reply(not_found());
}

template <class T>
std::optional<T> Site::read(const Request& r, const Reply& reply) const {
  T request;
  Response refused = caught([&] {
    request = read_request<T>(r.body);
    return Response{};
  });
  if (refused.status == 200) return request;
  reply(std::move(refused));
  return {};
}

void Site::post(const Request& r, const Reply& reply) {
  const std::string_view path = path_of(r.target);
  if (path == "/api/what-if") {
    const auto request = read<WhatIfRequest>(r, reply);
    if (!request) return;
    return later(knobs_, request->client, reply, [this, request](const Newest::IsOld& is_old) {
      return json(what_if_.run(*request, is_old));
    });
  }
  if (path == "/api/machine-file") {
    const auto request = read<WhatIfRequest>(r, reply);
    if (!request) return;
    return reply(caught([&] {
      return Response{200, "application/toml", what_if_.machine_file(*request), {}};
    }));
  }
  if (path.starts_with("/api/live/")) return post_live(r, reply);
  if (path == "/api/logs") {
    return reply(caught([&] {
      const Upload u = uploads_.add(query_value(r.target, "name").value_or("log.csv"), r.body);
      return json({{"id", u.id}, {"name", u.name}, {"bytes", u.bytes}});
    }));
  }
  if (path == "/api/forget") {
    uploads_.remove(query_value(r.target, "id").value_or(""));
    return reply(json(Json::object()));
  }
  if (path == "/api/inspect" || path == "/api/identify") {
    const auto request = read<IdentifyRequest>(r, reply);
    if (!request) return;
    const bool only_look = path == "/api/inspect";
    return later(slower_, request->client, reply, [this, request, only_look](const Newest::IsOld&) {
      return json(only_look ? identify_.inspect(*request) : identify_.identify(*request));
    });
  }
  reply(not_found());
}

/// Files are written and machines identified by another thread, so that no page waits for a disk.
void Site::post_live(const Request& r, const Reply& reply) {
  const std::string_view what = path_of(r.target).substr(std::string_view("/api/live/").size());
  if (what == "start") {
    const auto request = read<LiveRequest>(r, reply);
    if (!request) return;
    return later(knobs_, "live " + request->client, reply, [this, request](const Newest::IsOld& is_old) {
      return json(live_.start(*request, is_old));
    });
  }
  const auto done = [&](auto work) {
    // A name of its own: another page must not take this one's place.
    later(files_, "live " + std::string(what) + std::to_string(++live_asked_), reply,
          [work](const Newest::IsOld&) { return json(work()); });
  };
  if (what == "stop") return done([this] { return live_.stop(); });
  if (what == "record") return done([this] { return live_.record(); });
  if (what == "save") return done([this] { return live_.save(); });
  if (what == "discard") return done([this] { return live_.discard(); });
  if (what == "identify") {
    return done([this] {
      const std::filesystem::path file = live_.saved();
      const Upload u = uploads_.add(file.filename().string(), io::read_text(file.string()));
      return Json{{"id", u.id}, {"name", u.name}, {"bytes", u.bytes}};
    });
  }
  reply(not_found());
}

}  // namespace stribeck::web
