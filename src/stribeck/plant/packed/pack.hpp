#pragma once
/// Several numbers at a time, as a Real scalar (core/scalar.hpp): the laws run on it as they run on double, and every lane gets the
/// bits that double would get. Functions beyond arithmetic are called lane by lane for that reason.
///
/// Arch is an instruction set of xsimd. It is part of every name here: files that are compiled for different instruction sets
/// share no function.
/// Real time: safe.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stribeck/core/scalar.hpp>
#include <type_traits>
#include <xsimd/xsimd.hpp>

namespace stribeck::plant {

template <class Arch>
class Pack {
 public:
  using Batch = xsimd::batch<double, Arch>;
  using Mask = xsimd::batch_bool<double, Arch>;
  using Integers = xsimd::batch<std::int64_t, Arch>;
  using Unsigned = xsimd::batch<std::uint64_t, Arch>;
  static constexpr std::size_t kLanes = Batch::size;

  Pack() : v_(0.0) {}
  explicit Pack(double x) : v_(x) {}
  explicit Pack(const Batch& v) : v_(v) {}
  static Pack load(const double* from) { return Pack(Batch::load_unaligned(from)); }
  void store(double* to) const { v_.store_unaligned(to); }

  [[nodiscard]] Integers bits() const { return xsimd::bitwise_cast<Integers>(v_); }
  template <class Bits>
  static Pack of_bits(const Bits& bits) {
    return Pack(xsimd::bitwise_cast<Batch>(bits));
  }
  /// The bits without the lowest n, moved to the right.
  [[nodiscard]] Unsigned high_bits(int n) const { return xsimd::bitwise_cast<Unsigned>(v_) >> n; }
  /// from[index] in each lane. xsimd 8 takes the lanes one by one here, also where the processor has an instruction for it.
  static Pack gather(const double* from, const Integers& index) {
#ifdef __AVX512F__
    if constexpr (std::is_base_of_v<xsimd::avx512f, Arch>)
      return Pack(Batch(_mm512_i64gather_pd(index, from, sizeof(double))));
#endif
#ifdef __AVX2__
    if constexpr (std::is_base_of_v<xsimd::avx2, Arch>)
      return Pack(Batch(_mm256_i64gather_pd(from, index, sizeof(double))));
#endif
    return Pack(Batch::gather(from, index));
  }

  friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.v_ + b.v_); }
  friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.v_ - b.v_); }
  friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.v_ * b.v_); }
  friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v_ / b.v_); }
  friend Pack operator-(const Pack& a) { return Pack(a.v_ ^ Batch(-0.0)); }  // of zero too
  friend Mask operator<(const Pack& a, const Pack& b) { return a.v_ < b.v_; }
  friend Mask operator>(const Pack& a, const Pack& b) { return a.v_ > b.v_; }
  friend Mask operator>=(const Pack& a, const Pack& b) { return a.v_ >= b.v_; }

  friend Pack select(const Mask& where, const Pack& a, const Pack& b) {
    return Pack(xsimd::select(where, a.v_, b.v_));
  }
  friend bool any(const Mask& where) { return xsimd::any(where); }
  friend Pack abs(const Pack& a) { return Pack(xsimd::abs(a.v_)); }
  /// A value that select() discards is often far below the smallest number, where exp is slow.
  friend Pack exp(const Pack& a) {
    return a.each([](double x) { return x < -746.0 ? 0.0 : std::exp(x); });
  }
  friend Pack sin(const Pack& a) {
    return a.each([](double x) { return std::sin(x); });
  }
  friend Pack cos(const Pack& a) {
    return a.each([](double x) { return std::cos(x); });
  }

 private:
  template <class F>
  Pack each(F f) const {
    alignas(64) double x[kLanes];
    store(x);
    for (double& lane : x) lane = f(lane);
    return load(x);
  }

  Batch v_;
};

/// Lane by lane: integers where the mask holds, else others.
template <class Arch>
typename Pack<Arch>::Integers select_integers(const typename Pack<Arch>::Mask& where,
                                              const typename Pack<Arch>::Integers& a,
                                              const typename Pack<Arch>::Integers& b) {
  return select(where, Pack<Arch>::of_bits(a), Pack<Arch>::of_bits(b)).bits();
}

}  // namespace stribeck::plant
