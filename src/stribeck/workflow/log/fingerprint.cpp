#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <numeric>

#include <stribeck/workflow/log/fingerprint.hpp>

namespace stribeck::workflow {
namespace {

constexpr std::size_t kRows = 8;      // in sequence make one hash
constexpr std::uint64_t kOneIn = 16;  // hashes that are kept
constexpr std::size_t kFewest = 10;   // fewer tell nothing
constexpr double kNearlyAll = 0.9;    // of the hashes: the ends of two exports may differ by a few rows

/// Of Stafford's variants of the mixer of MurmurHash3 the thirteenth: every bit of the input changes half of the bits.
std::uint64_t mixed(std::uint64_t h) {
  h = (h ^ (h >> 30U)) * 0xBF58476D1CE4E5B9U;
  h = (h ^ (h >> 27U)) * 0x94D049BB133111EBU;
  return h ^ (h >> 31U);
}

}  // namespace

Fingerprint::Fingerprint(const std::vector<ident::log::Record>& records) {
  for (const ident::log::Record& r : records) add(r.x, r.f);
}

void Fingerprint::add(const std::vector<double>& x, const std::vector<double>& f) {
  const std::size_t n = std::min(x.size(), f.size());
  for (std::size_t k = 0; k + kRows <= n; ++k) {
    // An axis that stands has the same rows in every log.
    if (x[k] == x[k + kRows - 1]) continue;
    std::uint64_t hash = 0;
    for (std::size_t i = k; i < k + kRows; ++i)
      hash = mixed(mixed(hash ^ std::bit_cast<std::uint64_t>(x[i])) ^ std::bit_cast<std::uint64_t>(f[i]));
    if (hash % kOneIn == 0) kept_.push_back(hash);
  }
  std::sort(kept_.begin(), kept_.end());
  kept_.erase(std::unique(kept_.begin(), kept_.end()), kept_.end());
}

bool Fingerprint::within(const Fingerprint& other) const {
  if (kept_.size() < kFewest) return false;
  const auto shared = std::count_if(kept_.begin(), kept_.end(), [&](std::uint64_t h) {
    return std::binary_search(other.kept_.begin(), other.kept_.end(), h);
  });
  return static_cast<double>(shared) >= kNearlyAll * static_cast<double>(kept_.size());
}

std::vector<std::optional<std::size_t>> holders_of(const std::vector<Fingerprint>& prints) {
  std::vector<std::size_t> order(prints.size()), kept;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return prints[a].size() > prints[b].size(); });
  std::vector<std::optional<std::size_t>> out(prints.size());
  for (const std::size_t i : order) {
    const auto holder =
        std::find_if(kept.begin(), kept.end(), [&](std::size_t k) { return prints[i].within(prints[k]); });
    if (holder != kept.end()) {
      out[i] = *holder;
    } else {
      kept.push_back(i);
    }
  }
  return out;
}

std::string copy_note(const std::string& copy, const std::string& of) {
  return fmt::format("{} holds the same rows as {}: it is left out, because a copy tells nothing new", copy,
                     of);
}

}  // namespace stribeck::workflow
