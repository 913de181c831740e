#pragma once
/// A stream of samples while it runs: what a page draws of it, the glitches at the quadrants, a recording, and those who get every row.
///
/// One thread, that of the source, adds rows; others look. Memory is bounded and does not grow with time: the last kKeptBins bins with
/// the extremes of each channel, so that no peak is lost by thinning, and the last kKeptGlitches glitches. A reader that comes too late for a
/// bin is told how many it missed. A recording goes to a file (live_recording.hpp) and lacks no row.
/// Threads: safe. Real time: no.
/// Errors: InputError from the recording.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stribeck/sim/compare.hpp>
#include <stribeck/workflow/live/contour_tracker.hpp>
#include <stribeck/workflow/live/live_recording.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::workflow {

struct LiveChannel {
  std::string name;
  std::string unit;  ///< "" where none is known
};

/// An axis whose reversals are looked for.
struct LiveAxis {
  std::string name;
  std::size_t commanded = 0;  ///< channel of its commanded position
  double to_m = 1.0;          ///< of that channel
};

struct LiveLayout {
  static constexpr std::size_t kMostChannels = 64;

  std::string source;  ///< in words
  std::vector<LiveChannel> channels;
  std::vector<LiveAxis> axes;
  std::optional<std::size_t> error;                           ///< channel of the contour error [um]
  double sample_time = 1e-3;                                  ///< [s]
  std::vector<std::pair<std::string, std::string>> metadata;  ///< of a recording

  /// "x [mm]"
  [[nodiscard]] std::vector<std::string> headers() const;
};

/// Gets every row, on the thread of the source: it must not wait.
class LiveSink {
 public:
  LiveSink() = default;
  LiveSink(const LiveSink&) = delete;
  LiveSink& operator=(const LiveSink&) = delete;
  virtual ~LiveSink() = default;

  virtual void row(const LiveLayout& layout, double t, std::span<const double> values) = 0;
  virtual void glitch(const LiveLayout& layout, const QuadrantGlitch& glitch) = 0;
  [[nodiscard]] virtual std::string in_words() const = 0;    ///< where it goes
  [[nodiscard]] virtual std::uint64_t left_out() const = 0;  ///< rows that could not be sent
};

struct LiveState {
  std::uint64_t rows = 0;
  double t = 0.0;              ///< of the last row [s]
  std::uint64_t lost = 0;      ///< samples that the source says are missing
  std::uint64_t overruns = 0;  ///< places where it does not say how many
  std::uint64_t restarts = 0;
  std::uint64_t refused = 0;  ///< lines that are no row
  std::string last_refused;   ///< why, for the newest of them
  double slipped = 0.0;       ///< time that a simulation is behind the clock [s]
  bool ended = false;
  std::string why;  ///< it ended
  bool recording = false;
  std::uint64_t recorded_rows = 0;
  std::uint64_t recorded_bytes = 0;
  std::string recording_stopped;  ///< why no further row is recorded; empty: it goes on
  std::vector<control::Drift> drift;
};

/// Bins one after the other; of channel c in bin i: low[i * channels + c].
struct LiveBins {
  std::uint64_t first = 0;   ///< number of the first one
  std::uint64_t missed = 0;  ///< bins between the one that was asked for and the first one
  std::vector<double> t;     ///< of their first rows [s]
  std::vector<float> low;
  std::vector<float> high;
};

class LiveStream {
 public:
  static constexpr double kBinTime = 0.01;        ///< [s]
  static constexpr std::size_t kKeptBins = 6000;  ///< a minute
  static constexpr std::size_t kKeptGlitches = 200;

  explicit LiveStream(LiveLayout layout, std::vector<std::shared_ptr<LiveSink>> sinks = {});

  [[nodiscard]] const LiveLayout& layout() const { return layout_; }
  [[nodiscard]] const std::vector<std::shared_ptr<LiveSink>>& sinks() const { return sinks_; }
  /// [s]
  [[nodiscard]] double bin_time() const { return static_cast<double>(per_bin_) * layout_.sample_time; }

  // ---- for the source

  void row(double t, std::span<const double> values);
  /// Samples are missing; 0: nobody knows how many.
  void lost(std::uint64_t samples);
  void restarted();
  void refused(const std::string& why);
  void slipped(double seconds);
  void drift(std::vector<control::Drift> now);
  void end(const std::string& why);

  // ---- for those who look

  [[nodiscard]] LiveState state() const;
  /// Complete bins from a number on, at most `most`.
  [[nodiscard]] LiveBins bins(std::uint64_t from, std::size_t most) const;
  /// Quadrant glitches from a number on; the number of the first one is set.
  [[nodiscard]] std::vector<QuadrantGlitch> glitches(std::uint64_t from, std::uint64_t& first) const;

  // ---- recording

  void record(const std::filesystem::path& folder, std::uint64_t most_bytes = LiveRecording::kMostBytes);
  /// The file; throws where nothing is recorded.
  std::filesystem::path save();
  void discard();

 private:
  void break_line();
  void close_bin();
  void look_for_glitches(double t, std::span<const double> values);
  void add_to_recording(double t, std::span<const double> values);

  LiveLayout layout_;
  std::vector<std::shared_ptr<LiveSink>> sinks_;
  std::size_t per_bin_;

  mutable std::mutex mutex_;
  LiveState state_;
  std::uint64_t bins_ = 0;  ///< complete ones
  std::vector<double> bin_t_;
  std::vector<float> low_;
  std::vector<float> high_;
  std::size_t in_bin_ = 0;  ///< rows of the open bin
  std::deque<QuadrantGlitch> glitches_;
  std::uint64_t glitch_count_ = 0;

  // Of the source alone.
  QuadrantGlitches quadrants_;
  std::vector<double> commanded_;
  std::vector<QuadrantGlitch> found_;

  std::mutex record_mutex_;  ///< taken before mutex_
  std::unique_ptr<LiveRecording> recording_;
};

}  // namespace stribeck::workflow
