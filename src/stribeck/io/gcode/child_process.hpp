#pragma once
/// Another program, run with its output in pipes. It does not outlive this one, however this one ends.
///
/// It is a process group of its own, which the kernel ends when the thread that began it ends (PR_SET_PDEATHSIG of Linux), and has a
/// limit of processor time. What it begins itself ends with it only where this object is destroyed.
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
  };

  /// The first word is looked for in PATH. error() tells whether it runs.
  ChildProcess(const std::vector<std::string>& words, const Files& files, double processor_seconds);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// 0, or why it could not be run.
  [[nodiscard]] int error() const noexcept { return error_; }
  /// Its status, as of waitpid.
  int wait();

 private:
  pid_t id_ = -1;
  int error_ = 0;
};

}  // namespace stribeck::io
