#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/gcode/interpreter.hpp>
#include <stribeck/io/gcode/short_arcs.hpp>
#include <stribeck/io/process/child_process.hpp>
#include <string_view>

namespace stribeck::io {
namespace {

using Clock = std::chrono::steady_clock;

class Pipe {
 public:
  explicit Pipe(const std::string& program) {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw InputError({program, 0, {}, fmt::format("no pipe to the interpreter: {}", std::strerror(errno))});
  }
  ~Pipe() {
    close_read();
    close_write();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  [[nodiscard]] int read_end() const { return ends_[0]; }
  [[nodiscard]] int write_end() const { return ends_[1]; }
  void close_read() { shut(0); }
  void close_write() { shut(1); }

 private:
  void shut(std::size_t i) {
    if (ends_[i] >= 0) close(ends_[i]);
    ends_[i] = -1;
  }
  std::array<int, 2> ends_{-1, -1};
};

/// A table of tools without length and radius, in memory: nothing is left of it however this program ends.
class ToolTable {
 public:
  explicit ToolTable(const std::string& program) : file_(memfd_create("tools", MFD_CLOEXEC)) {
    std::string text;
    for (int i = 1; i <= kTools; ++i) text += fmt::format("T{} P{}\n", i, i);
    if (file_ >= 0 && write(file_, text.data(), text.size()) == static_cast<ssize_t>(text.size())) return;
    const int error = errno;
    if (file_ >= 0) close(file_);
    throw InputError(
        {program, 0, {}, fmt::format("no memory for the interpreter's tools: {}", std::strerror(error))});
  }
  ~ToolTable() { close(file_); }
  ToolTable(const ToolTable&) = delete;
  ToolTable& operator=(const ToolTable&) = delete;
  [[nodiscard]] int file() const { return file_; }
  /// As a process that has inherited it opens it.
  [[nodiscard]] std::string name() const { return fmt::format("/proc/self/fd/{}", file_); }

 private:
  static constexpr int kTools = 999;
  int file_;
};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// The message of the interpreter with the line of the program: it prints the line's text below the message.
Problem complaint(const std::string& file, std::string_view program, std::string_view said) {
  std::vector<std::string_view> words;
  for (const std::string_view line : lines_of(said)) {
    if (!trimmed(line).empty() && trimmed(line) != "executing") words.push_back(trimmed(line));
  }
  Problem problem{file, 0, {}, "the interpreter refuses it"};
  if (words.empty()) return problem;
  problem.message = std::string(words.front());
  const auto lines = lines_of(program);
  if (words.front().starts_with("File ended with no percent sign")) {
    problem.message += " (end the program with M2 or M30)";
    problem.line = lines.size();
    return problem;
  }
  if (words.size() < 2) return problem;
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (trimmed(lines[i]) == words[1]) found.push_back(i + 1);
  }
  problem.message += ", in " + in_quotes(words[1]);
  if (!found.empty()) problem.line = found.front();
  if (found.size() > 1) problem.message += fmt::format(" (or in line {}, which reads the same)", found[1]);
  return problem;
}

/// The text of the program; refused where it cannot be a program, which the interpreter would report less clearly.
std::string program_text(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::is_fifo(file, ignored)) {
    throw InputError(
        {file, 0, {}, "is a pipe, expected a file: it is read twice (write the program to a file first)"});
  }
  std::string program = read_text(file);
  if (trimmed(program).empty()) throw InputError({file, 0, {}, "is empty, expected a G-code program"});
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (program.starts_with(kByteOrderMark)) {
    throw InputError(
        {file, 1, {}, "begins with a byte order mark, expected G-code (save the program as plain text)"});
  }
  // For the interpreter a NUL ends a line: the rest would be lost without a message.
  const auto control = [](unsigned char c) { return (c < ' ' && (c < '\t' || c > '\r')) || c == 0x7f; };
  const auto found = std::find_if(program.begin(), program.end(), control);
  if (found == program.end()) return program;
  throw InputError({file,
                    static_cast<std::size_t>(std::count(program.begin(), found, '\n')) + 1,
                    {},
                    fmt::format("holds the byte {}, expected the text of a G-code program (is it "
                                "compressed, or no program?)",
                                static_cast<unsigned char>(*found))});
}

/// Whether G41, G42 or G43 occurs in the program: without length and radius they leave no trace in the calls.
bool takes_tool_offsets(std::string_view program) {
  for (const std::string_view line : lines_of(program)) {
    int number = -1;  // number behind a G; −1: not behind a G
    char inside = 0;  // character that ends the present comment or name
    for (const char c : line) {
      if (inside != 0) {
        if (c == inside) inside = 0;
        continue;
      }
      if (c == ';') break;
      if (c == ' ' || c == '\t' || c == '\r') continue;
      if (number >= 0 && c >= '0' && c <= '9') {
        number = std::min(10 * number + (c - '0'), 1000);
        continue;
      }
      // G41.1 and G43.1 contain their values.
      if (number >= 41 && number <= 43 && c != '.') return true;
      number = c == 'G' || c == 'g' ? 0 : -1;
      if (c == '(') inside = ')';
      if (c == '<') inside = '>';
    }
    if (number >= 41 && number <= 43) return true;
  }
  return false;
}

/// The path in a form that no program takes for an option.
std::string as_argument(const std::string& file) { return file.starts_with('-') ? "./" + file : file; }

/// What the interpreter prints, up to its end; refused where it is too long or takes too long.
class Listener {
 public:
  Listener(const std::string& file, const InterpreterOptions& options)
      : file_(file), options_(options), reader_(file), begin_(Clock::now()), heard_(begin_) {}

