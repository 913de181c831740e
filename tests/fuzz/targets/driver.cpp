// Runs a fuzz target: good inputs, changed at random in a process of its own, so that a crash is seen from outside.
//
//   log_fuzz [--runs N | --seconds S] [--seed S] [FILE...]
//
// Input k of a seed is always the same. One that crashes, hangs for 20 s or takes 2 GB is written to TARGET-SEED-K; give its name to
// repeat it.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <random>
#include <tests/fuzz/targets/fuzz.hpp>

namespace stribeck::fuzz {
namespace {

constexpr unsigned kHang = 20;             // [s]
constexpr long kMostMemory = 2L << 20;     // [KiB]
constexpr std::size_t kBatch = 250;        // inputs in one process
constexpr std::size_t kLongest = 1 << 16;  // [B]

constexpr const char* kNumbers[] = {
    "0", "-0", "1", "1e999", "-1e308", "5e-324", "nan", "inf", "1e-9", "0.001", "9223372036854775808"};

class Inputs {
 public:
  explicit Inputs(std::uint64_t seed) : seed_(seed), seeds_(seeds()), words_(words()) {
    demand(!seeds_.empty(), "no seeds");
    for (const char* w : kNumbers) words_.emplace_back(w);
    for (const char* w : {"\"",
                          "'",
                          "\\",
                          "[",
                          "]",
                          "{",
                          "}",
                          "(",
                          ")",
                          "#",
                          ";",
                          ",",
                          "=",
                          "\n",
                          "\r\n",
                          "\t",
                          "\xff",
                          "\xc2\x9b",
                          "\xe2\x80\xae",
                          "%s%n"})
      words_.emplace_back(w);
    words_.emplace_back(1, '\0');
  }

  [[nodiscard]] std::string at(std::uint64_t k) const {
    std::seed_seq both{static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32),
                       static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(k >> 32)};
    std::mt19937_64 random(both);
    std::string text = seeds_[random() % seeds_.size()];
    for (std::uint64_t n = 1 + random() % 8; n > 0; --n) change(text, random);
    if (text.size() > kLongest) text.resize(kLongest);
    return text;
  }

 private:
  void change(std::string& text, std::mt19937_64& random) const {
    const auto below = [&](std::size_t n) {
      return static_cast<std::size_t>(random() % std::max<std::size_t>(n, 1));
    };
    const std::size_t at = below(text.size() + 1);
    const std::size_t n = 1 + below(1 + below(40));
    switch (random() % 8) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(random());
        break;
      case 1:
        if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << (random() % 8)));
        break;
      case 2:
        if (at < text.size()) text.erase(at, n);
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), n));
        break;
      case 4:
        text.insert(at, words_[below(words_.size())]);
        break;
      case 5: {
        const std::string& other = seeds_[below(seeds_.size())];
        text = text.substr(0, at) + other.substr(below(other.size()));
        break;
      }
      case 6: {  // a line out, twice, or elsewhere
        const std::size_t begin = text.rfind('\n', at == 0 ? 0 : at - 1);
        const std::size_t from = begin == std::string::npos ? 0 : begin + 1;
        const std::size_t end = std::min(text.find('\n', from), text.size() - (text.empty() ? 0 : 1));
        const std::string line = text.substr(from, end + 1 - from);
        if (random() % 2 == 0) text.erase(from, line.size());
        if (random() % 2 == 0) text.insert(below(text.size() + 1), line);
        break;
      }
      default: {  // a number
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const std::size_t end = std::min(text.find_first_not_of("0123456789.eE+-", digit), text.size());
        text.replace(digit, end - digit, kNumbers[below(std::size(kNumbers))]);
        break;
      }
    }
  }

  std::uint64_t seed_;
  std::vector<std::string> seeds_;
  std::vector<std::string> words_;
};

/// Whether inputs first to last - 1 go through in a process of their own.
bool go_through(const Inputs& inputs, std::uint64_t first, std::uint64_t last) {
  const pid_t child = fork();
  if (child == 0) {
    for (std::uint64_t k = first; k < last; ++k) {
      alarm(kHang);
      one(inputs.at(k));
    }
    _exit(0);
  }
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && used.ru_maxrss < kMostMemory) return true;
  if (last - first == 1) {
    std::fprintf(stderr, "fuzz: %s%d, %ld MiB\n", WIFSIGNALED(status) ? "signal " : "exit code ",
                 WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status), used.ru_maxrss >> 10);
  }
  return false;
}

std::string base_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

int run(int argc, char** argv) {
  std::uint64_t runs = 1000;
  double seconds = 0.0;
  std::uint64_t seed = 1;
  bool files = false;
  for (int i = 1; i < argc; ++i) {
    const auto is = [&](const char* name) { return std::strcmp(argv[i], name) == 0 && i + 1 < argc; };
    if (is("--runs")) {
      runs = std::strtoull(argv[++i], nullptr, 10);
    } else if (is("--seconds")) {
      seconds = std::strtod(argv[++i], nullptr);
    } else if (is("--seed")) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else {
      std::ifstream in(argv[i], std::ios::binary);
      demand(in.good(), "usage: TARGET [--runs N | --seconds S] [--seed S] [FILE...]");
      one(std::string(std::istreambuf_iterator<char>(in), {}));
      files = true;
    }
  }
  if (files) return 0;
  for (const std::string& good : seeds()) one(good);
  const Inputs inputs(seed);
  const auto begin = std::chrono::steady_clock::now();
  const auto since = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  std::uint64_t k = 0;
  for (; seconds > 0.0 ? since() < seconds : k < runs; k += kBatch) {
    if (go_through(inputs, k, k + kBatch)) continue;
    for (std::uint64_t bad = k; bad < k + kBatch; ++bad) {
      if (go_through(inputs, bad, bad + 1)) continue;
      const std::string name = base_name(argv[0]) + "-" + std::to_string(seed) + "-" + std::to_string(bad);
      std::ofstream(name, std::ios::binary) << inputs.at(bad);
      std::fprintf(stderr, "fuzz: %s fails on input %llu of seed %llu, which is in %s\n", argv[0],
                   static_cast<unsigned long long>(bad), static_cast<unsigned long long>(seed), name.c_str());
      return 1;
    }
    std::fprintf(stderr, "fuzz: inputs %llu to %llu of seed %llu fail together, none alone\n",
                 static_cast<unsigned long long>(k), static_cast<unsigned long long>(k + kBatch - 1),
                 static_cast<unsigned long long>(seed));
    return 1;
  }
  std::printf("%s: %llu inputs of seed %llu in %.1f s\n", base_name(argv[0]).c_str(),
              static_cast<unsigned long long>(k), static_cast<unsigned long long>(seed), since());
  return 0;
}

}  // namespace
}  // namespace stribeck::fuzz

int main(int argc, char** argv) { return stribeck::fuzz::run(argc, argv); }
