#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <system_error>

#include <stribeck/io/error.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/workflow/live/sampler_stream.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::string_view kLostWord = "overrun";

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view without_space(std::string_view s) {
  while (!s.empty() && is_space(s.front())) s.remove_prefix(1);
  while (!s.empty() && is_space(s.back())) s.remove_suffix(1);
  return s;
}

}  // namespace

SamplerLines::SamplerLines(SamplerLayout layout, std::shared_ptr<LiveStream> stream)
    : layout_(std::move(layout)),
      stream_(std::move(stream)),
      tracker_(std::max<std::size_t>(layout_.live.axes.size(), 1)),
      commanded_(layout_.live.axes.size()),
      actual_(layout_.live.axes.size()) {}

void SamplerLines::take(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    const std::string_view part = bytes.substr(0, end);
    if (!skipping_) rest_ += part;
    bytes.remove_prefix(std::min(part.size() + 1, bytes.size()));
    if (rest_.size() > kLongestLine) {
      stream_->refused(fmt::format("a line is longer than {} characters", kLongestLine));
      rest_.clear();
      skipping_ = true;
    }
    if (end == std::string_view::npos) return;
    if (!skipping_) line(rest_);
    rest_.clear();
    skipping_ = false;
  }
}

void SamplerLines::restart() {
  rest_.clear();
  skipping_ = known_ = tag_known_ = false;
  tracker_.restart();
  if (samples_ < 0.0) return;  // nothing was there before
  samples_ += 1.0;             // at least one sample is missing: the gap must show
  stream_->restarted();
}

void SamplerLines::line(std::string_view text) {
  text = without_space(text);
  if (text.empty()) return;
  if (text == kLostWord) {
    if (!tagged_ && samples_ >= 0.0) samples_ += 1.0;
    tracker_.restart();
    stream_->lost(0);
    return;
  }
  if (!parse(text)) {
    // It stands for a sample whose values are not known.
    if (known_ && !tagged_) samples_ += 1.0;
    stream_->refused(why_);
    return;
  }
  if (advance(tagged_)) add_row();
}

bool SamplerLines::parse(std::string_view text) {
  cells_.clear();
  const auto quoted = [&] { return io::in_quotes(std::string(text.substr(0, 60))); };
  for (std::string_view left = text; !left.empty();) {
    std::size_t n = 0;
    while (n < left.size() && !is_space(left[n])) ++n;
    const std::string_view cell = left.substr(0, n);
    left = without_space(left.substr(n));
    double value = 0.0;
    const auto [end, wrong] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (wrong != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
      why_ = fmt::format("got {}, expected numbers", quoted());
      return false;
    }
    if (cells_.size() > layout_.columns) {
      cells_.push_back(value);  // more than any form has; how many does not matter
      break;
    }
    cells_.push_back(value);
  }
  const std::size_t n = layout_.columns;
  const bool fits =
      known_ ? cells_.size() == n + (tagged_ ? 1 : 0) : cells_.size() == n || cells_.size() == n + 1;
  if (!fits) {
    why_ = fmt::format(
        "got {} values, expected {}{}", cells_.size() > n + 1 ? "more" : fmt::to_string(cells_.size()),
        known_ && tagged_ ? n + 1 : n, known_ ? " as before" : " as named (or one more, the sample number)");
    return false;
  }
  const bool tagged = cells_.size() == n + 1;
  if (tagged && cells_.front() != std::round(cells_.front())) {
    why_ = fmt::format("got {}, expected a sample number first", quoted());
    return false;
  }
  // Only a row that is taken says how all rows are.
  known_ = true;
  tagged_ = tagged;
  return true;
}

bool SamplerLines::advance(bool tagged) {
  double step = 1.0;
  if (tagged) {
    const double tag = cells_.front();
    if (tag_known_ && tag <= tag_) {
      tag_known_ = false;
      samples_ += 1.0;
      tracker_.restart();
      stream_->restarted();
    } else if (tag_known_) {
      step = tag - tag_;
      // A jump that no buffer explains would make a time without meaning.
      constexpr double kLargestJump = 1e7;
      if (step > kLargestJump) {
        stream_->refused(fmt::format("the sample number jumps by {:.0f}", step));
        tag_known_ = false;  // the rows behind it count on from there
        return false;
      }
      if (step > 1.0) {
        tracker_.restart();
        stream_->lost(static_cast<std::uint64_t>(step) - 1);
      }
    }
    tag_ = tag;
    tag_known_ = true;
    cells_.erase(cells_.begin());
  }
  samples_ += step;
  return true;
}

void SamplerLines::add_row() {
  if (layout_.live.error) {
    for (std::size_t i = 0; i < commanded_.size(); ++i) {
      commanded_[i] = cells_[layout_.live.axes[i].commanded] * layout_.live.axes[i].to_m;
      actual_[i] = cells_[layout_.actual[i]] * layout_.actual_to_m[i];
    }
    constexpr double kUm = 1e6;
    cells_.push_back(tracker_.step(commanded_, actual_) * kUm);
  }
  stream_->row(samples_ * layout_.live.sample_time, cells_);
}

SamplerStream::SamplerStream(const std::string& source, SamplerLayout layout,
                             std::shared_ptr<LiveStream> stream)
    : stream_(std::move(stream)), lines_(std::move(layout), stream_) {
  if (source == "-") {
    file_ = STDIN_FILENO;
  } else {
    // Without waiting for a writer of a named pipe.
    file_ = ::open(source.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file_ < 0)
      throw io::InputError({source, 0, {}, "cannot open: " + std::generic_category().message(errno)});
    owned_ = true;
  }
  struct stat what {};
  if (::fstat(file_, &what) != 0 || S_ISDIR(what.st_mode)) {
    if (owned_) ::close(file_);
    throw io::InputError({source, 0, {}, "is a folder, expected a file or a pipe"});
  }
  thread_ = std::thread([this] { work(); });
}

SamplerStream::~SamplerStream() {
  ends_ = true;
  thread_.join();
  if (owned_) ::close(file_);
}

void SamplerStream::wait() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

void SamplerStream::work() {
  struct stat what {};
  ::fstat(file_, &what);
  const bool grows = S_ISREG(what.st_mode);
  const bool named_pipe = S_ISFIFO(what.st_mode) && owned_;
  std::array<char, 65536> bytes{};
  off_t at = 0;
  bool writer = false;
  while (!ends_) {
    if (!grows) {
      pollfd asked{file_, POLLIN, 0};
      if (::poll(&asked, 1, 50) == 0) continue;
    }
    const ssize_t n = ::read(file_, bytes.data(), bytes.size());
    if (n > 0) {
      at += n;
      writer = true;
      lines_.take({bytes.data(), static_cast<std::size_t>(n)});
      continue;
    }
    if (n < 0 && errno != EAGAIN && errno != EINTR)
      return stream_->end("cannot read: " + std::generic_category().message(errno));
    if (n == 0 && named_pipe && writer) {
      writer = false;
      lines_.restart();
    } else if (n == 0 && grows) {
      if (::fstat(file_, &what) == 0 && what.st_size < at) {
        at = ::lseek(file_, 0, SEEK_SET);
        lines_.restart();
        continue;
      }
    } else if (n == 0 && !named_pipe) {
      return stream_->end("the stream has ended");
    }
    wait();
  }
}

}  // namespace stribeck::workflow
