#pragma once
/// A virtual machine that runs beside the clock and feeds a stream: the source for those who have no machine at hand.
///
///   r_x x_x table_x e_x f_x friction_x   of each axis: commanded, encoder, table, its error, force, friction; then contour_error
///
/// A computer that is too slow does not run ahead later: the stream says how far it is behind.
/// Real time: no.

#include <atomic>
#include <memory>
#include <stribeck/sim/endless_run.hpp>
#include <stribeck/workflow/live/live_stream.hpp>
#include <thread>

namespace stribeck::workflow {

/// Channels of a simulated stream.
LiveLayout layout_of(const sim::EndlessRun& run, const std::string& source);

/// One period of the run into the stream.
void add_step(sim::EndlessRun& run, LiveStream& stream);

class SimulatedStream {
 public:
  /// speed: so many times as fast as the clock.
  SimulatedStream(std::unique_ptr<sim::EndlessRun> run, std::shared_ptr<LiveStream> stream, double speed);
  ~SimulatedStream();
  SimulatedStream(const SimulatedStream&) = delete;
  SimulatedStream& operator=(const SimulatedStream&) = delete;

 private:
  void work();

  std::unique_ptr<sim::EndlessRun> run_;
  std::shared_ptr<LiveStream> stream_;
  double speed_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace stribeck::workflow
