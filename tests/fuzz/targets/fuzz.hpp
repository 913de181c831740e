#pragma once
/// What a fuzz target gives: where it starts from, and what happens with one input. driver.cpp runs it with its own mutations;
/// linked with clang's libFuzzer in place of that, the same file is a target of libFuzzer (tests/fuzz/CMakeLists.txt).

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace stribeck::fuzz {

/// Good inputs, from the samples and examples of the repository.
std::vector<std::string> seeds();

/// Words of the format, put in at random places.
std::vector<std::string> words();

/// Ends the program where the input brings out what must not be.
void one(std::string_view input);

inline void demand(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "fuzz: %s\n", what);
  std::abort();
}

/// A file of the repository.
inline std::string file_of(const std::string& path) {
  std::ifstream in(std::string(STRIBECK_SOURCE_DIR) + "/" + path, std::ios::binary);
  demand(in.good(), path.c_str());
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A byte that chooses what is done with the rest; 0 where there is none.
inline std::uint8_t mode_of(std::string_view& input) {
  if (input.empty()) return 0;
  const auto mode = static_cast<std::uint8_t>(input.front());
  input.remove_prefix(1);
  return mode;
}

}  // namespace stribeck::fuzz
