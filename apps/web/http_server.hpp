#pragma once
/// Carries requests to a handler and its answers back, over HTTP/1.1 with Boost.Beast. One thread carries; the handler answers from any
/// thread. This is the only translation unit that sees Beast.
///
/// Bounds: connections (further clients wait until one ends), 8 kB of head, a body as the handler admits it, and few large bodies at
/// once; 30 s for a head, 120 s for a body and for an answer to be taken. An answer without an end (Response::next) holds one piece at a
/// time: of a client that is slow less is asked, and one that takes nothing for 120 s is left.
/// Real time: no.
/// Errors: io::InputError for an address or a port that cannot be had.

#include <apps/web/http.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace stribeck::web {

struct Listen {
  std::string address = "127.0.0.1";  ///< a number, no name
  unsigned short port = 0;            ///< 0: any free one
  std::size_t most_connections = 128;
  bool signals = false;  ///< SIGINT and SIGTERM end run(), from the construction on
};

struct Handler {
  /// Asked as soon as the head is there; on the carrying thread.
  std::function<Admission(const Request& head)> admit;
  /// Asked with the body; on the carrying thread. Must not take long: what does, answers later.
  std::function<void(Request request, Reply reply)> answer;
};

class HttpServer {
 public:
  /// Takes the port at once.
  HttpServer(const Listen& listen, Handler handler);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] unsigned short port() const;

  /// Serves until stop().
  void run();
  /// From any thread.
  void stop();

  /// Whether the address is one of this computer alone. Throws InputError for what is no address.
  static bool is_loopback(const std::string& address);

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace stribeck::web
