#include <fmt/format.h>
#include <bit>
#include <cmath>
#include <cstddef>
#include <stribeck/io/file.hpp>
#include <stribeck/io/sha256.hpp>

namespace stribeck::io {
namespace {

constexpr std::size_t kBlock = 64;  // bytes
constexpr std::size_t kRounds = 64;

/// The first 32 bits of the fractional parts of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, kRounds> kRoots{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

using State = std::array<std::uint32_t, 8>;

void take_in(State& state, const unsigned char* block) {
  std::array<std::uint32_t, kRounds> w{};
  for (std::size_t i = 0; i < 16; ++i) {
    for (std::size_t k = 0; k < 4; ++k) w[i] = (w[i] << 8) | block[4 * i + k];
  }
  for (std::size_t i = 16; i < kRounds; ++i) {
    const std::uint32_t far = w[i - 15];
    const std::uint32_t near = w[i - 2];
    w[i] = w[i - 16] + (std::rotr(far, 7) ^ std::rotr(far, 18) ^ (far >> 3)) + w[i - 7] +
           (std::rotr(near, 17) ^ std::rotr(near, 19) ^ (near >> 10));
  }
  // Eight rounds a turn: the eight words keep their places, and only their names go round.
  auto [a, b, c, d, e, f, g, h] = state;
  const auto turn = [&](const std::uint32_t& p, const std::uint32_t& q, const std::uint32_t& r,
                        std::uint32_t& t, const std::uint32_t& u, const std::uint32_t& v,
                        const std::uint32_t& x, std::uint32_t& y, std::size_t i) {
    y += (std::rotr(u, 6) ^ std::rotr(u, 11) ^ std::rotr(u, 25)) + ((u & v) ^ (~u & x)) + kRoots[i] + w[i];
    t += y;
    y += (std::rotr(p, 2) ^ std::rotr(p, 13) ^ std::rotr(p, 22)) + ((p & q) ^ (p & r) ^ (q & r));
  };
  for (std::size_t i = 0; i < kRounds; i += 8) {
    turn(a, b, c, d, e, f, g, h, i);
    turn(h, a, b, c, d, e, f, g, i + 1);
    turn(g, h, a, b, c, d, e, f, i + 2);
    turn(f, g, h, a, b, c, d, e, i + 3);
    turn(e, f, g, h, a, b, c, d, i + 4);
    turn(d, e, f, g, h, a, b, c, i + 5);
    turn(c, d, e, f, g, h, a, b, i + 6);
    turn(b, c, d, e, f, g, h, a, i + 7);
  }
  const State s{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < state.size(); ++i) state[i] += s[i];
}

}  // namespace

Digest sha256(std::string_view bytes) {
  State state{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  std::size_t at = 0;
  for (; at + kBlock <= bytes.size(); at += kBlock) take_in(state, data + at);
  // The rest, a one, zeros, and the length in bits.
  std::array<unsigned char, 2 * kBlock> last{};
  const std::size_t rest = bytes.size() - at;
  for (std::size_t i = 0; i < rest; ++i) last[i] = data[at + i];
  last[rest] = 0x80;
  const std::size_t size = rest + 9 <= kBlock ? kBlock : 2 * kBlock;
  const std::uint64_t bits = 8 * static_cast<std::uint64_t>(bytes.size());
  for (std::size_t k = 0; k < 8; ++k) last[size - 1 - k] = static_cast<unsigned char>(bits >> (8 * k));
  for (std::size_t k = 0; k < size; k += kBlock) take_in(state, last.data() + k);
  Digest digest{};
  for (std::size_t i = 0; i < digest.size(); ++i)
    digest[i] = static_cast<std::uint8_t>(state[i / 4] >> (8 * (3 - i % 4)));
  return digest;
}

std::string hexadecimal(const Digest& digest) {
  std::string out;
  for (const std::uint8_t byte : digest) out += fmt::format("{:02x}", byte);
  return out;
}

std::string base64(const Digest& digest) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < digest.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = (three << 8) | (i + k < digest.size() ? digest[i + k] : std::uint8_t{0});
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= digest.size() ? kLetters[(three >> (6 * (3 - k))) & 63U] : '=';
  }
  return out;
}

std::string sha256_of_file(const std::string& path) { return hexadecimal(sha256(read_text(path))); }

}  // namespace stribeck::io
