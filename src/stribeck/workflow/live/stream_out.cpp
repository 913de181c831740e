#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/live/stream_out.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

/// "r_x" and "mm" → "r_x_mm"; other signs than letters, digits, - and _ become _.
std::string key_of(const LiveChannel& c) {
  std::string key = c.name;
  if (!c.unit.empty()) key += "_" + c.unit;
  for (std::size_t at = key.find('/'); at != std::string::npos; at = key.find('/'))
    key.replace(at, 1, "_per_");
  for (char& letter : key) {
    const bool kept = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                      (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
    if (!kept) letter = '_';
  }
  return key;
}

class UdpSink final : public LiveSink {
 public:
  explicit UdpSink(const Endpoint& to) : words_(fmt::format("UDP to {} port {}", to.host, to.port)) {
    auto* four = reinterpret_cast<sockaddr_in*>(&address_);
    auto* six = reinterpret_cast<sockaddr_in6*>(&address_);
    if (::inet_pton(AF_INET, to.host.c_str(), &four->sin_addr) == 1) {
      four->sin_family = AF_INET;
      four->sin_port = htons(to.port);
      size_ = sizeof *four;
    } else if (::inet_pton(AF_INET6, to.host.c_str(), &six->sin6_addr) == 1) {
      six->sin6_family = AF_INET6;
      six->sin6_port = htons(to.port);
      size_ = sizeof *six;
    } else {
      refuse_option("--udp", fmt::format("got the host {}, expected a numeric address, e.g. 127.0.0.1:9870",
                                         io::in_quotes(to.host)));
    }
    socket_ = ::socket(address_.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) refuse_option("--udp", "no socket: " + std::generic_category().message(errno));
  }
  ~UdpSink() override { ::close(socket_); }

  void row(const LiveLayout& layout, double t, std::span<const double> values) override {
    const std::string text = json_of(layout, t, values);
    const ssize_t sent = ::sendto(socket_, text.data(), text.size(), MSG_DONTWAIT,
                                  reinterpret_cast<const sockaddr*>(&address_), size_);
    if (sent < 0) ++left_out_;
  }
  void glitch(const LiveLayout& /*layout*/, const QuadrantGlitch& /*glitch*/) override {}
  [[nodiscard]] std::string in_words() const override { return words_; }
  [[nodiscard]] std::uint64_t left_out() const override { return left_out_; }

 private:
  std::string words_;
  sockaddr_storage address_{};
  socklen_t size_ = 0;
  int socket_ = -1;
  std::atomic<std::uint64_t> left_out_{0};
};

}  // namespace

Endpoint read_endpoint(const std::string& option, const std::string& text, unsigned short default_port,
                       bool with_topic) {
  Endpoint out;
  out.port = default_port;
  std::string rest = text;
  if (with_topic) {
    out.topic = "stribeck/live";
    if (const std::size_t slash = rest.find('/'); slash != std::string::npos) {
      out.topic = rest.substr(slash + 1);
      rest.resize(slash);
    }
    if (out.topic.empty() || out.topic.size() > 200 || out.topic.find_first_of("+#") != std::string::npos)
      refuse_option(option, fmt::format("got the topic {}, expected 1 to 200 characters without + and #",
                                        io::in_quotes(out.topic)));
  }
  std::string port;
  const bool digits = !rest.empty() && rest.find_first_not_of("0123456789") == std::string::npos;
  const std::size_t bracket = rest.find(']');
  const std::size_t colon = rest.rfind(':');
  if (digits) {
    port = rest;
  } else if (colon != std::string::npos && (bracket == std::string::npos || colon > bracket)) {
    out.host = rest.substr(0, colon);
    port = rest.substr(colon + 1);
  } else {
    out.host = rest;
  }
  if (out.host.size() > 2 && out.host.front() == '[' && out.host.back() == ']')
    out.host = out.host.substr(1, out.host.size() - 2);
  if (!port.empty()) {
    const auto [end, wrong] = std::from_chars(port.data(), port.data() + port.size(), out.port);
    if (wrong != std::errc{} || end != port.data() + port.size()) out.port = 0;
  }
  if (out.host.empty() || out.port == 0)
    refuse_option(option, fmt::format("got {}, expected {}", io::in_quotes(text),
                                      with_topic ? "HOST[:PORT][/TOPIC], e.g. localhost:1883/mill"
                                                 : "[HOST:]PORT, e.g. 9870"));
  return out;
}

std::string json_of(const LiveLayout& layout, double t, std::span<const double> values) {
  std::string out = fmt::format("{{\"timestamp\":{:.10g}", t);
  for (std::size_t c = 0; c < values.size(); ++c) {
    out += fmt::format(",\"{}\":", key_of(layout.channels[c]));
    if (std::isfinite(values[c])) {
      fmt::format_to(std::back_inserter(out), "{:.10g}", values[c]);
    } else {
      out += "null";
    }
  }
  return out + "}";
}

std::string json_of(const LiveLayout& layout, const QuadrantGlitch& glitch) {
  const nlohmann::ordered_json json{{"timestamp", glitch.t},
                                    {"axis", layout.axes[glitch.axis].name},
                                    {"to", glitch.to_positive ? "positive" : "negative"},
                                    {"glitch_um", glitch.error_um}};
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::shared_ptr<LiveSink> udp_sink(const Endpoint& to) { return std::make_shared<UdpSink>(to); }

}  // namespace stribeck::workflow
