#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <csignal>

#include <apps/web/http_server.hpp>
#include <stribeck/io/error.hpp>

namespace stribeck::web {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using tcp = net::ip::tcp;

namespace {

constexpr std::uint32_t kHeadLimit = 8192;
constexpr std::uint64_t kBodyLimit = 512ULL << 20;  // what the handler admits is less
constexpr std::uint64_t kLargeBody = 1ULL << 20;    // such bodies are counted
constexpr std::size_t kMostLarge = 2;               // at once
constexpr std::size_t kMostTarget = 2048;
constexpr std::chrono::seconds kHeadTime{30};
constexpr std::chrono::seconds kBodyTime{120};
constexpr std::chrono::seconds kRestTime{2};
constexpr std::chrono::milliseconds kPieceTime{100};  // between two pieces of an answer without an end
constexpr std::chrono::milliseconds kPause{200};      // after an accept that failed

net::ip::address parsed(const std::string& address) {
  beast::error_code wrong;
  const auto parsed = net::ip::make_address(address, wrong);
  if (wrong)
    throw io::InputError(
        {"--address", 0, {}, "got " + io::in_quotes(address) + ", expected an IP address, e.g. 127.0.0.1"});
  return parsed;
}

Request head_of(const http::request<http::string_body>& in) {
  const auto text = [](beast::string_view v) { return std::string(v.data(), v.size()); };
  Request out;
  out.method = text(in.method_string());
  out.target = text(in.target());
  out.host = text(in[http::field::host]);
  out.origin = text(in[http::field::origin]);
  out.authorization = text(in[http::field::authorization]);
  out.cookie = text(in[http::field::cookie]);
  return out;
}

}  // namespace

/// Lives until the last connection is gone, because answers may come late.
struct HttpServer::State : std::enable_shared_from_this<HttpServer::State> {
  Handler handler;
  std::size_t most;
  // Above the context, which owns the connections: they look here when they end.
  std::size_t connections = 0;
  std::size_t large = 0;  ///< bodies that are being received
  bool accepting = false;
  bool ended = false;
  net::io_context context{1};
  tcp::acceptor acceptor{context};
  net::steady_timer pause{context};
  net::signal_set ends{context};

  State(Handler its_handler, std::size_t most_connections)
      : handler(std::move(its_handler)), most(most_connections) {}
  void accept();
};

namespace {

/// One connection: a request and its answer, then the next one.
template <class State>
class Session : public std::enable_shared_from_this<Session<State>> {
 public:
  Session(tcp::socket socket, State* state)
      : stream_(std::move(socket)), state_(state), pause_(stream_.get_executor()) {
    ++state_->connections;
  }
  ~Session() {
    release();
    --state_->connections;
    state_->accept();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void read_head() {
    parser_.emplace();
    parser_->header_limit(kHeadLimit);
    parser_->body_limit(kBodyLimit);
    stream_.expires_after(kHeadTime);
    http::async_read_header(stream_, buffer_, *parser_,
                            [self = this->shared_from_this()](beast::error_code ec, std::size_t) {
                              if (!ec) return self->admit();
                              self->bad_request(ec);
                            });
  }

 private:
  void bad_request(beast::error_code ec) {
    if (ec == http::error::header_limit)
      return finish(error_response(431, "the head of the request is too long"));
    if (ec == http::error::body_limit) return finish(too_large());
    // What is no HTTP gets an answer as well; a connection that ended or took too long gets none.
    if (ec.category() == http::make_error_code(http::error::bad_method).category() &&
        ec != http::error::end_of_stream && ec != http::error::partial_message)
      finish(error_response(400, "this is not an HTTP/1.1 request"));
  }

  static Response too_large() { return error_response(413, "the request is larger than is read here"); }

  /// An answer after which the connection ends, because the rest of the request was not read.
  void finish(Response response) {
    ends_ = true;
    write(std::move(response));
  }

  void admit() {
    const auto& head = parser_->get();
    if (head.version() != 11) return finish(error_response(505, "only HTTP/1.1 is supported"));
    if (head.target().size() > kMostTarget) return finish(error_response(414, "the address is too long"));
    Admission admission = state_->handler.admit(head_of(head));
    if (admission.refused) return finish(std::move(*admission.refused));
    const auto length = parser_->content_length();
    const bool none = !length && !parser_->chunked();
    if (length && *length > admission.body_limit) return finish(too_large());
    parser_->body_limit(admission.body_limit);
    if (!none && admission.body_limit > kLargeBody) {
      if (state_->large >= kMostLarge)
        return finish(error_response(503, "other files are being received (try again in a moment)"));
      ++state_->large;
      counted_ = true;
    }
    stream_.expires_after(kBodyTime);
    if (head[http::field::expect] == "100-continue") return go_ahead();
    read_body();
  }

  void go_ahead() {
    static constexpr std::string_view kGoAhead = "HTTP/1.1 100 Continue\r\n\r\n";
    net::async_write(stream_, net::buffer(kGoAhead),
                     [self = this->shared_from_this()](beast::error_code ec, std::size_t) {
                       if (!ec) self->read_body();
                     });
  }

  void read_body() {
    http::async_read(stream_, buffer_, *parser_,
                     [self = this->shared_from_this()](beast::error_code ec, std::size_t) {
                       if (ec) return self->bad_request(ec);
                       self->ask();
                     });
  }

  void ask() {
    release();
    auto message = parser_->release();
    ends_ = !message.keep_alive();
    Request request = head_of(message);
    request.body = std::move(message.body());
    stream_.expires_never();
    // The connection must end on the carrying thread, so an answer from another one only brings it there.
    auto self = std::make_shared<std::shared_ptr<Session>>(this->shared_from_this());
    state_->handler.answer(std::move(request), [self, state = state_->shared_from_this()](Response response) {
      net::post(state->context, [session = std::move(*self), response = std::move(response)]() mutable {
        if (session) session->write(std::move(response));
      });
    });
  }

  void write(Response response) {
    if (response.next) return open_stream(std::move(response));
    answer_.emplace();
    fill(*answer_, response);
    answer_->keep_alive(!ends_);
    answer_->body() = std::move(response.body);
    answer_->prepare_payload();
    stream_.expires_after(kBodyTime);
    http::async_write(stream_, *answer_,
                      [self = this->shared_from_this()](beast::error_code ec, std::size_t) {
                        self->answer_.reset();
                        if (ec) return;
                        if (!self->ends_) return self->read_head();
                        beast::error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                        self->stream_.expires_after(kRestTime);
                        self->drain();
                      });
  }

  template <class Answer>
  static void fill(Answer& answer, const Response& response) {
    answer.result(static_cast<unsigned>(response.status));
    answer.set(http::field::content_type, response.type);
    answer.set(http::field::cache_control, "no-store");
    answer.set("X-Content-Type-Options", "nosniff");
    answer.set("Referrer-Policy", "no-referrer");
    answer.set("Cross-Origin-Resource-Policy", "same-origin");
    answer.set("X-Frame-Options", "DENY");
    for (const auto& [name, value] : response.headers) answer.set(name, value);
  }

  /// An answer without an end. It ends with the connection, so that no length is needed.
  void open_stream(Response response) {
    next_ = std::move(response.next);
    stream_head_.emplace();
    fill(*stream_head_, response);
    stream_head_->keep_alive(false);
    serializer_.emplace(*stream_head_);
    stream_.expires_after(kBodyTime);
    http::async_write_header(stream_, *serializer_,
                             [self = this->shared_from_this()](beast::error_code ec, std::size_t) {
                               if (!ec) self->send_piece();
                             });
  }

  void send_piece() {
    std::optional<std::string> piece = next_();
    if (!piece) return;
    if (piece->empty()) return await_piece();
    piece_ = std::move(*piece);
    stream_.expires_after(kBodyTime);
    net::async_write(stream_, net::buffer(piece_),
                     [self = this->shared_from_this()](beast::error_code ec, std::size_t) {
                       if (!ec) self->await_piece();
                     });
  }

  void await_piece() {
    stream_.expires_never();
    pause_.expires_after(kPieceTime);
    pause_.async_wait([self = this->shared_from_this()](beast::error_code ec) {
      if (!ec) self->send_piece();
    });
  }

  /// Takes the rest of a request that was refused: a connection that is closed before would lose the answer on its way.
  void drain() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kHeadLimit),
                            [self = this->shared_from_this()](beast::error_code ec, std::size_t) {
                              if (!ec) self->drain();
                            });
  }

