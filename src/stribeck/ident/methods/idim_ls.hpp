#pragma once
/// Inverse-model least squares of an axis (IDIM-LS), as the robotics literature publishes it.
///
///   f = M·a + Fv·v + Fc·sgn v + offset                                   or, with friction by direction,
///   f = M·a + Fv⁺·v⁺ + Fc⁺·[v>0] + Fv⁻·v⁻ − Fc⁻·[v<0]                    v± = v where v ≷ 0, else 0
///
/// The protocol, step by step: x passes a Butterworth low-pass forward and backward; v and a are two central differences with
/// one-sided ends; the first rows are dropped; every regressor and the force are decimated (filter.hpp); ordinary least squares.
/// `published` holds what papers print: deviations std(e)·√diag((XᵀX)⁻¹) for white residuals, the norm of the error, its ratio to
/// the norm of the force, std(e), the condition of X. The residuals are not white: the intervals in `result` hold for correlated
/// ones and are usually several times wider.
///
/// Source: Janot, Gautier, Brunot, Data Set and Reference Models of EMPS, Workshop on Nonlinear System
/// Identification Benchmarks 2019; Gautier, Janot, Vandanjon 2013, doi:10.1109/TCST.2012.2185697.
/// Not modelled: Stribeck rise, pre-sliding. In closed loop, noise that comes back through the controller biases the estimate;
/// velocity_map.hpp removes this bias with instruments. Real time: no.
/// Errors: Refused.

#include <stribeck/ident/log/record.hpp>
#include <stribeck/ident/result.hpp>

namespace stribeck::ident::methods {

struct IdimOptions {
  double cut_off = 100.0;  ///< of the Butterworth low-pass [Hz]
  int order = 4;           ///< of the Butterworth low-pass
  std::size_t drop = 49;   ///< rows dropped at the start
  std::size_t decimation = 10;
  bool by_direction = false;  ///< separate friction for each direction
};

struct IdimResult {
  struct Published {
    std::vector<double> value;      ///< in the order of the law above, SI
    std::vector<double> deviation;  ///< SI
    double error_norm = 0.0;        ///< [N]
    double relative_error = 0.0;    ///< [-]
    double error_deviation = 0.0;   ///< [N]
    double condition = 0.0;
    std::size_t rows = 0;
  };
  Published published;
  Result result;
};

IdimResult identify_idim_ls(const log::Record& record, const IdimOptions& options = {});

}  // namespace stribeck::ident::methods
