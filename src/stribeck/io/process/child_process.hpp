#pragma once
/// Runs another program with its output in pipes. That program ends when this one ends, for any reason.
///
/// The kernel kills it when the thread that started it ends (PR_SET_PDEATHSIG of Linux). It has a process group of its own and a limit of
/// processor time. Processes that it starts itself stay in that group; they end in end(), or if
/// this object is destroyed before wait(). A process that leaves the group on purpose is not found.
/// Real time: no.

#include <sys/types.h>

#include <string>
#include <vector>

namespace stribeck::io {

class ChildProcess {
 public:
  struct Files {
    int out = -1;        ///< its standard output
    int err = -1;        ///< its standard error
    int inherited = -1;  ///< stays open under the same number
    int in = -1;         ///< its standard input; -1: nothing to read
  };

  /// The first word is searched in PATH. It runs in `folder`; empty: in that of this program. error() tells whether the program runs.
  ChildProcess(const std::vector<std::string>& words, const Files& files, double processor_seconds,
               const std::string& folder = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// 0, or the reason why it could not be run.
  [[nodiscard]] int error() const noexcept { return error_; }
  /// Its status, as of waitpid.
  int wait();
  /// Whether it has ended; the status stays with wait() and end().
  [[nodiscard]] bool has_ended() const;
  /// Kills what is left of its group, and returns its status.
  int end();

 private:
  pid_t id_ = -1;
  int error_ = 0;
};

}  // namespace stribeck::io
