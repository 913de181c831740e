#pragma once
/// Runs independent jobs on all cores and hands their results over in the order of their numbers, while later ones run. Results that
/// wait for an earlier one are at most kAhead for each thread, so memory does not depend on the number of jobs. After an exception of
/// a job, those before it are handed over, and it is thrown again.
/// Real time: no.

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace stribeck::sim {

/// Calls take(i, make(i)) for i in [begin, end) in order; make runs on any thread, take on one at a time.
/// threads = 0: as many as the computer has.
template <class Make, class Take>
void in_order(std::uint64_t begin, std::uint64_t end, unsigned threads, Make&& make, Take&& take) {
  using Result = std::invoke_result_t<Make&, std::uint64_t>;
  constexpr std::uint64_t kAhead = 16;
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  std::mutex mutex;
  std::condition_variable moved;
  std::uint64_t next = begin;
  std::uint64_t taken = begin;
  std::map<std::uint64_t, Result> waiting;
  std::uint64_t failed = std::numeric_limits<std::uint64_t>::max();
  std::exception_ptr error;
  const auto fail = [&](std::uint64_t i) {
    if (i >= failed) return;
    failed = i;
    error = std::current_exception();
  };
  const auto work = [&] {
    std::unique_lock lock(mutex);
    for (;;) {
      moved.wait(lock, [&] { return next >= end || error || next < taken + kAhead * threads; });
      if (next >= end || error) return;
      const std::uint64_t i = next++;
      lock.unlock();
      try {
        Result result = make(i);
        lock.lock();
        waiting.emplace(i, std::move(result));
      } catch (...) {
        if (!lock.owns_lock()) lock.lock();
        fail(i);
      }
      try {
        for (auto first = waiting.find(taken); first != waiting.end() && taken < failed;
             first = waiting.find(taken)) {
          take(taken, std::move(first->second));
          waiting.erase(first);
          ++taken;
        }
      } catch (...) {
        fail(taken);
      }
      moved.notify_all();
    }
  };
  {
    std::vector<std::jthread> pool;
    for (unsigned k = 1; k < threads; ++k) pool.emplace_back(work);
    work();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace stribeck::sim
