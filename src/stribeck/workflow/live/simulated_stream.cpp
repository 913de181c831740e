#include <array>
#include <chrono>
#include <cmath>

#include <stribeck/workflow/live/simulated_stream.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::size_t kOfAxis = 6;
constexpr double kMm = 1e3;
constexpr double kUm = 1e6;

}  // namespace

LiveLayout layout_of(const sim::EndlessRun& run, const std::string& source) {
  LiveLayout out;
  out.source = source;
  out.sample_time = run.period();
  for (const std::string& axis : run.axes()) {
    out.axes.push_back({axis, out.channels.size(), 1.0 / kMm});
    for (const auto& [name, unit] : std::array<std::pair<const char*, const char*>, kOfAxis>{
             {{"r_", "mm"}, {"x_", "mm"}, {"table_", "mm"}, {"e_", "um"}, {"f_", "N"}, {"friction_", "N"}}})
      out.channels.push_back({name + axis, unit});
  }
  out.error = out.channels.size();
  out.channels.push_back({"contour_error", "um"});
  out.metadata = {{"source", source}};
  return out;
}

void add_step(sim::EndlessRun& run, LiveStream& stream) {
  const sim::ContourSample s = run.step();
  std::array<double, kOfAxis * control::kMostAxes + 1> values{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < run.axes().size(); ++i) {
    for (const double v : {s.reference[i] * kMm, s.encoder[i] * kMm, s.position[i] * kMm,
                           (s.position[i] - s.reference[i]) * kUm, s.force[i], s.friction[i]})
      values[n++] = v;
  }
  values[n++] = s.contour_error * kUm;
  stream.row(s.time, std::span<const double>(values).first(n));
}

SimulatedStream::SimulatedStream(std::unique_ptr<sim::EndlessRun> run, std::shared_ptr<LiveStream> stream,
                                 double speed)
    : run_(std::move(run)), stream_(std::move(stream)), speed_(speed) {
  thread_ = std::thread([this] { work(); });
}

SimulatedStream::~SimulatedStream() {
  ends_ = true;
  thread_.join();
}

void SimulatedStream::work() {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kRest{5};
  constexpr double kMostBehind = 0.25;  // [s] of the clock
  constexpr double kDriftEvery = 1.0;   // [s] of the machine
  const double step = run_->period();
  auto begin = Clock::now();
  double t = 0.0;
  double begin_t = 0.0;
  double next_drift = 0.0;
  while (!ends_) {
    const double elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
    const double due = begin_t + elapsed * speed_;
    if (due - t > kMostBehind * speed_) {
      stream_->slipped((due - t) / speed_);
      begin = Clock::now();
      begin_t = t;
    }
    // A few periods, then a look at the clock, so that stopping never waits long.
    for (int k = 0; k < 50 && t < due && !ends_; ++k) {
      add_step(*run_, *stream_);
      t += step;
    }
    if (t >= next_drift) {
      stream_->drift(run_->drift());
      next_drift = t + kDriftEvery;
    }
    if (t >= due) std::this_thread::sleep_for(kRest);
  }
}

}  // namespace stribeck::workflow
