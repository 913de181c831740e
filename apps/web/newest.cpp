#include <algorithm>

#include <apps/web/newest.hpp>

namespace stribeck::web {

bool Newest::post(const std::string& client, Job job) {
  Job replaced;
  {
    const std::lock_guard lock(shared_->mutex);
    auto& waiting = shared_->waiting;
    if (shared_->busy && shared_->running == client) shared_->old = true;
    const auto mine = std::find_if(waiting.begin(), waiting.end(),
                                   [&](const auto& other) { return other.first == client; });
    if (mine != waiting.end()) {
      replaced = std::exchange(mine->second, std::move(job));
    } else {
      if (shared_->ends || waiting.size() >= most_) return false;
      waiting.emplace_back(client, std::move(job));
    }
  }
  shared_->changed.notify_all();
  if (replaced.drop) replaced.drop();
  return true;
}

void Newest::Shared::work() {
  std::unique_lock lock(mutex);
  for (;;) {
    changed.wait(lock, [&] { return ends || !waiting.empty(); });
    if (ends) break;
    Job job = std::move(waiting.front().second);
    running = std::move(waiting.front().first);
    waiting.erase(waiting.begin());
    busy = true;
    old = false;
    lock.unlock();
    job.run([this] {
      const std::lock_guard guard(mutex);
      return old || ends;
    });
    job = {};  // what it holds goes before it counts as done
    lock.lock();
    busy = false;
  }
  waiting.clear();
  ended = true;
  changed.notify_all();
}

bool Newest::stop(std::chrono::milliseconds patience) {
  if (!thread_.joinable()) return true;
  std::unique_lock lock(shared_->mutex);
  shared_->ends = true;
  shared_->changed.notify_all();
  const bool ended = shared_->changed.wait_for(lock, patience, [&] { return shared_->ended; });
  lock.unlock();
  if (ended) {
    thread_.join();
  } else {
    thread_.detach();
  }
  return ended;
}

}  // namespace stribeck::web
