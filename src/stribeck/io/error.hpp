#pragma once
/// Problems with the input of a user, one line each:
///
///   FILE:LINE: key: got VALUE, expected WHAT (WAY OUT)
///
/// Unknown parts are left out. A reader collects all Problems before it throws them as one InputError; its what() is the first
/// line and the number of further ones. Paths are shown as the user gave them.
/// Real time: no.

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::io {

struct Problem {
  std::string file;
  std::size_t line = 0;  ///< counted from 1; 0: not known
  std::string key;
  std::string message;

  /// The text in one line, without control characters; long names and messages lose their middle.
  [[nodiscard]] std::string text() const;
};

class InputError : public std::runtime_error {
 public:
  explicit InputError(Problem problem);
  /// Needs at least one problem.
  explicit InputError(std::vector<Problem> problems);

  [[nodiscard]] const std::vector<Problem>& problems() const noexcept { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// Collects the problems of one file.
class Problems {
 public:
  explicit Problems(std::string file = {}) : file_(std::move(file)) {}

  void add(std::size_t line, std::string key, std::string message) {
    all_.push_back({file_, line, std::move(key), std::move(message)});
  }
  [[nodiscard]] bool empty() const noexcept { return all_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return all_.size(); }
  [[nodiscard]] const std::vector<Problem>& all() const noexcept { return all_; }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }

  /// Throws InputError with all problems in the order of their lines; nothing when there are none.
  void throw_if_any() const;

 private:
  std::string file_;
  std::vector<Problem> all_;
};

/// A value as messages show it: in quotes, without control characters, cut when long.
std::string in_quotes(std::string_view value);

/// The candidate nearest to a mistyped word, or "" when none is near.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace stribeck::io
