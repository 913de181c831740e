#pragma once
/// An HTTP/1.1 server on Boost.Beast: it reads requests, calls a handler and sends the answers. One thread reads and sends; the handler
/// may answer from any thread. No other file includes Beast.
///
/// Limits: number of connections (further clients wait until one ends); 8 kB for a head; for a body what the handler allows, and few
/// large bodies at once; 30 s to receive a head, 120 s to receive a body and to send an answer. A stream (Response::next) keeps one
/// piece in memory at a time: the next piece is made when the client has taken the one before, and a client that takes nothing for
/// 120 s is disconnected.
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
