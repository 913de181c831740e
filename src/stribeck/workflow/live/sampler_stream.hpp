#pragma once
/// A stream of text as LinuxCNC's halsampler writes it, from standard input, a pipe or a file that grows.
///
///   one row a line, numbers apart by blanks, in the order of the pins; with -t the number of the sample before them; `overrun` where
///   samples were lost
///
/// The time is the sample number, or the count of lines, times the sample time. A line that is no row (other number of values, text, nan)
/// is counted, said and left out; the time goes on. A sample number that goes back, a pipe that is opened again and a file that became
/// shorter are restarts: the time goes on with a gap.
///
/// A contour error is added as a last channel where axes have commanded and actual position: by option, else by the names of the
/// columns (workflow/log/names/column_words.hpp), e.g. x-cmd and x-pos or x-fb.
/// Real time: no.
/// Errors: InputError naming the option or the file.

#include <atomic>
#include <memory>
#include <stribeck/workflow/live/live_stream.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace stribeck::workflow {

struct SamplerOptions {
  std::string source;                ///< "-" or a file
  std::vector<std::string> columns;  ///< "x-cmd mm", in their order
  std::string side_file;             ///< TOML with columns and sample_time, as beside a log
  std::string sample_time;           ///< "1 ms"
  std::vector<std::string> axes;     ///< "x=x-cmd,x-fb": commanded, actual
};

/// What the rows are, before the first one comes. `pairs`: channels of commanded and actual position of each axis.
struct SamplerLayout {
  LiveLayout live;
  std::vector<std::size_t> actual;  ///< channel of each axis of `live`
  std::vector<double> actual_to_m;
  std::size_t columns = 0;  ///< those of a line
};
SamplerLayout sampler_layout(const SamplerOptions& options);

/// Bytes to rows of a stream.
class SamplerLines {
 public:
  static constexpr std::size_t kLongestLine = 65536;

  SamplerLines(SamplerLayout layout, std::shared_ptr<LiveStream> stream);

  /// The next bytes, cut anywhere.
  void take(std::string_view bytes);
  /// What comes next is another recording; an incomplete line is dropped.
  void restart();

 private:
  void line(std::string_view text);
  /// False: not a number, why() set.
  bool parse(std::string_view text);
  bool advance(bool tagged);
  void add_row();

  SamplerLayout layout_;
  std::shared_ptr<LiveStream> stream_;
  ContourTracker tracker_;
  std::string rest_;
  bool skipping_ = false;  ///< of a line that is too long
  std::vector<double> cells_;
  std::vector<double> commanded_;
  std::vector<double> actual_;
  std::string why_;
  bool known_ = false;   ///< the form of the lines
  bool tagged_ = false;  ///< their first value is the sample number
  double tag_ = 0.0;     ///< of the last row
  bool tag_known_ = false;
  double samples_ = -1.0;  ///< of the last row, from the first
};

/// Reads in a thread of its own. The thread ends with the source; a file and a named pipe never end.
class SamplerStream {
 public:
  /// Opens the source at once.
  SamplerStream(const std::string& source, SamplerLayout layout, std::shared_ptr<LiveStream> stream);
  ~SamplerStream();
  SamplerStream(const SamplerStream&) = delete;
  SamplerStream& operator=(const SamplerStream&) = delete;

 private:
  void work();
  void wait();

  int file_ = -1;
  bool owned_ = false;
  std::shared_ptr<LiveStream> stream_;
  SamplerLines lines_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace stribeck::workflow
