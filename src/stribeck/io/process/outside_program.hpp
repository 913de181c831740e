#pragma once
/// Programs of other people, which may crash, hang, flood or lie: every call ends within its limits, and nothing of theirs is left
/// running.
///
///   run_to_end(words, limits)     a program that reads and writes files
///   Conversation                  a program that answers lines on standard output to lines on standard input
///
/// A command line is split at blanks, with '…' and "…" for words that hold some; no shell is started. Times are those of the clock on
/// the wall, with a limit of processor time beside them. The group of the program is killed at the end (child_process.hpp).
/// Real time: no.
/// Errors: ProgramFailed, with the last line that the program wrote on standard error; InputError for a command line.

#include <stdexcept>
#include <stribeck/io/process/child_process.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io {

struct ProgramFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct ProgramLimits {
  double seconds = 60.0;       ///< of a program that runs to its end
  double first_answer = 20.0;  ///< until it answers for the first time [s]
  double answer = 5.0;         ///< until each later one [s]
  double processor_seconds = 120.0;
  std::string folder{};  ///< in which it runs; empty: that of this program
};

/// The words of a command line. `place`: option or key, for messages.
std::vector<std::string> split_command(std::string_view command, const std::string& place);

/// Runs a program and waits for exit code 0. What it prints is read and dropped.
void run_to_end(const std::vector<std::string>& words, const ProgramLimits& limits);

class Conversation {
 public:
  Conversation(const std::vector<std::string>& words, ProgramLimits limits);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /// Sends lines, the last one with its line feed.
  void say(std::string_view lines);
  /// The next line that it says, without the line feed; valid until the next call.
  std::string_view answer();

 private:
  struct Wires;

  [[noreturn]] void fail(const std::string& what);
  /// Waits until it can be written to or has said something; reads all that is there.
  void listen(double deadline, bool to_write);

  Wires* wires_;
  ProgramLimits limits_;
  std::string heard_;
  std::size_t taken_ = 0;
  bool answered_ = false;
  bool closed_ = false;
};

}  // namespace stribeck::io
