#include <dlfcn.h>
#include <fmt/format.h>

#include <atomic>
#include <memory>
#include <stribeck/io/error.hpp>
#include <stribeck/workflow/live/stream_out.hpp>
#include <stribeck/workflow/option.hpp>

namespace stribeck::workflow {
namespace {

struct mosquitto;
constexpr int kSuccess = 0;

/// Functions of libmosquitto 1.4 to 2.0 (libmosquitto.so.1), as its <mosquitto.h> has them.
struct Mosquitto {
  int (*lib_init)();
  mosquitto* (*create)(const char*, bool, void*);
  void (*destroy)(mosquitto*);
  int (*connect_async)(mosquitto*, const char*, int, int);
  int (*reconnect_delay_set)(mosquitto*, unsigned, unsigned, bool);
  int (*loop_start)(mosquitto*);
  int (*loop_stop)(mosquitto*, bool);
  int (*disconnect)(mosquitto*);
  int (*publish)(mosquitto*, int*, const char*, int, const void*, int, bool);
  void (*connect_callback_set)(mosquitto*, void (*)(mosquitto*, void*, int));
  void (*disconnect_callback_set)(mosquitto*, void (*)(mosquitto*, void*, int));
  void (*publish_callback_set)(mosquitto*, void (*)(mosquitto*, void*, int));
  bool whole = false;

  Mosquitto() {
    void* handle = ::dlopen("libmosquitto.so.1", RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) return;
    whole = true;
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(handle, name));
      whole = whole && function != nullptr;
    };
    find(lib_init, "mosquitto_lib_init");
    find(create, "mosquitto_new");
    find(destroy, "mosquitto_destroy");
    find(connect_async, "mosquitto_connect_async");
    find(reconnect_delay_set, "mosquitto_reconnect_delay_set");
    find(loop_start, "mosquitto_loop_start");
    find(loop_stop, "mosquitto_loop_stop");
    find(disconnect, "mosquitto_disconnect");
    find(publish, "mosquitto_publish");
    find(connect_callback_set, "mosquitto_connect_callback_set");
    find(disconnect_callback_set, "mosquitto_disconnect_callback_set");
    find(publish_callback_set, "mosquitto_publish_callback_set");
    whole = whole && lib_init() == kSuccess;
  }
};

const Mosquitto& mosquitto_library() {
  static const Mosquitto kLibrary;
  if (!kLibrary.whole)
    refuse_option("--mqtt",
                  "needs the library libmosquitto, which is missing (apt-get install libmosquitto1)");
  return kLibrary;
}

class MqttSink final : public LiveSink {
 public:
  explicit MqttSink(const Endpoint& to)
      : library_(mosquitto_library()),
        words_(fmt::format("MQTT to {} port {}, topic {}", to.host, to.port, to.topic)),
        topic_(to.topic) {
    client_ = library_.create(nullptr, true, this);
    if (client_ == nullptr) refuse_option("--mqtt", "libmosquitto gives no client");
    library_.connect_callback_set(client_, [](mosquitto*, void* self, int code) {
      static_cast<MqttSink*>(self)->connected_ = code == 0;
    });
    library_.disconnect_callback_set(client_, [](mosquitto*, void* self, int) {
      auto* sink = static_cast<MqttSink*>(self);
      sink->connected_ = false;
      sink->waiting_ = 0;  // libmosquitto drops what it has of quality of service 0
    });
    library_.publish_callback_set(client_, [](mosquitto*, void* self, int) {
      auto* sink = static_cast<MqttSink*>(self);
      if (sink->waiting_ > 0) --sink->waiting_;
    });
    constexpr int kKeepAlive = 30;  // [s]
    library_.reconnect_delay_set(client_, 1, 10, false);
    library_.connect_async(client_, to.host.c_str(), to.port, kKeepAlive);
    library_.loop_start(client_);
  }
  ~MqttSink() override {
    library_.disconnect(client_);
    library_.loop_stop(client_, true);
    library_.destroy(client_);
  }

  void row(const LiveLayout& layout, double t, std::span<const double> values) override {
    send(topic_, json_of(layout, t, values));
  }
  void glitch(const LiveLayout& layout, const QuadrantGlitch& p) override {
    send(topic_ + "/glitch", json_of(layout, p));
  }
  [[nodiscard]] std::string in_words() const override {
    return words_ + (connected_ ? "" : ", not connected");
  }
  [[nodiscard]] std::uint64_t left_out() const override { return left_out_; }

 private:
  void send(const std::string& topic, const std::string& text) {
    // libmosquitto would keep without bound what the network does not take.
    constexpr int kMostWaiting = 2000;
    if (!connected_ || waiting_ >= kMostWaiting) {
      ++left_out_;
      return;
    }
    ++waiting_;
    if (library_.publish(client_, nullptr, topic.c_str(), static_cast<int>(text.size()), text.data(), 0,
                         false) == kSuccess)
      return;
    if (waiting_ > 0) --waiting_;
    ++left_out_;
  }

  const Mosquitto& library_;
  std::string words_;
  std::string topic_;
  mosquitto* client_ = nullptr;
  std::atomic<bool> connected_{false};
  std::atomic<int> waiting_{0};
  std::atomic<std::uint64_t> left_out_{0};
};

}  // namespace

std::shared_ptr<LiveSink> mqtt_sink(const Endpoint& to) { return std::make_shared<MqttSink>(to); }

}  // namespace stribeck::workflow
