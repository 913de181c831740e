#pragma once
/// For a command that takes long and goes on after it was killed.
/// Real time: no. Errors: none.

namespace stribeck::io {

/// While it lives, write_atomically() gives every file its name at once, also inside a WriteTogether, for the thread that made it.
class WriteAtOnce {
 public:
  WriteAtOnce() noexcept;
  ~WriteAtOnce();
  WriteAtOnce(const WriteAtOnce&) = delete;
  WriteAtOnce& operator=(const WriteAtOnce&) = delete;

 private:
  bool before_;
};

}  // namespace stribeck::io
