#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <memory>
#include <stribeck/io/error.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/io/process/outside_program.hpp>
#include <utility>

namespace stribeck::io {
namespace detail {

/// Two file descriptors that close themselves.
class TwoEnds {
 public:
  explicit TwoEnds(bool both_ways) {
    if ((both_ways ? ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_.data())
                   : ::pipe2(ends_.data(), O_CLOEXEC)) != 0)
      throw ProgramFailed(fmt::format("no pipe to it: {}", std::strerror(errno)));
  }
  ~TwoEnds() {
    close_mine();
    close_its();
  }
  TwoEnds(const TwoEnds&) = delete;
  TwoEnds& operator=(const TwoEnds&) = delete;
  [[nodiscard]] int mine() const { return ends_[0]; }
  [[nodiscard]] int its() const { return ends_[1]; }
  void close_mine() { shut(0); }
  void close_its() { shut(1); }

 private:
  void shut(std::size_t i) {
    if (ends_[i] >= 0) ::close(ends_[i]);
    ends_[i] = -1;
  }
  std::array<int, 2> ends_{-1, -1};
};

}  // namespace detail
namespace {

using detail::TwoEnds;

constexpr std::size_t kLongestAnswer = 1 << 16;
constexpr std::size_t kMostComplaint = 1 << 12;
constexpr int kPatienceMs = 20;  ///< between two looks whether a program has ended

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Appends what can be read now; false at the end of the stream.
bool read_some(int fd, std::string& out) {
  std::array<char, 1 << 14> buffer;
  const ssize_t n = ::read(fd, buffer.data(), buffer.size());
  if (n < 0) return errno == EINTR || errno == EAGAIN;
  out.append(buffer.data(), static_cast<std::size_t>(n));
  return n > 0;
}

void keep_end(std::string& text, std::size_t most) {
  if (text.size() > most) text.erase(0, text.size() - most);
}

std::string with_complaint(std::string what, std::string_view said) {
  while (!said.empty() && (said.back() == '\n' || said.back() == '\r')) said.remove_suffix(1);
  const std::size_t begin = said.rfind('\n');
  if (begin != std::string_view::npos) said.remove_prefix(begin + 1);
  if (said.empty()) return what;
  return what + "; it says: " + shortened(printable(said), 160);
}

/// How it ended, in words; empty: with exit code 0.
std::string end_in_words(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) return "used up its processor time";
    return fmt::format("was ended by signal {} ({})", signal, ::strsignal(signal));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0)
    return fmt::format("ended with exit code {}", WEXITSTATUS(status));
  return {};
}

void require_start(const ChildProcess& child, const std::vector<std::string>& words) {
  if (child.error() == 0) return;
  throw ProgramFailed(
      fmt::format("{} cannot be run: {}", in_quotes(words.front()), std::strerror(child.error())));
}

}  // namespace

std::vector<std::string> split_command(std::string_view command, const std::string& place) {
  std::vector<std::string> words;
  bool inside = false;  // a word has begun
  char quote = 0;
  for (const char c : command) {
    if (quote != 0) {
      if (c == quote) {
        quote = 0;
      } else {
        words.back() += c;
      }
      continue;
    }
    if (c == ' ' || c == '\t' || c == '\n') {
      inside = false;
      continue;
    }
    if (!inside) words.emplace_back();
    inside = true;
    if (c == '\'' || c == '"') {
      quote = c;
    } else {
      words.back() += c;
    }
  }
  if (quote != 0)
    throw InputError(
        {place, 0, {}, fmt::format("got {}, in which a quote is not closed", in_quotes(command))});
  if (words.empty() || words.front().empty())
    throw InputError({place, 0, {}, "got nothing, expected a program and its arguments"});
  return words;
}

