#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <stribeck/io/error.hpp>
#include <stribeck/report/plot/gnuplot.hpp>
#include <stribeck/report/text.hpp>
#include <system_error>
#include <utility>

extern char** environ;  // POSIX requires this declaration

namespace stribeck::report {
namespace {

[[noreturn]] void fail(std::string message) {
  throw io::InputError(io::Problem{"", 0, "", std::move(message)});
}

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// A file without a name: nothing is left behind in any case.
File nameless_file() {
  File file(std::tmpfile(), std::fclose);
  if (file == nullptr)
    fail("plots need room for a temporary file: " + std::generic_category().message(errno));
  ::fcntl(::fileno(file.get()), F_SETFD, FD_CLOEXEC);
  return file;
}

std::string last_line(std::FILE* file) {
  std::rewind(file);
  std::array<char, 4096> buffer{};
  std::string text;
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), file)) > 0;)
    text.append(buffer.data(), n);
  text.erase(text.find_last_not_of(" \t\r\n") + 1);
  return clean_text(text.substr(text.find_last_of('\n') + 1));
}

}  // namespace

std::string run_gnuplot(const std::string& script) {
  const File input = nameless_file();
  const File errors = nameless_file();
  if (std::fwrite(script.data(), 1, script.size(), input.get()) != script.size() ||
      std::fflush(input.get()) != 0) {
    fail("plots need room for a temporary file: " + std::generic_category().message(errno));
  }
  std::rewind(input.get());
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0)
    fail("gnuplot cannot be started: " + std::generic_category().message(errno));

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(input.get()), 0);
  posix_spawn_file_actions_adddup2(&actions, pipe[1], 1);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(errors.get()), 2);
  // -d: do not read settings of the user. From a file the script is read in blocks; from standard input it would be read byte by
  // byte.
  std::array<std::string, 3> words{"gnuplot", "-d", "/dev/stdin"};
  std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
  pid_t child = -1;
  const int error = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(pipe[1]);
  if (error != 0) {
    ::close(pipe[0]);
    if (error == ENOENT || error == EACCES || error == ENOTDIR) {
      fail(
          "reports need the program gnuplot, which was not found (install it, on Debian: apt install "
          "gnuplot-nox)");
    }
    fail("gnuplot cannot be started: " + std::generic_category().message(error));
  }

  std::string output;
  std::array<char, 65536> buffer{};
  while (true) {
    const ssize_t n = ::read(pipe[0], buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    output.append(buffer.data(), static_cast<std::size_t>(n));
  }
  ::close(pipe[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    const std::string said = last_line(errors.get());
    fail("gnuplot could not draw the report" + (said.empty() ? "" : ": " + said) +
         " (version 5.4 is known to work)");
  }
  return output;
}

}  // namespace stribeck::report
