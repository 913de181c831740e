#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/live/stream_out.hpp>

namespace stribeck::workflow::stream_out_test {
namespace {

LiveLayout one_axis() {
  LiveLayout l;
  l.channels = {{"r_x", "mm"}, {"v/ref \"x\"", "mm/s"}, {"line", ""}};
  l.axes = {{"x", 0, 1e-3}};
  return l;
}

// What PlotJuggler's UDP server gets: an object with numbers, one of which is called timestamp.
TEST(StreamOut, ADatagramIsAnObjectWithATimestamp) {
  const int receiver = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::bind(receiver, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  socklen_t size = sizeof address;
  ::getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &size);
  const auto sink = udp_sink({"127.0.0.1", ntohs(address.sin_port), {}});
  sink->row(one_axis(), 1.25, std::array{9.81, -0.5, 7.0});
  std::array<char, 4096> bytes{};
  const ssize_t n = ::recv(receiver, bytes.data(), bytes.size(), 0);
  ::close(receiver);
  ASSERT_GT(n, 0);
  const auto json = nlohmann::json::parse(std::string(bytes.data(), static_cast<std::size_t>(n)));
  EXPECT_EQ(json, (nlohmann::json{
                      {"timestamp", 1.25}, {"r_x_mm", 9.81}, {"v_per_ref__x__mm_per_s", -0.5}, {"line", 7}}));
}

TEST(StreamOut, WhatIsNoNumberIsNull) {
  const auto json = nlohmann::json::parse(json_of(one_axis(), 0.0, std::array{std::nan(""), 1.0, 2.0}));
  EXPECT_TRUE(json["r_x_mm"].is_null());
}

TEST(StreamOut, Endpoints) {
  EXPECT_EQ(read_endpoint("--udp", "9870", 0, false).host, "127.0.0.1");
  EXPECT_EQ(read_endpoint("--udp", "9870", 0, false).port, 9870);
  EXPECT_EQ(read_endpoint("--udp", "[::1]:5", 0, false).host, "::1");
  const Endpoint e = read_endpoint("--mqtt", "broker/mill/1", 1883, true);
  EXPECT_EQ(e.host, "broker");
  EXPECT_EQ(e.port, 1883);
  EXPECT_EQ(e.topic, "mill/1");
  EXPECT_EQ(read_endpoint("--mqtt", "broker:7", 1883, true).topic, "stribeck/live");
  for (const char* wrong : {"", "host", ":5", "1.2.3.4:99999", "1.2.3.4:x", "0"})
    EXPECT_THROW(read_endpoint("--udp", wrong, 0, false), io::InputError) << wrong;
  EXPECT_THROW(read_endpoint("--mqtt", "broker/#", 1883, true), io::InputError);
  EXPECT_THROW(udp_sink({"localhost", 5, {}}), io::InputError);
}

}  // namespace
}  // namespace stribeck::workflow::stream_out_test
