#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <stribeck/io/process/child_process.hpp>

namespace stribeck::io {
namespace {

/// In the child, where only functions that are safe in signal handlers may be called. Returns the error of what failed.
int become(char* const* argv, const ChildProcess::Files& files, pid_t parent, rlim_t processor_seconds,
           const char* folder) {
  if (::setpgid(0, 0) != 0 || ::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return errno;
  // The parent may have ended before.
  if (::getppid() != parent) return ESRCH;
  rlimit limit{};
  if (::getrlimit(RLIMIT_CPU, &limit) != 0) return errno;
  // A limit of the user's may be lower.
  if (limit.rlim_cur > processor_seconds) limit.rlim_cur = processor_seconds;
  if (::setrlimit(RLIMIT_CPU, &limit) != 0) return errno;
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  ::sigaction(SIGPIPE, &usual, nullptr);
  if (*folder != '\0' && ::chdir(folder) != 0) return errno;
  const int in = files.in >= 0 ? files.in : ::open("/dev/null", O_RDONLY);
  if (in < 0 || ::dup2(in, STDIN_FILENO) < 0 || ::dup2(files.out, STDOUT_FILENO) < 0 ||
      ::dup2(files.err, STDERR_FILENO) < 0 ||
      (files.inherited >= 0 && ::fcntl(files.inherited, F_SETFD, 0) != 0)) {
    return errno;
  }
  ::execvp(argv[0], argv);
  return errno;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words, const Files& files,
                           double processor_seconds, const std::string& folder) {
  std::vector<char*> argv;
  for (const std::string& w : words) argv.push_back(const_cast<char*>(w.c_str()));
  argv.push_back(nullptr);
  // Closed by a program that begins, or holds the error of one that does not.
  std::array<int, 2> said{};
  if (::pipe2(said.data(), O_CLOEXEC) != 0) {
    error_ = errno;
    return;
  }
  const auto limit = static_cast<rlim_t>(std::ceil(processor_seconds));
  const pid_t parent = ::getpid();
  id_ = ::fork();
  if (id_ == 0) {
    const int error = become(argv.data(), files, parent, limit, folder.c_str());
    const ssize_t ignored = ::write(said[1], &error, sizeof error);
    ::_exit(ignored == sizeof error ? 127 : 126);
  }
  if (id_ < 0) error_ = errno;
  ::close(said[1]);
  int error = 0;
  ssize_t n = 0;
  while (id_ > 0 && (n = ::read(said[0], &error, sizeof error)) < 0 && errno == EINTR) {
  }
  ::close(said[0]);
  if (n != sizeof error) return;
  static_cast<void>(wait());
  error_ = error;
}

ChildProcess::~ChildProcess() {
  if (id_ > 0) static_cast<void>(end());
}

bool ChildProcess::has_ended() const {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid != 0;
}

int ChildProcess::end() {
  ::kill(-id_, SIGKILL);
  return wait();
}

int ChildProcess::wait() {
  int status = 0;
  pid_t ended = -1;
  do ended = ::waitpid(id_, &status, 0);
  while (ended < 0 && errno == EINTR);
  id_ = -1;
  // A program that ignores SIGCHLD is not told how its children end.
  return ended < 0 ? -1 : status;
}

}  // namespace stribeck::io
