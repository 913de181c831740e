#include <algorithm>
#include <cmath>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/live/live_stream.hpp>

namespace stribeck::workflow {

std::vector<std::string> LiveLayout::headers() const {
  std::vector<std::string> all;
  for (const LiveChannel& c : channels) all.push_back(c.unit.empty() ? c.name : c.name + " [" + c.unit + "]");
  return all;
}

LiveStream::LiveStream(LiveLayout layout, std::vector<std::shared_ptr<LiveSink>> sinks)
    : layout_(std::move(layout)),
      sinks_(std::move(sinks)),
      per_bin_(static_cast<std::size_t>(std::max(1.0, std::round(kBinTime / layout_.sample_time)))),
      bin_t_(kKeptBins),
      low_(kKeptBins * layout_.channels.size()),
      high_(kKeptBins * layout_.channels.size()),
      quadrants_(layout_.axes.size()),
      commanded_(layout_.axes.size()) {}

void LiveStream::row(double t, std::span<const double> values) {
  add_to_recording(t, values);
  for (const auto& sink : sinks_) sink->row(layout_, t, values);
  look_for_glitches(t, values);
  const std::lock_guard lock(mutex_);
  ++state_.rows;
  state_.t = t;
  const std::size_t slot = bins_ % kKeptBins;
  float* low = &low_[slot * values.size()];
  float* high = &high_[slot * values.size()];
  if (in_bin_ == 0) bin_t_[slot] = t;
  for (std::size_t c = 0; c < values.size(); ++c) {
    const auto v = static_cast<float>(values[c]);
    low[c] = in_bin_ == 0 ? v : std::min(low[c], v);
    high[c] = in_bin_ == 0 ? v : std::max(high[c], v);
  }
  if (++in_bin_ == per_bin_) close_bin();
}

void LiveStream::close_bin() {
  ++bins_;
  in_bin_ = 0;
}

void LiveStream::look_for_glitches(double t, std::span<const double> values) {
  if (!layout_.error || layout_.axes.empty()) return;
  for (std::size_t i = 0; i < commanded_.size(); ++i)
    commanded_[i] = values[layout_.axes[i].commanded] * layout_.axes[i].to_m;
  found_.clear();
  quadrants_.step(t, commanded_, values[*layout_.error], found_);
  if (found_.empty()) return;
  for (const auto& sink : sinks_) {
    for (const QuadrantGlitch& p : found_) sink->glitch(layout_, p);
  }
  const std::lock_guard lock(mutex_);
  for (const QuadrantGlitch& p : found_) glitches_.push_back(p);
  glitch_count_ += found_.size();
  while (glitches_.size() > kKeptGlitches) glitches_.pop_front();
}

void LiveStream::add_to_recording(double t, std::span<const double> values) {
  const std::lock_guard recording_lock(record_mutex_);
  if (!recording_) return;
  recording_->row(t, values);
  const std::lock_guard lock(mutex_);
  state_.recorded_rows = recording_->rows();
  state_.recorded_bytes = recording_->bytes();
  state_.recording_stopped = recording_->why();
}

/// What is drawn and counted begins anew after missing samples.
void LiveStream::break_line() {
  quadrants_.restart();
  const std::lock_guard lock(mutex_);
  if (in_bin_ > 0) close_bin();
}

void LiveStream::lost(std::uint64_t samples) {
  break_line();
  const std::lock_guard lock(mutex_);
  if (samples == 0) {
    ++state_.overruns;
  } else {
    state_.lost += samples;
  }
}

void LiveStream::restarted() {
  break_line();
  const std::lock_guard lock(mutex_);
  ++state_.restarts;
}

void LiveStream::refused(const std::string& why) {
  const std::lock_guard lock(mutex_);
  ++state_.refused;
  state_.last_refused = why;
}

void LiveStream::slipped(double seconds) {
  const std::lock_guard lock(mutex_);
  state_.slipped += seconds;
}

void LiveStream::drift(std::vector<control::Drift> now) {
  const std::lock_guard lock(mutex_);
  state_.drift = std::move(now);
}

void LiveStream::end(const std::string& why) {
  const std::lock_guard lock(mutex_);
  state_.ended = true;
  state_.why = why;
}

LiveState LiveStream::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

LiveBins LiveStream::bins(std::uint64_t from, std::size_t most) const {
  const std::lock_guard lock(mutex_);
  LiveBins out;
  // The open bin has a place in the ring as well.
  const std::uint64_t oldest = bins_ >= kKeptBins ? bins_ - kKeptBins + 1 : 0;
  out.first = std::min(std::max(from, oldest), bins_);
  out.missed = out.first > from ? out.first - from : 0;
  const std::size_t channels = layout_.channels.size();
  for (std::uint64_t i = out.first; i < bins_ && i - out.first < most; ++i) {
    const auto slot = static_cast<std::size_t>(i % kKeptBins);
    out.t.push_back(bin_t_[slot]);
    for (std::size_t c = 0; c < channels; ++c) {
      out.low.push_back(low_[slot * channels + c]);
      out.high.push_back(high_[slot * channels + c]);
    }
  }
  return out;
}

std::vector<QuadrantGlitch> LiveStream::glitches(std::uint64_t from, std::uint64_t& first) const {
  const std::lock_guard lock(mutex_);
  const std::uint64_t oldest = glitch_count_ - glitches_.size();
  first = std::min(std::max(from, oldest), glitch_count_);
  return {glitches_.begin() + static_cast<std::ptrdiff_t>(first - oldest), glitches_.end()};
}

void LiveStream::record(const std::filesystem::path& folder, std::uint64_t most_bytes) {
  const std::lock_guard recording_lock(record_mutex_);
  if (recording_)
    throw io::InputError({"request", 0, "record", "a recording runs already (save or discard it first)"});
  recording_ = std::make_unique<LiveRecording>(folder, layout_.headers(), layout_.metadata, most_bytes);
  const std::lock_guard lock(mutex_);
  state_.recording = true;
  state_.recorded_rows = state_.recorded_bytes = 0;
  state_.recording_stopped.clear();
}

std::filesystem::path LiveStream::save() {
  std::unique_lock recording_lock(record_mutex_);
  if (!recording_) throw io::InputError({"request", 0, "record", "nothing is recorded (press Record first)"});
  if (recording_->rows() == 0)
    throw io::InputError({"request", 0, "record", "no row has come since Record (wait for one, or discard)"});
  const std::unique_ptr<LiveRecording> done = std::move(recording_);
  {
    const std::lock_guard lock(mutex_);
    state_.recording = false;
  }
  // The disk may take its time; rows do not wait for it.
  recording_lock.unlock();
  return done->end();
}

void LiveStream::discard() {
  const std::lock_guard recording_lock(record_mutex_);
  recording_.reset();
  const std::lock_guard lock(mutex_);
  state_.recording = false;
}

}  // namespace stribeck::workflow
