#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
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
#include <string_view>

extern char** environ;

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

/// A table of tools without length and radius, deleted with this object.
class ToolTable {
 public:
  explicit ToolTable(const std::string& program) {
    std::error_code ignored;
    name_ = (std::filesystem::temp_directory_path(ignored) / "stribeck-tools-XXXXXX").string();
    const int file = mkostemp(name_.data(), O_CLOEXEC);
    if (file < 0) {
      const int error = errno;
      throw InputError(
          {program,
           0,
           {},
           fmt::format("no temporary file {} for the interpreter's tools: {}", name_, std::strerror(error))});
    }
    std::string text;
    for (int i = 1; i <= kTools; ++i) text += fmt::format("T{} P{}\n", i, i);
    const bool written = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    close(file);
    if (written) return;
    unlink(name_.c_str());
    throw InputError({program, 0, {}, fmt::format("temporary file {}: cannot be written", name_)});
  }
  ~ToolTable() { unlink(name_.c_str()); }
  ToolTable(const ToolTable&) = delete;
  ToolTable& operator=(const ToolTable&) = delete;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  static constexpr int kTools = 999;
  std::string name_;
};

/// A process group, ended with this object.
class Child {
 public:
  Child(const std::vector<std::string>& words, const std::string& program, int out, int err) {
    std::vector<char*> argv;
    for (const std::string& w : words) argv.push_back(const_cast<char*>(w.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int error = posix_spawnp(&id_, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error == 0) return;
    id_ = -1;
    throw InputError(
        {program,
         0,
         {},
         fmt::format(
             "LinuxCNC's interpreter {} cannot be run: {} (it is in Debian's package linuxcnc-uspace: "
             "tools/install-dependencies --linuxcnc, or apt-get install linuxcnc-uspace)",
             words[0], std::strerror(error))});
  }
  ~Child() {
    if (id_ <= 0) return;
    kill(-id_, SIGKILL);
    static_cast<void>(wait());
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Its status as returned by waitpid.
  int wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
    return status;
  }

 private:
  pid_t id_ = -1;
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
  if (words.front().starts_with("File ended with no percent sign"))
    problem.message += " (end the program with M2 or M30)";
  if (words.size() < 2) return problem;
  std::vector<std::size_t> found;
  const auto lines = lines_of(program);
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

}  // namespace

PartProgram read_part_program(const std::string& file, const InterpreterOptions& options) {
  constexpr std::size_t kLongestLine = 1 << 16;
  constexpr std::size_t kMostSaid = 1 << 13;
  const std::string program = program_text(file);
  const ToolTable tools(file);
  const std::vector<std::string> words{options.command, "-g", "-t", tools.name(), as_argument(file)};

  Pipe out(file);
  Pipe err(file);
  Child child(words, file, out.write_end(), err.write_end());
  out.close_write();
  err.close_write();

  CanonicalReader reader(file);
  std::string pending;
  std::string said;
  const auto read_lines = [&](std::string_view bytes) {
    pending += bytes;
    std::size_t begin = 0;
    for (std::size_t end = pending.find('\n'); end != std::string::npos; end = pending.find('\n', begin)) {
      reader.line(std::string_view(pending).substr(begin, end - begin));
      begin = end + 1;
    }
    pending.erase(0, begin);
    if (pending.size() > kLongestLine)
      throw InputError({file, 0, {}, "the interpreter printed a line of more than 64 KiB, expected calls"});
  };
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(options.seconds));
  std::array<pollfd, 2> open{{{out.read_end(), POLLIN, 0}, {err.read_end(), POLLIN, 0}}};
  std::array<char, 1 << 16> buffer;
  while (open[0].fd >= 0 || open[1].fd >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) {
      throw InputError({file,
                        0,
                        {},
                        fmt::format("the interpreter did not end within {:.6g} s (does the program loop "
                                    "without end?)",
                                    options.seconds)});
    }
    const int ready = poll(open.data(), open.size(), static_cast<int>(std::min<long long>(left, 1000)));
    if (ready < 0 && errno != EINTR)
      throw InputError({file, 0, {}, fmt::format("waiting for the interpreter: {}", std::strerror(errno))});
    if (ready <= 0) continue;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (open[i].fd < 0 || open[i].revents == 0) continue;
      const ssize_t n = read(open[i].fd, buffer.data(), buffer.size());
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        open[i].fd = -1;
        continue;
      }
      const std::string_view bytes(buffer.data(), static_cast<std::size_t>(n));
      if (i == 0) {
        read_lines(bytes);
      } else {
        said += bytes;
        // The important lines of the output are the last ones.
        if (said.size() > kMostSaid) said.erase(0, said.size() - kMostSaid);
      }
    }
  }
  const int status = child.wait();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    if (WIFSIGNALED(status))
      throw InputError(
          {file, 0, {}, fmt::format("the interpreter was ended by signal {}", WTERMSIG(status))});
    throw InputError(complaint(file, program, said));
  }
  return {reader.moves(), reader.inches(), reader.tools() || takes_tool_offsets(program),
          reader.foreign_feed()};
}

}  // namespace stribeck::io
