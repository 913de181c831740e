#include <cmath>

#include <stribeck/io/error.hpp>
#include <stribeck/workflow/log/converted.hpp>

namespace stribeck::workflow {
namespace {

/// Values [k] → [row(k)] of a column.
template <class Row>
std::vector<double> convert(const io::Column& column, const io::Conversion& c, double factor,
                            std::size_t count, Row&& row) {
  std::vector<double> out(count);
  // The divisor is taken out of the loop: the same value as c(x), without a power per sample.
  const double divisor = c.decimal && c.power < 0 ? std::pow(10.0, -c.power) : 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double value = column.values[row(k)];
    out[k] = (divisor > 0.0 ? value / divisor : value * c.factor) * factor;
  }
  return out;
}

}  // namespace

std::optional<io::Conversion> conversion_between(const std::string& unit, std::string_view si) {
  if (unit.empty()) return std::nullopt;
  try {
    return io::conversion(unit, si);
  } catch (const io::InputError&) {
    return std::nullopt;
  }
}

std::vector<double> converted(const io::Column& column, const io::Conversion& conversion, double factor) {
  return convert(column, conversion, factor, column.values.size(), [](std::size_t k) { return k; });
}

std::vector<double> converted(const io::Column& column, const io::Conversion& conversion, double factor,
                              const std::vector<std::size_t>& rows) {
  return convert(column, conversion, factor, rows.size(), [&](std::size_t k) { return rows[k]; });
}

}  // namespace stribeck::workflow
