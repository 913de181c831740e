#include <new>
#include <nlohmann/json.hpp>
#include <utility>

#include <apps/web/answers.hpp>
#include <apps/web/json_request.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/sim/contour_run.hpp>

namespace stribeck::web {
namespace {

using Json = nlohmann::ordered_json;
using Takes = Answer::Takes;

constexpr int kBad = 400;
constexpr int kNoResult = 422;
constexpr int kFault = 500;

}  // namespace

Response response_of(const nlohmann::ordered_json& json) {
  return json_response(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Response outdated_response() { return json_response("{\"outdated\":true}"); }

Answers::Answers(const std::filesystem::path& folder, std::string version)
    : machines_(folder), identify_(uploads_, std::move(version)) {}

Response Answers::caught(const std::function<Response()>& work) const {
  try {
    return work();
  } catch (const Outdated&) {
    return outdated_response();
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

std::optional<Answer> Answers::find(const Request& r) {
  std::optional<Answer> found;
  // A request that cannot be read is answered as well.
  const Response wrong = caught([&] {
    found = r.method == "POST" ? post(r) : get(r);
    return Response{};
  });
  if (wrong.status != 200) return Answer{Takes::kNothing, {}, [wrong](const auto&) { return wrong; }};
  if (found) {
    found->work = [this, work = std::move(found->work)](const Newest::IsOld& is_old) {
      return caught([&] { return work(is_old); });
    };
  }
  return found;
}

std::optional<Answer> Answers::get(const Request& r) {
  const std::string_view path = path_of(r.target);
  const std::string id = query_value(r.target, "id").value_or("");
  if (path == "/api/machines")
    return Answer{Takes::kNothing, {}, [this](const auto&) { return response_of(machines_.list()); }};
  if (path == "/api/machine")
    return Answer{Takes::kNothing, {}, [this, id](const auto&) { return response_of(what_if_.form(id)); }};
  if (path == "/results/page") {
    return Answer{Takes::kSeconds, "page " + id, [this, id](const auto&) {
                    return Response{200, "text/html; charset=utf-8", identify_.page(id), {}};
                  }};
  }
  return {};
}

std::optional<Answer> Answers::post(const Request& r) {
  const std::string_view path = path_of(r.target);
  if (path == "/api/what-if") {
    auto request = read_request<WhatIfRequest>(r.body);
    return Answer{Takes::kMilliseconds, request.client,
                  [this, request](const auto& is_old) { return response_of(what_if_.run(request, is_old)); }};
  }
  if (path == "/api/machine-file") {
    return Answer{Takes::kNothing, {}, [this, request = read_request<WhatIfRequest>(r.body)](const auto&) {
                    return Response{200, "application/toml", what_if_.machine_file(request), {}};
                  }};
  }
  if (path == "/api/logs") {
    return Answer{Takes::kNothing, {}, [this, &r](const auto&) {
                    const Upload u = uploads_.add(query_value(r.target, "name").value_or("log.csv"), r.body);
                    return response_of({{"id", u.id}, {"name", u.name}, {"bytes", u.bytes}});
                  }};
  }
  if (path == "/api/forget") {
    return Answer{Takes::kNothing, {}, [this, &r](const auto&) {
                    uploads_.remove(query_value(r.target, "id").value_or(""));
                    return response_of(Json::object());
                  }};
  }
  if (path == "/api/inspect" || path == "/api/identify") {
    auto request = read_request<IdentifyRequest>(r.body);
    const bool only_look = path == "/api/inspect";
    return Answer{only_look ? Takes::kSeconds : Takes::kMinutes, request.client,
                  [this, request, only_look](const auto&) {
                    return response_of(only_look ? identify_.inspect(request) : identify_.identify(request));
                  }};
  }
  return {};
}

}  // namespace stribeck::web
