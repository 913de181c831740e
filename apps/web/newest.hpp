#pragma once
/// One thread for what takes long. Of each client only the newest job counts: one that waits is replaced, one that runs is told that it
/// is out of date. Clients take turns.
/// Real time: no.

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace stribeck::web {

class Newest {
 public:
  /// Whether a newer job of the client waits, or everything ends.
  using IsOld = std::function<bool()>;
  struct Job {
    std::function<void(const IsOld&)> run;  ///< must not throw
    std::function<void()> drop;             ///< in its place when a newer one came first
  };

  explicit Newest(std::size_t most_waiting = 32) : most_(most_waiting) {
    // Shared with the thread, which may outlive this object by one job.
    thread_ = std::thread([shared = shared_] { shared->work(); });
  }
  ~Newest() { stop(std::chrono::hours(1)); }
  Newest(const Newest&) = delete;
  Newest& operator=(const Newest&) = delete;

  /// False: too many clients wait.
  bool post(const std::string& client, Job job);

  /// Ends the thread. False: its job did not end in time; then the thread is left alone, and only the end of the program ends it.
  bool stop(std::chrono::milliseconds patience);

 private:
  struct Shared {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<std::pair<std::string, Job>> waiting;
    std::string running;  ///< its client
    bool busy = false;
    bool old = false;  ///< the running job
    bool ends = false;
    bool ended = false;

    void work();
  };

  std::size_t most_;
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  std::thread thread_;
};

}  // namespace stribeck::web
