#pragma once
/// A filter of first order through which a drive passed the force before it was logged.
///
///   τ·ḟ_logged + f_logged = f
///
/// Real time: no.

namespace stribeck::ident {

struct ForceFilter {
  double time = 0.0;        ///< τ [s]
  double half_width = 0.0;  ///< of 95 % [s]
};

}  // namespace stribeck::ident
