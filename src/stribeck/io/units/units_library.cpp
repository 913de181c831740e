// The units library behind io/units.hpp.
#include <locale.h>
#include <udunits2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stribeck/core/scalar.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/units/unit_text.hpp>
#include <stribeck/io/units/units_library.hpp>
#include <utility>

namespace stribeck::io::detail {

namespace {

constexpr double kRevolution = 2.0 * kPi;  // [rad]

struct FreeUnit {
  void operator()(ut_unit* u) const noexcept { ut_free(u); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;

[[noreturn]] void fail_unit(std::string message) { throw InputError(Problem{"", 0, "", std::move(message)}); }

/// Numbers have a decimal point in this thread as long as it lives: the units library reads its database and "2.5 mm" in the locale of
/// the program.
class PointLocale {
 public:
  PointLocale() : before_(uselocale(point())) {}
  ~PointLocale() { uselocale(before_); }
  PointLocale(const PointLocale&) = delete;
  PointLocale& operator=(const PointLocale&) = delete;

 private:
  static locale_t point() {
    static const locale_t made = newlocale(LC_ALL_MASK, "C", nullptr);
    return made;
  }
  locale_t before_;
};

/// The units system. udunits2 keeps state while it parses, so every call locks the mutex.
class Units {
 public:
  static Units& instance() {
    static Units units;  // a failed construction is tried again at the next call
    return units;
  }

  bool known(std::string_view text) {
    const std::lock_guard lock(mutex_);
    const PointLocale point;
    return !without_blanks(text).empty() && parse(text) != nullptr;
  }

  UnitAnswer find(std::string_view from, std::string_view to) {
    const std::lock_guard lock(mutex_);
    const PointLocale point;
    auto key = std::pair{std::string(from), std::string(to)};
    if (const auto hit = cache_.find(key); hit != cache_.end()) return hit->second;
    // Texts come from files; the limit keeps a hostile one from filling the memory.
    if (cache_.size() > 4096) cache_.clear();
    return cache_.emplace(std::move(key), find_uncached(from, to)).first->second;
  }

 private:
  Units() {
    const PointLocale point;
    ut_set_error_message_handler(ut_ignore);
    system_ = ut_read_xml(nullptr);
    if (system_ == nullptr) {
      fail_unit(
          "the database of the units library was not found (install libudunits2-data, or set "
          "UDUNITS2_XML_PATH to its udunits2.xml)");
    }
    radian_ = Unit(ut_get_unit_by_name(system_, "radian"));
    const Unit revolution(ut_scale(kRevolution, radian_.get()));
    for (const auto& [symbol, definition] : {std::pair{"deg", "arc_degree"},
                                             {"Grad", "arc_degree"},
                                             {"Nm", "N m"},
                                             {"pct", "0.01"},
                                             {"Arms", "A"},
                                             {"Aeff", "A"},
                                             {"ipm", "in/min"},
                                             {"IPM", "in/min"},
                                             {"lbs", "lb"}}) {
      const Unit unit(ut_parse(system_, definition, UT_UTF8));
      if (unit != nullptr) ut_map_symbol_to_unit(symbol, UT_ASCII, unit.get());
    }
    // CiA 402 gives torques in thousandths of the rated one.
    const Unit permille(ut_parse(system_, "0.001", UT_UTF8));
    for (const char* symbol : {"permille", "promille"})
      ut_map_symbol_to_unit(symbol, UT_ASCII, permille.get());
    for (const char* symbol : {"rev", "U"}) ut_map_symbol_to_unit(symbol, UT_ASCII, revolution.get());
  }
  ~Units() {
    radian_.reset();
    ut_free_system(system_);
  }

  Unit parse(std::string_view text) {
    const std::string unit = readable_unit(text);
    return unit.empty() && !without_blanks(text).empty() ? nullptr
                                                         : Unit(ut_parse(system_, unit.c_str(), UT_UTF8));
  }

  UnitAnswer find_uncached(std::string_view from, std::string_view to) {
    const Unit target = parse(to);
    if (target == nullptr)
      fail_unit("unit " + in_quotes(to) + " of the program is not known to the units library");
    const Unit source = parse(from);
    if (source == nullptr) return {UnitVerdict::kUnknownUnit};
    const bool hertz = from.find("Hz") != std::string_view::npos && to.find("Hz") == std::string_view::npos;
    const auto found = convert(source.get(), target.get());
    if (!found || hertz || radians(source.get()) != radians(target.get()))
      return {UnitVerdict::kWrongDimension};
    return {UnitVerdict::kGood, *found};
  }

  static std::optional<Conversion> convert(ut_unit* from, ut_unit* to) {
    if (ut_are_convertible(from, to) == 0) return std::nullopt;
    const std::unique_ptr<cv_converter, void (*)(cv_converter*)> f(ut_get_converter(from, to), cv_free);
    if (f == nullptr) return std::nullopt;
    const auto value = [&](double x) { return cv_convert_double(f.get(), x); };
    const double factor = value(1.0);
    constexpr double kRounding = 1e-14;
    if (!(factor > 0.0) || !std::isfinite(factor) || value(0.0) != 0.0 ||
        std::abs(value(2.0) / (2.0 * factor) - 1.0) > kRounding) {
      return std::nullopt;
    }
    return conversion_by(factor);
  }

  /// Power of the radian inside a unit.
  [[nodiscard]] int radians(const ut_unit* unit) const {
    struct Count {
      const ut_unit* radian;
      const ut_visitor* visitor;
      int power;
    };
    ut_visitor visitor{};
    visitor.visit_basic = [](const ut_unit* u, void* arg) {
      auto& count = *static_cast<Count*>(arg);
      if (ut_compare(u, count.radian) == 0) count.power += 1;
      return UT_SUCCESS;
    };
    visitor.visit_product = [](const ut_unit*, int n, const ut_unit* const* basic, const int* powers,
                               void* arg) {
      auto& count = *static_cast<Count*>(arg);
      for (int i = 0; i < n; ++i) {
        if (ut_compare(basic[i], count.radian) == 0) count.power += powers[i];
      }
      return UT_SUCCESS;
    };
    visitor.visit_galilean = [](const ut_unit*, double, const ut_unit* underlying, double, void* arg) {
      return ut_accept_visitor(underlying, static_cast<Count*>(arg)->visitor, arg);
    };
    visitor.visit_timestamp = [](const ut_unit*, const ut_unit*, double, void*) { return UT_SUCCESS; };
    visitor.visit_logarithmic = [](const ut_unit*, double, const ut_unit*, void*) { return UT_SUCCESS; };
    Count count{radian_.get(), &visitor, 0};
    ut_accept_visitor(unit, &visitor, &count);
    return count.power;
  }

  std::mutex mutex_;
  ut_system* system_ = nullptr;
  Unit radian_;
  std::map<std::pair<std::string, std::string>, UnitAnswer> cache_;
};

}  // namespace

UnitAnswer find_unit(std::string_view from, std::string_view to) { return Units::instance().find(from, to); }

bool known_unit(std::string_view text) { return Units::instance().known(text); }

}  // namespace stribeck::io::detail
