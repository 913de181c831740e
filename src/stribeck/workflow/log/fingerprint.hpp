#pragma once
/// Tells whether two logs hold the same recording: a copy of a file, or one axis exported alone and with the others.
///
/// A copy tells nothing new. Taken for a second recording it makes intervals too narrow, and a model that is verified on it is verified
/// on itself. The numbers of a few rows in sequence, position and force, make a hash; of all hashes of a log one in some is kept, by
/// its value, so that a part of a recording is found wherever it begins.
///
/// Not told: a recording that was exported with other digits, in other units or at another rate.
/// Real time: no.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stribeck/ident/log/record.hpp>
#include <string>
#include <vector>

namespace stribeck::workflow {

class Fingerprint {
 public:
  Fingerprint() = default;
  explicit Fingerprint(const std::vector<ident::log::Record>& records);
  /// Adds a run of rows; x [m] and f in any unit, of the same length.
  void add(const std::vector<double>& x, const std::vector<double>& f);
  /// Whether nearly all rows of this log are in the other one too.
  [[nodiscard]] bool within(const Fingerprint& other) const;
  [[nodiscard]] std::size_t size() const { return kept_.size(); }

 private:
  std::vector<std::uint64_t> kept_;  ///< ascending, each once
};

/// For each log that another one holds, the number of that one; the longest log stays, of equal ones the first.
std::vector<std::optional<std::size_t>> holders_of(const std::vector<Fingerprint>& prints);

/// Says that a log is left out because another one holds the same rows.
std::string copy_note(const std::string& copy, const std::string& of);

}  // namespace stribeck::workflow
