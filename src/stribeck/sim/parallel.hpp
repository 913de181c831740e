#pragma once
/// Runs independent jobs on all cores. Each worker makes its own context once, and each job writes to its own place, so the result
/// does not depend on the number of threads. An exception of a job, or of progress, is thrown again here; of several, the one
/// with the smallest index.
/// Real time: no.

#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace stribeck::sim {

/// Calls job(context, i) for i in [0, count). threads = 0: as many as the machine has.
template <class MakeContext, class Job>
void parallel_for(std::size_t count, unsigned threads, MakeContext&& make_context, Job&& job,
                  const std::function<void(std::size_t, std::size_t)>& progress = {}) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  if (threads > count) threads = static_cast<unsigned>(std::max<std::size_t>(count, 1));
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::size_t done = 0;
  std::vector<std::exception_ptr> errors(count);
  const auto work = [&] {
    auto context = make_context();
    for (std::size_t i = next++; i < count && !stop; i = next++) {
      try {
        job(context, i);
      } catch (...) {
        errors[i] = std::current_exception();
        stop = true;
      }
      const std::lock_guard lock(mutex);
      ++done;
      try {
        if (progress) progress(done, count);
      } catch (...) {
        if (!errors[i]) errors[i] = std::current_exception();
        stop = true;
      }
    }
  };
  {
    std::vector<std::jthread> pool;
    for (unsigned i = 1; i < threads; ++i) pool.emplace_back(work);
    work();
  }
  for (const auto& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace stribeck::sim