  void release() {
    if (counted_) --state_->large;
    counted_ = false;
  }

  beast::tcp_stream stream_;
  State* state_;  ///< owns the context that owns this
  beast::flat_buffer buffer_{16384 + kHeadLimit};
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::string_body>> answer_;
  // Of an answer without an end.
  std::optional<http::response<http::empty_body>> stream_head_;
  std::optional<http::response_serializer<http::empty_body>> serializer_;
  std::function<std::optional<std::string>()> next_;
  std::string piece_;
  net::steady_timer pause_;
  bool ends_ = false;
  bool counted_ = false;
};

}  // namespace

void HttpServer::State::accept() {
  if (ended || accepting || connections >= most) return;
  accepting = true;
  acceptor.async_accept([this](beast::error_code ec, tcp::socket socket) {
    accepting = false;
    if (!ec) {
      std::make_shared<Session<State>>(std::move(socket), this)->read_head();
      return accept();
    }
    // Out of descriptors, for example: trying again at once would only burn time.
    accepting = true;
    pause.expires_after(kPause);
    pause.async_wait([this](beast::error_code) {
      accepting = false;
      accept();
    });
  });
}

HttpServer::HttpServer(const Listen& listen, Handler handler)
    : state_(std::make_shared<State>(std::move(handler), listen.most_connections)) {
  if (listen.signals) {
    state_->ends.add(SIGINT);
    state_->ends.add(SIGTERM);
    state_->ends.async_wait([state = state_.get()](beast::error_code ec, int) {
      if (!ec) state->context.stop();
    });
  }
  const tcp::endpoint endpoint(parsed(listen.address), listen.port);
  try {
    state_->acceptor.open(endpoint.protocol());
    state_->acceptor.set_option(net::socket_base::reuse_address(true));
    state_->acceptor.bind(endpoint);
    state_->acceptor.listen();
  } catch (const boost::system::system_error& e) {
    throw io::InputError({"--port",
                          0,
                          {},
                          "cannot listen at " + listen.address + " port " + std::to_string(listen.port) +
                              ": " + e.code().message() + " (leave --port out for a free one)"});
  }
}

HttpServer::~HttpServer() {
  state_->ended = true;
  state_->context.stop();
}

unsigned short HttpServer::port() const { return state_->acceptor.local_endpoint().port(); }

void HttpServer::run() {
  // There may be nothing to carry while every connection waits for its answer.
  const auto goes_on = net::make_work_guard(state_->context);
  state_->accept();
  state_->context.run();
  beast::error_code ignored;
  state_->acceptor.close(ignored);  // nobody waits for an answer that does not come
}

void HttpServer::stop() { state_->context.stop(); }

bool HttpServer::is_loopback(const std::string& address) { return parsed(address).is_loopback(); }

}  // namespace stribeck::web
