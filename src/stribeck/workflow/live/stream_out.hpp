#pragma once
/// A stream sent on, row by row: as JSON in UDP datagrams, which PlotJuggler's UDP server reads, and to a broker by MQTT.
///
///   {"timestamp": 1.234, "r_x_mm": 9.81, …}   one object per row; keys are names of channels with their units, the time in seconds
///   {"timestamp": 1.2, "axis": "x", "to": "positive", "glitch_um": 12.1}   a quadrant glitch, by MQTT below TOPIC/glitch
///
/// Nothing waits: what cannot be sent is left out and counted. MQTT 3.1.1, quality of service 0, by libmosquitto, which is loaded when it
/// is asked for.
/// Real time: no.
/// Errors: InputError for an address that is none, and for a missing library.

#include <memory>
#include <stribeck/workflow/live/live_stream.hpp>
#include <string>

namespace stribeck::workflow {

/// Where a stream is sent.
struct Endpoint {
  std::string host = "127.0.0.1";
  unsigned short port = 0;
  std::string topic;  ///< of MQTT
};
/// "9870", "192.168.1.4:9870", "HOST:1883/TOPIC" with a topic. `option` is for messages.
Endpoint read_endpoint(const std::string& option, const std::string& text, unsigned short default_port,
                       bool with_topic);

/// A row as text.
std::string json_of(const LiveLayout& layout, double t, std::span<const double> values);
std::string json_of(const LiveLayout& layout, const QuadrantGlitch& glitch);

/// The address must be a number.
std::shared_ptr<LiveSink> udp_sink(const Endpoint& to);
/// The broker may come later, and go and come again.
std::shared_ptr<LiveSink> mqtt_sink(const Endpoint& to);

}  // namespace stribeck::workflow