  /// Returns when both pipes have ended.
  void listen(int out, int err) {
    std::array<pollfd, 2> open{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
    std::array<char, 1 << 16> buffer;
    while (open[0].fd >= 0 || open[1].fd >= 0) {
      check_times();
      const int ready = poll(open.data(), open.size(), kPollMs);
      if (ready < 0 && errno != EINTR)
        refuse(fmt::format("waiting for the interpreter: {}", std::strerror(errno)));
      if (ready <= 0) continue;
      for (pollfd& pipe : open) {
        if (pipe.fd < 0 || pipe.revents == 0) continue;
        const ssize_t n = read(pipe.fd, buffer.data(), buffer.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
          pipe.fd = -1;
          continue;
        }
        heard_ = Clock::now();
        const std::string_view bytes(buffer.data(), static_cast<std::size_t>(n));
        if (&pipe == open.data()) {
          read_lines(bytes);
        } else {
          said_ += bytes;
          // What matters is said at the end.
          if (said_.size() > kMostSaid) said_.erase(0, said_.size() - kMostSaid);
        }
      }
    }
  }

  [[nodiscard]] const CanonicalReader& reader() const { return reader_; }
  [[nodiscard]] const std::string& said() const { return said_; }

 private:
  static constexpr std::size_t kLongestLine = 1 << 16;
  static constexpr std::size_t kMostSaid = 1 << 13;
  static constexpr std::size_t kMostStill =
      200000;  ///< lines without a motion; a program without end prints them in seconds
  static constexpr int kPollMs = 50;

  [[noreturn]] void refuse(std::string why) const { throw InputError({file_, 0, {}, std::move(why)}); }

  void check_times() const {
    const auto now = Clock::now();
    const auto since = [&](Clock::time_point then) {
      return std::chrono::duration<double>(now - then).count();
    };
    if (since(begin_) > options_.seconds) {
      refuse(fmt::format("the interpreter did not end within {:.6g} s (does the program loop without end?)",
                         options_.seconds));
    }
    if (since(heard_) > options_.silent_seconds) {
      refuse(fmt::format(
          "the interpreter has said nothing for {:.6g} s (does the program loop without end and motion?)",
          options_.silent_seconds));
    }
  }

  void read_lines(std::string_view bytes) {
    pending_ += bytes;
    std::size_t begin = 0;
    for (std::size_t end = pending_.find('\n'); end != std::string::npos; end = pending_.find('\n', begin)) {
      const std::size_t moves = reader_.moves().size();
      reader_.line(std::string_view(pending_).substr(begin, end - begin));
      begin = end + 1;
      still_ = reader_.moves().size() > moves ? 0 : still_ + 1;
      if (still_ > kMostStill) {
        refuse(fmt::format(
            "{} calls of the interpreter without a motion (does the program loop without end?)", kMostStill));
      }
    }
    pending_.erase(0, begin);
    if (pending_.size() > kLongestLine)
      refuse("the interpreter printed a line of more than 64 KiB, expected calls");
  }

  std::string file_;
  InterpreterOptions options_;
  CanonicalReader reader_;
  Clock::time_point begin_;
  Clock::time_point heard_;
  std::string pending_;
  std::string said_;
  std::size_t still_ = 0;
};

}  // namespace

PartProgram read_part_program(const std::string& file, const InterpreterOptions& options) {
  const std::string program = program_text(file);
  const ToolTable tools(file);
  const std::vector<std::string> words{options.command, "-g", "-t", tools.name(), as_argument(file)};

  Pipe out(file);
  Pipe err(file);
  ChildProcess child(words, {out.write_end(), err.write_end(), tools.file()}, options.seconds);
  if (child.error() != 0) {
    throw InputError(
        {file,
         0,
         {},
         fmt::format(
             "LinuxCNC's interpreter {} cannot be run: {} (it is in Debian's package linuxcnc-uspace: "
             "tools/install-dependencies --linuxcnc, or apt-get install linuxcnc-uspace)",
             words[0], std::strerror(child.error()))});
  }
  out.close_write();
  err.close_write();

  Listener listener(file, options);
  listener.listen(out.read_end(), err.read_end());
  const int status = child.wait();
  if (WIFSIGNALED(status)) {
    throw InputError({file,
                      0,
                      {},
                      WTERMSIG(status) == SIGXCPU
                          ? fmt::format("the interpreter took more than {:.6g} s of processor time (does the "
                                        "program loop without end?)",
                                        options.seconds)
                          : fmt::format("the interpreter was ended by signal {}", WTERMSIG(status))});
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw InputError(complaint(file, program, listener.said()));
  const CanonicalReader& reader = listener.reader();
  if (const auto arc = reader.once_around() ? arc_too_short_to_print(program) : std::nullopt) {
    throw InputError(
        {file,
         arc->line,
         {},
         fmt::format(
             "an arc ends {:.3g} of its unit from its start: the interpreter prints four decimals, in which it looks like "
             "a full circle (take the arc out{})",
             arc->distance, reader.inches() ? ", or write the program in millimetres, G21" : "")});
  }
  return {reader.moves(), reader.inches(), reader.tools() || takes_tool_offsets(program),
          reader.foreign_feed()};
}

}  // namespace stribeck::io
