// The dashboard's answers inside a WebAssembly module: the page asks for a target with a body, as it would ask a server.
//
// Machine files that the page carries stand in /machines of the module's own file system before the first request.
#include <emscripten.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <string>

#include <apps/web/answers.hpp>

namespace stribeck::web {
namespace {

Response last;

Answers& answers() {
  static const bool made = std::filesystem::create_directories("/machines");
  static Answers all("/machines", STRIBECK_VERSION);
  static_cast<void>(made);
  return all;
}

}  // namespace
}  // namespace stribeck::web

// What a browser has not: the interpreter of G-code is another process. io/process says so in its own words.
extern "C" {
int memfd_create(const char* /*name*/, unsigned /*flags*/) {
  errno = ENOSYS;
  return -1;
}
int posix_spawnp(int* /*pid*/, const char* /*file*/, const void* /*actions*/, const void* /*attributes*/,
                 char* const* /*arguments*/, char* const* /*environment*/) {
  return ENOSYS;
}
int prctl(int /*option*/, ...) {
  errno = ENOSYS;
  return -1;
}
}

extern "C" {

/// Answers a request; the status. Body and type of the answer stay until the next request.
EMSCRIPTEN_KEEPALIVE int stribeck_ask(const char* method, const char* target, const char* body,
                                      std::size_t size) {
  using namespace stribeck::web;
  Request request;
  request.method = method;
  request.target = target;
  request.body.assign(body, size);
  const auto answer = answers().find(request);
  last = answer ? answer->work([] { return false; }) : error_response(404, "there is no such page");
  return last.status;
}

EMSCRIPTEN_KEEPALIVE const char* stribeck_body() { return stribeck::web::last.body.data(); }
EMSCRIPTEN_KEEPALIVE std::size_t stribeck_body_size() { return stribeck::web::last.body.size(); }
EMSCRIPTEN_KEEPALIVE const char* stribeck_type() { return stribeck::web::last.type.c_str(); }

}  // extern "C"
