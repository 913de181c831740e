/// The server with a handler of the test; the client is a plain socket, so that what goes over the wire is what the test wrote.

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <thread>

#include <apps/web/http_server.hpp>
#include <stribeck/io/error.hpp>

namespace stribeck::web::http_server_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Client {
 public:
  explicit Client(unsigned short port) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    timeval patience{20, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  ~Client() { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void send(const std::string& bytes) const {
    EXPECT_TRUE(connected_);
    EXPECT_EQ(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  /// Until `end` has come, or the connection ends.
  std::string read(const std::string& end) {
    std::array<char, 4096> some{};
    while (got_.find(end) == std::string::npos) {
      const ssize_t n = ::recv(fd_, some.data(), some.size(), 0);
      if (n <= 0) break;
      got_.append(some.data(), static_cast<std::size_t>(n));
    }
    return std::exchange(got_, {});
  }

 private:
  int fd_;
  bool connected_ = false;
  std::string got_;
};

class HttpServerTest : public testing::Test {
 protected:
  HttpServerTest()
      : server_({"127.0.0.1", 0, 4}, {[](const Request& head) {
                                        if (head.target == "/secret")
                                          return Admission{0, error_response(403, "no")};
                                        return Admission{head.target == "/large" ? 3U << 20 : 10U, {}};
                                      },
                                      [this](Request r, const Reply& reply) {
                                        ++asked_;
                                        const std::string body =
                                            r.method + " " + std::to_string(r.body.size()) + " end";
                                        if (r.target != "/late") return reply({200, "text/plain", body, {}});
                                        later_.emplace_back([reply, body] {
                                          std::this_thread::sleep_for(std::chrono::milliseconds(20));
                                          reply({200, "text/plain", body, {}});
                                        });
                                      }}),
        thread_([this] { server_.run(); }) {}
  ~HttpServerTest() override {
    server_.stop();
    thread_.join();
    for (std::thread& t : later_) t.join();
  }
  std::string answer(const std::string& request, const std::string& end = " end") {
    Client client(server_.port());
    client.send(request);
    return client.read(end);
  }

  std::atomic<int> asked_{0};
  std::vector<std::thread> later_;
  HttpServer server_;
  std::thread thread_;
};

TEST_F(HttpServerTest, OneConnectionSeveralRequests) {
  Client client(server_.port());
  for (int i = 0; i < 3; ++i) {
    client.send("GET / HTTP/1.1\r\nHost: a\r\n\r\n");
    const std::string got = client.read(" end");
    EXPECT_THAT(got, StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(got, HasSubstr("nosniff"));
    EXPECT_THAT(got, HasSubstr("GET 0 end"));
  }
}

TEST_F(HttpServerTest, BodiesAndAnswersFromAnotherThread) {
  EXPECT_THAT(answer("POST /late HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\nabcde"),
              HasSubstr("POST 5 end"));
  EXPECT_THAT(
      answer("POST /x HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n"),
      HasSubstr("POST 3 end"));
  EXPECT_THAT(
      answer("POST /large HTTP/1.1\r\nHost: a\r\nExpect: 100-continue\r\nContent-Length: 2000000\r\n\r\n" +
             std::string(2000000, 'x')),
      HasSubstr("POST 2000000 end"));
}

TEST_F(HttpServerTest, Limits) {
  const std::string last = "\"}";
  EXPECT_THAT(answer("POST /x HTTP/1.1\r\nHost: a\r\nContent-Length: 11\r\n\r\n", last),
              StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(
      answer("POST /x HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\nb\r\nabcdefghijk\r\n0\r\n\r\n",
             last),
      StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(answer("GET / HTTP/1.1\r\nX: " + std::string(9000, 'a') + "\r\n\r\n", last),
              StartsWith("HTTP/1.1 431"));
  EXPECT_THAT(answer("GET /" + std::string(3000, 'a') + " HTTP/1.1\r\n\r\n", last),
              StartsWith("HTTP/1.1 414"));
  EXPECT_THAT(answer("GET / HTTP/1.0\r\n\r\n", last), StartsWith("HTTP/1.1 505"));
  EXPECT_THAT(answer("POST /secret HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\nabcde", last),
              StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(answer("what is this\r\n\r\n", last), StartsWith("HTTP/1.1 400"));
  EXPECT_EQ(asked_, 0);
}

/// A server whose answers have no end.
class EndlessAnswer {
 public:
  explicit EndlessAnswer(std::function<std::optional<std::string>()> next)
      : server_({}, {[](const Request&) { return Admission{}; },
                     [next](const Request&, const Reply& reply) {
                       Response out;
                       out.type = "text/event-stream";
                       out.next = next;
                       reply(std::move(out));
                     }}),
        thread_([this] { server_.run(); }) {}
  ~EndlessAnswer() {
    server_.stop();
    thread_.join();
  }
  [[nodiscard]] unsigned short port() const { return server_.port(); }

 private:
  HttpServer server_;
  std::thread thread_;
};

TEST(HttpServer, AnAnswerWithoutAnEndComesInPieces) {
  std::atomic<int> asked{0};
  const EndlessAnswer server([&]() -> std::optional<std::string> {
    switch (++asked) {
      case 1:
        return "one ";
      case 2:
        return "";  // nothing yet
      case 3:
        return "two ";
      default:
        return {};
    }
  });
  Client client(server.port());
  client.send("GET / HTTP/1.1\r\nHost: a\r\n\r\n");
  const std::string got = client.read("never");  // until the server ends the connection
  EXPECT_THAT(got, HasSubstr("text/event-stream"));
  EXPECT_THAT(got, testing::EndsWith("\r\n\r\none two "));
}

TEST(HttpServer, AClientThatReadsNothingIsNotAskedFor) {
  std::atomic<int> asked{0};
  const EndlessAnswer server([&]() -> std::optional<std::string> {
    ++asked;
    return std::string(64 << 20, 'x');  // more than the system takes for a client
  });
  const Client client(server.port());
  client.send("GET / HTTP/1.1\r\nHost: a\r\n\r\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // five times the rest between two pieces
  EXPECT_LE(asked, 1);
}

TEST_F(HttpServerTest, MoreClientsThanConnections) {
  std::vector<std::thread> clients;
  std::atomic<int> answered{0};
  for (int i = 0; i < 50; ++i) {
    clients.emplace_back([&] {
      Client client(server_.port());
      client.send("GET /late HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n");
      if (client.read(" end").ends_with(" end")) ++answered;
    });
  }
  for (std::thread& t : clients) t.join();
  EXPECT_EQ(answered, 50);
}

TEST(HttpServer, AddressesAndPorts) {
  EXPECT_TRUE(HttpServer::is_loopback("127.0.0.1"));
  EXPECT_TRUE(HttpServer::is_loopback("::1"));
  EXPECT_FALSE(HttpServer::is_loopback("0.0.0.0"));
  EXPECT_THROW(HttpServer::is_loopback("localhost"), io::InputError);
  const HttpServer first({}, {});
  try {
    const HttpServer second({"127.0.0.1", first.port()}, {});
    ADD_FAILURE() << "two servers at one port";
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("leave --port out"));
  }
}

}  // namespace
}  // namespace stribeck::web::http_server_test
