#pragma once
/// Notes and warnings about several logs of one axis, each of them once.

#include <string>
#include <vector>

namespace stribeck::report {

/// Notes that begin with "LOG: " of one of `logs` and are the same but for that stand once, behind the names of their logs, where the
/// first of them stood. From five logs on, two are named and the others counted. A note that stands twice word by word stands once.
/// All others stay as they are.
[[nodiscard]] std::vector<std::string> said_once(const std::vector<std::string>& notes,
                                                 const std::vector<std::string>& logs);

}  // namespace stribeck::report
