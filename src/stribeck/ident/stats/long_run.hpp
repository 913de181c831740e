#pragma once
/// Covariance of a sum of vectors that are correlated in time, from block sums.
///
///   S = Γ0 + Σ_{l=1..L} w_l·(Γl + Γlᵀ)      Γl = Σ_b s_b·s_{b−l}ᵀ      s_b = sum of the vectors of block b
///   w_l = 1 up to L/2, then falling in a straight line to 0 beyond L
///
/// A block is a fixed number of rows of one record. Rows that were left out count as zero and keep their place in time, so that
/// correlation across a gap is neither lost nor invented. Records are not correlated with each other. The flat top removes
/// the downward bias of Bartlett's weights; the price is that a variance may by chance be negative, which callers must
/// handle.
///
/// Source: Newey, West 1987, doi:10.2307/1913610; flat top: Politis, Romano 1995,
/// doi:10.1111/j.1467-9892.1995.tb00223.x.
/// Not modelled: correlation beyond L blocks.
/// Real time: no.

#include <cstddef>
#include <vector>

namespace stribeck::ident::stats {

/// How long residuals of consecutive rows stay correlated.
struct Memory {
  double rows = 0.5;      ///< integrated correlation ½ + Σρ [rows]
  std::size_t block = 1;  ///< rows of a block
  std::size_t lags = 1;   ///< L
};

/// e[i] is the residual of row `at[i]` of record `record[i]`; rows ascend.
Memory memory_of(const std::vector<double>& e, const std::vector<int>& record,
                 const std::vector<std::size_t>& at);

class LongRun {
 public:
  LongRun(std::size_t dimension, const Memory& memory) : dimension_(dimension), memory_(memory) {}

  /// Adds the vector of one row; rows of a record ascend, records follow each other.
  double* row(int record, std::size_t at);

  /// Row-major dimension × dimension.
  [[nodiscard]] std::vector<double> covariance() const;

 private:
  struct Block {
    int record;
    std::size_t number;
  };
  std::size_t dimension_;
  Memory memory_;
  std::vector<Block> blocks_;
  std::vector<double> sums_;
};

}  // namespace stribeck::ident::stats