void run_to_end(const std::vector<std::string>& words, const ProgramLimits& limits) {
  TwoEnds out(false);
  ChildProcess child(words, {out.its(), out.its()}, limits.processor_seconds, limits.folder);
  require_start(child, words);
  out.close_its();
  const double deadline = seconds_now() + limits.seconds;
  std::string said;
  pollfd pipe{out.mine(), POLLIN, 0};
  while (!child.has_ended()) {
    if (seconds_now() > deadline) {
      static_cast<void>(child.end());
      throw ProgramFailed(with_complaint(fmt::format("did not end within {:.6g} s", limits.seconds), said));
    }
    if (::poll(&pipe, 1, kPatienceMs) > 0 && !read_some(out.mine(), said)) pipe.fd = -1;
    keep_end(said, kMostComplaint);
  }
  const std::string why = end_in_words(child.end());
  while (pipe.fd >= 0 && ::poll(&pipe, 1, 0) > 0 && read_some(out.mine(), said))
    keep_end(said, kMostComplaint);
  if (!why.empty()) throw ProgramFailed(with_complaint(why, said));
}

struct Conversation::Wires {
  explicit Wires(const std::vector<std::string>& words, const ProgramLimits& limits)
      : child(words, {line.its(), complaints.its(), -1, line.its()}, limits.processor_seconds,
              limits.folder) {
    line.close_its();
    complaints.close_its();
    err = complaints.mine();
  }
  detail::TwoEnds line{true};
  detail::TwoEnds complaints{false};
  ChildProcess child;
  std::string said;  ///< on standard error
  int err = -1;
};

Conversation::Conversation(const std::vector<std::string>& words, ProgramLimits limits)
    : wires_(nullptr), limits_(std::move(limits)) {
  auto wires = std::make_unique<Wires>(words, limits_);
  require_start(wires->child, words);
  wires_ = wires.release();
}

Conversation::~Conversation() { delete wires_; }

void Conversation::fail(const std::string& what) {
  const double deadline = seconds_now() + 1.0;
  while (closed_ && !wires_->child.has_ended() && seconds_now() < deadline) ::usleep(1000);
  const bool ended = wires_->child.has_ended();
  const std::string why = end_in_words(wires_->child.end());
  // What it complained of may still be on the way.
  pollfd pipe{wires_->err, POLLIN, 0};
  while (pipe.fd >= 0 && ::poll(&pipe, 1, 0) > 0 && read_some(pipe.fd, wires_->said))
    keep_end(wires_->said, kMostComplaint);
  throw ProgramFailed(with_complaint(ended && !why.empty() ? why : what, wires_->said));
}

void Conversation::listen(double deadline, bool to_write) {
  std::array<pollfd, 2> open{
      {{closed_ ? -1 : wires_->line.mine(), static_cast<short>(POLLIN | (to_write ? POLLOUT : 0)), 0},
       {wires_->err, POLLIN, 0}}};
  const double left = deadline - seconds_now();
  if (left <= 0.0)
    fail(fmt::format("did not answer within {:.6g} s", answered_ ? limits_.answer : limits_.first_answer));
  const int ready = ::poll(open.data(), open.size(), static_cast<int>(1e3 * left) + 1);
  if (ready < 0 && errno != EINTR) fail(fmt::format("waiting for it: {}", std::strerror(errno)));
  if (ready <= 0) return;
  if ((open[0].revents & (POLLIN | POLLHUP | POLLERR)) != 0 && !read_some(wires_->line.mine(), heard_))
    closed_ = true;
  if (open[1].revents != 0) {
    if (!read_some(wires_->err, wires_->said)) wires_->err = -1;
    keep_end(wires_->said, kMostComplaint);
  }
  if (heard_.size() > taken_ + kLongestAnswer) fail("said more than 64 KiB that were not asked for");
}

void Conversation::say(std::string_view lines) {
  const double deadline = seconds_now() + (answered_ ? limits_.answer : limits_.first_answer);
  while (!lines.empty()) {
    const ssize_t n = ::send(wires_->line.mine(), lines.data(), lines.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n > 0) {
      lines.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno == EAGAIN || errno == EINTR) {
      listen(deadline, true);
    } else {
      closed_ = true;
      fail("closed its input");
    }
  }
}

std::string_view Conversation::answer() {
  heard_.erase(0, taken_);
  taken_ = 0;
  const double deadline = seconds_now() + (answered_ ? limits_.answer : limits_.first_answer);
  std::size_t end = heard_.find('\n');
  while (end == std::string::npos) {
    if (closed_) fail("closed its output");
    listen(deadline, false);
    end = heard_.find('\n');
  }
  answered_ = true;
  taken_ = end + 1;
  std::string_view line = std::string_view(heard_).substr(0, end);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace stribeck::io
