#pragma once
/// The exception of this module.
/// Real time: no.

#include <stdexcept>

namespace stribeck::ident {

/// The data cannot give the answer that was asked for; what() says why and what would help.
struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace stribeck::ident
