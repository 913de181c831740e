#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stribeck/core/walk_fields.hpp>
#include <stribeck/io/units.hpp>
#include <stribeck/report/text.hpp>
#include <stribeck/workflow/study/factors.hpp>
#include <stribeck/workflow/study/uncertain_models.hpp>

namespace stribeck::workflow {
namespace {

using plant::AxisParams;
using Words = std::vector<std::string_view>;

constexpr std::array<std::string_view, 4> kOfFriction{"friction", "friction.coulomb", "friction.viscous",
                                                      "friction.stiffness"};

/// The level and the viscous part of a map, each by its own factor.
friction::Conventional<double> scaled(const friction::Conventional<double>& map, double level,
                                      double viscous) {
  friction::Conventional<double> m = map.scaled(level);
  m.alpha2 = map.alpha2 * viscous;
  return m;
}
friction::Gaussian<double> scaled(const friction::Gaussian<double>& map, double level, double viscous) {
  friction::Gaussian<double> m = map.scaled(level);
  m.positive.eta1 = map.positive.eta1 * viscous;
  m.negative.eta1 = map.negative.eta1 * viscous;
  return m;
}

void scale_friction(AxisParams& p, double level, double viscous) {
  std::visit([&](auto& map) { map = scaled(map, level, viscous); }, p.friction.steady);
  for (auto& term : p.friction.eccentric) {
    if (term.form == friction::EccentricForm::kProportional) term.amplitude *= level;
  }
}

/// Whether the name is one of the four; then it has acted.
bool scale_part(AxisParams& p, std::string_view below, double factor) {
  if (below == kOfFriction[0]) {
    scale_friction(p, factor, factor);
  } else if (below == kOfFriction[1]) {
    scale_friction(p, factor, 1.0);
  } else if (below == kOfFriction[2]) {
    scale_friction(p, 1.0, factor);
  } else if (below == kOfFriction[3]) {
    std::visit([&](auto& law) { law = law.stiffened(factor); }, p.friction.dynamics);
  } else {
    return false;
  }
  return true;
}

/// A number of the plant.
struct Place {
  Target target;
  Quantity quantity;
};

/// Where a key leads: a place, or what is wrong.
struct Found {
  std::optional<Place> place;
  std::string wrong;
};

/// "name[2]" → name and 2; 0 without brackets, SIZE_MAX where they hold no number.
std::pair<std::string_view, std::size_t> item_of(std::string_view word) {
  const std::size_t open = word.find('[');
  if (open == std::string_view::npos) return {word, 0};
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t n = 0;
  const std::string_view digits = word.substr(open + 1, word.size() - open - 2);
  if (word.back() != ']' || digits.empty() || digits.size() > 4) return {word.substr(0, open), kNone};
  for (const char c : digits) {
    if (c < '0' || c > '9') return {word.substr(0, open), kNone};
    n = 10 * n + static_cast<std::size_t>(c - '0');
  }
  return {word.substr(0, open), n == 0 ? kNone : n};
}

/// Through optionals and variants to what can be named.
std::optional<Target> opened(Target t) {
  while (t.kind() == Kind::kOptional || t.kind() == Kind::kVariant) {
    if (t.kind() == Kind::kVariant) {
      t = t.chosen();
    } else if (t.size() == 0) {
      return {};
    } else {
      t = t[0];
    }
  }
  return t;
}

Found unknown(const Target& group, std::string_view word, bool top) {
  Words names;
  for_each_member(group, [&](const TargetMember& m) { names.push_back(m.info.name); });
  if (top) names.insert(names.end(), kOfFriction.begin() + 1, kOfFriction.end());
  const std::string_view near = io::nearest(word, names);
  std::vector<std::string> listed(names.begin(), names.end());
  return {{},
          fmt::format("{} is no key there ({})", io::in_quotes(word),
                      near.empty() ? "known: " + report::joined(listed, ", ")
                                   : "meant " + io::in_quotes(near) + "?")};
}

Found find(AxisParams& plant, std::string_view below) {
  Target at = target_of(plant);
  Quantity quantity{};
  std::string path;
  while (!below.empty()) {
    const std::size_t dot = std::min(below.find('.'), below.size());
    const auto [name, item] = item_of(below.substr(0, dot));
    const auto whole = below;
    below.remove_prefix(std::min(dot + 1, below.size()));
    if (at.kind() != Kind::kGroup)
      return {{}, fmt::format("{} is a value, expected the end of the key there", io::in_quotes(path))};
    std::optional<Target> next;
    for_each_member(at, [&, wanted = name](const TargetMember& m) {
      if (m.info.name != wanted) return;
      next = m.value;
      quantity = m.info.quantity;
    });
    if (!next) return unknown(at, path.empty() ? whole : name, path.empty());
    path += (path.empty() ? "" : ".") + std::string(name);
    next = opened(*next);
    if (!next)
      return {{}, fmt::format("the machine file has no {}, which is a factor of it", io::in_quotes(path))};
    if (next->kind() == Kind::kList) {
      if (item == 0 || item > next->size())
        return {{}, fmt::format("{} has {} items, expected one of them, as {}[1]", path, next->size(), path)};
      next = opened((*next)[item - 1]);
    } else if (item != 0) {
      return {{}, fmt::format("{} is no list, expected no brackets", io::in_quotes(path))};
    }
    at = *next;
  }
  if (at.kind() != Kind::kNumber && at.kind() != Kind::kCount)
    return {{}, "expected the key of a number (this one holds a table, a word or a switch)"};
  return {Place{at, quantity}, {}};
}

std::string number_words(double si, const Quantity& q) {
  return q.unit.empty() ? io::number_text(si) : io::from_si(si, q);
}

/// The quantity of a key on an axis that turns: an angle for a length.
Quantity of_axis(const Quantity& linear, bool rotary, std::string_view text = "") {
  return rotary ? io::rotary_quantity(linear, text).value_or(linear) : linear;
}

// ---- distributions of a file in SI

/// Texts become numbers of this quantity.
class InSi {
 public:
  InSi(const Quantity& quantity, bool rotary) : quantity_(quantity), rotary_(rotary) {
    // Ranges are checked for the whole distribution, in whose message the key stands.
    quantity_.min = -std::numeric_limits<double>::infinity();
    quantity_.max = std::numeric_limits<double>::infinity();
    quantity_.min_excluded = false;
  }
  [[nodiscard]] double operator()(double x) const { return x; }
  [[nodiscard]] double operator()(const std::string& text) const {
    return io::to_si(text, of_axis(quantity_, rotary_, text));
  }
  template <class T>
  [[nodiscard]] std::optional<double> operator()(const std::optional<T>& x) const {
    return x ? std::optional<double>((*this)(*x)) : std::nullopt;
  }

  template <class T>
  sim::Distribution of(const sim::Uniform<T>& d) const {
    return sim::Uniform<double>{(*this)(d.low), (*this)(d.high)};
  }
  template <class T>
  sim::Distribution of(const sim::LogUniform<T>& d) const {
    return sim::LogUniform<double>{(*this)(d.low), (*this)(d.high)};
  }
  template <class T>
  sim::Distribution of(const sim::Normal<T>& d) const {
    return sim::Normal<double>{(*this)(d.mean), (*this)(d.sd), (*this)(d.low), (*this)(d.high)};
  }
  template <class T>
  sim::Distribution of(const sim::LogNormal<T>& d) const {
    return sim::LogNormal<double>{(*this)(d.median), d.sigma, (*this)(d.low), (*this)(d.high)};
  }
  template <class T>
  sim::Distribution of(const sim::ListOf<T>& d) const {
    sim::ListOf<double> list;
    for (const T& x : d.values) list.values.push_back((*this)(x));
    return list;
  }
  template <class T>
  sim::Distribution of(const sim::Steps<T>& d) const {
    return sim::Steps<double>{(*this)(d.low), (*this)(d.high), d.points};
  }

 private:
  Quantity quantity_;
  bool rotary_;
};

// ---- binding

/// Lines of the file for messages.
std::size_t line_of(const io::Node* table, std::string_view key) {
  if (table == nullptr) return 0;
  const io::Node* const child = table->find(key);
  return child == nullptr ? table->line : child->line;
}

/// Binds one factor; a problem is thrown as a text.
class Binder {
 public:
  Binder(const sim::Machine& nominal, const std::vector<std::size_t>& moved)
      : nominal_(nominal), moved_(moved) {}

  BoundFactor operator()(const StudyFactor& f) const {
    BoundFactor b;
    b.key = f.key;
    b.is_scale = f.scale.has_value();
    find_axes(f.key, b);
    const bool part = std::find(kOfFriction.begin(), kOfFriction.end(), b.below) != kOfFriction.end();
    if (b.below == "drive" || b.below.starts_with("drive."))
      fail("a drive cannot be a factor: the simulated loop converts forces with its true gain");
    Quantity quantity = pure_number();
    if (part) {
      if (!b.is_scale)
        fail("has many values, expected scale in place of value (or the key of a single number)");
    } else {
      AxisParams plant = nominal_.axes[b.axes.front()].second.plant;
      quantity = number(plant, b.below).quantity;
    }
    const bool rotary = nominal_.axes[b.axes.front()].second.rotary;
    for (const std::size_t i : b.axes) {
      if (nominal_.axes[i].second.rotary != rotary && !b.is_scale && io::rotary_quantity(quantity, ""))
        fail(
            "has one unit on the axes that turn and another on the others (give each axis a factor of its own)");
    }
    b.distribution = f.scale ? in_si(*f.scale, pure_number(), false) : in_si(*f.value, quantity, rotary);
    quantity = of_axis(quantity, rotary);
    if (std::string wrong = sim::problem(b.distribution); !wrong.empty())
      fail((f.scale ? "scale." : "value.") + wrong);
    if (!b.is_scale && !quantity.unit.empty()) {
      b.unit = io::shown_unit(sim::support(b.distribution)[1], quantity);
      b.to_unit = 1.0 / io::unit_factor(b.unit, quantity.unit);
    }
    for (const std::size_t i : b.axes) check_range(b, i, part);
    return b;
  }

  [[noreturn]] static void fail(const std::string& what) {
    throw io::InputError(io::Problem{{}, 0, {}, what});
  }

  void find_axes(std::string_view key, BoundFactor& b) const {
    const std::size_t dot = key.find('.');
    const std::string_view axis = key.substr(0, dot);
    std::vector<std::string> names;
    for (const std::size_t i : moved_) names.push_back(nominal_.axes[i].first);
    for (std::size_t k = 0; k < moved_.size(); ++k) {
      if (axis == "*" || axis == names[k]) b.axes.push_back(moved_[k]);
    }
    if (b.axes.empty() || dot == std::string_view::npos || dot + 1 == key.size()) {
      fail(fmt::format("got {}, expected AXIS.KEY with one of the axes that move, {}, or *, e.g. {}.friction",
                       io::in_quotes(key), report::listed(names), names.front()));
    }
    b.below = key.substr(dot + 1);
  }

 private:
  static Place number(AxisParams& plant, std::string_view below) {
    Found found = find(plant, below);
    if (!found.place) fail(found.wrong);
    return *found.place;
  }

  template <class T>
  static sim::Distribution in_si(const sim::AnyDistribution<T>& d, const Quantity& quantity, bool rotary) {
    return std::visit([&](const auto& one) { return InSi(quantity, rotary).of(one); }, d);
  }

  /// Everything that is drawn must be permitted for the key, on each axis.
  void check_range(const BoundFactor& b, std::size_t axis, bool part) const {
    const auto [low, high] = sim::support(b.distribution);
    if (part) {
      if (!(low > 0.0)) fail(fmt::format("scale reaches {:.6g}, expected above 0 (set its low)", low));
      return;
    }
    AxisParams plant = nominal_.axes[axis].second.plant;
    const Place place = number(plant, b.below);
    const Quantity shown = of_axis(place.quantity, nominal_.axes[axis].second.rotary);
    const double nominal = Value(place.target).number();
    const bool count = place.target.kind() == Kind::kCount;
    if (b.is_scale && count)
      fail("takes whole numbers, expected value with a list of them in place of scale");
    if (b.is_scale && nominal == 0.0)
      fail(fmt::format("is 0 on axis {}, which no scale changes (give value)", nominal_.axes[axis].first));
    for (const double end : {low, high}) {
      const double x = b.is_scale ? end * nominal : end;
      if (place.quantity.permits(x)) continue;
      fail(fmt::format("{} reaches {} on axis {}, expected {}{}", b.is_scale ? "scale" : "value",
                       number_words(x, shown), nominal_.axes[axis].first, io::range_text(shown),
                       end == low ? " (set its low)" : " (set its high)"));
    }
    if (!count) return;
    const std::uint64_t n = sim::number_of_values(b.distribution);
    bool whole = n > 0 && n <= 10000;
    for (std::uint64_t i = 0; i < n && whole; ++i) {
      const double x = sim::value_number(b.distribution, i);
      whole = x == std::round(x);
    }
    if (!whole) fail("takes whole numbers, expected kind = \"list\" or \"steps\" with whole numbers");
  }

  const sim::Machine& nominal_;
  const std::vector<std::size_t>& moved_;
};

}  // namespace

std::string BoundFactor::head() const {
  if (is_scale) return key + " (scale)";
  return unit.empty() ? key : fmt::format("{} [{}]", key, unit);
}

namespace {

/// What a deviation changes: mass, level and so on, for v > 0 and v < 0.
std::string changes_in_words(const friction::ModelDeviation& d) {
  std::vector<std::string> parts;
  const auto add = [&](const char* what, double x, const char* unit) {
    if (x != 0.0) parts.push_back(fmt::format("{} {:+.3g} {}", what, x, unit));
  };
  const auto add_both = [&](const char* what, const std::array<double, 2>& x, double scale,
                            const char* unit) {
    if (x[0] != 0.0 || x[1] != 0.0)
      parts.push_back(fmt::format("{} {:+.3g} and {:+.3g} {}", what, scale * x[0], scale * x[1], unit));
  };
  add("mass", d.mass, "kg");
  add_both("level", d.level, 1.0, "N");
  add_both("viscous", d.viscous, 1e-3, "N s/mm");
  add_both("rise", d.rise, 1.0, "N");
  add("stiffness", 100.0 * std::expm1(d.stiffness), "%");
  add("damping", 100.0 * std::expm1(d.damping), "%");
  return parts.empty() ? "nothing" : report::joined(parts, ", ");
}

}  // namespace

std::string BoundFactor::in_words() const {
  if (deviation) return "standard deviations, each " + changes_in_words(*deviation);
  const auto number = [&](double si) { return report::short_number(shown(si)); };
  const std::string after = unit.empty() ? std::string() : ' ' + report::printed_unit(unit);
  const auto [low, high] = sim::support(distribution);
  const std::string before = is_scale ? "scale, " : "";
  const std::string range = fmt::format("{} to {}{}", number(low), number(high), after);
  std::string words = fmt::format(
      "{}, {}",
      report::clean_text(std::visit(
          [](const auto& d) { return std::string(std::decay_t<decltype(d)>::kKind); }, distribution)),
      range);
  if (const auto* n = std::get_if<sim::Normal<double>>(&distribution)) {
    words = fmt::format("normal, mean {}{}, sd {}{}, within {}", number(n->mean), after, number(n->sd), after,
                        range);
  } else if (const auto* l = std::get_if<sim::LogNormal<double>>(&distribution)) {
    words = fmt::format("log-normal, median {}{}, sigma {}, within {}", number(l->median), after,
                        report::short_number(l->sigma), range);
  } else if (const std::uint64_t count = sim::number_of_values(distribution); count > 0) {
    words = fmt::format("{} values, {}", count, range);
  }
  return before + words;
}

std::vector<BoundFactor> bind_factors(const StudyFile& study, const io::Node& node, const std::string& file,
                                      const sim::Machine& nominal, const std::vector<std::size_t>& moved,
                                      const std::vector<KnownAxis>& known) {
  const Binder binder(nominal, moved);
  io::Problems problems(file);
  // Before all others: they scale the values of the models.
  std::vector<BoundFactor> open;
  std::vector<bool> taken(nominal.axes.size());
  std::vector<BoundFactor> all;
  const io::Node* const list = node.find("factors");
  const auto table_of = [&](std::size_t i) -> const io::Node* {
    return list != nullptr && i < list->children.size() ? &list->children[i] : nullptr;
  };
  const auto place_of = [](std::size_t i) { return fmt::format("factors[{}]", i + 1); };
  for (std::size_t i = 0; i < study.factors.size(); ++i) {
    const StudyFactor& f = study.factors[i];
    if (!f.is_uncertainty()) continue;
    try {
      if (study.sampling == sim::Sampling::kGrid)
        Binder::fail("a grid has no place for an uncertainty (choose another sampling)");
      BoundFactor group;
      binder.find_axes(f.key, group);
      for (BoundFactor& one : deviations_as_factors(nominal, group.axes, known)) {
        const std::size_t axis = one.axes.front();
        if (one.below == "uncertainty.1" && taken[axis])
          Binder::fail(fmt::format("the uncertainty of axis {} is a factor already, expected it once",
                                   nominal.axes[axis].first));
        taken[axis] = true;
        open.push_back(std::move(one));
      }
    } catch (const io::InputError& e) {
      problems.add(line_of(table_of(i), "key"), place_of(i),
                   io::in_quotes(f.key) + ": " + e.problems().front().message);
    }
  }
  problems.throw_if_any();
  for (std::size_t i = 0; i < study.factors.size(); ++i) {
    const StudyFactor& f = study.factors[i];
    if (f.is_uncertainty()) continue;
    const io::Node* const table = table_of(i);
    const std::string place = place_of(i);
    const auto same = [&](const StudyFactor& other) { return other.key == f.key; };
    const auto end = study.factors.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find_if(study.factors.begin(), end, same) != end) {
      problems.add(line_of(table, "key"), place,
                   fmt::format("{} is a factor already, expected each key once", io::in_quotes(f.key)));
      continue;
    }
    try {
      all.push_back(binder(f));
      if (study.sampling == sim::Sampling::kGrid && sim::number_of_values(all.back().distribution) == 0)
        Binder::fail("a grid needs kind = \"list\" or \"steps\" (or choose another sampling)");
    } catch (const io::InputError& e) {
      const char* const at = f.scale ? "scale" : "value";
      problems.add(line_of(table, at), place, io::in_quotes(f.key) + ": " + e.problems().front().message);
    }
  }
  problems.throw_if_any();
  all.insert(all.begin(), std::make_move_iterator(open.begin()), std::make_move_iterator(open.end()));
  return all;
}

sim::Machine with_values(const sim::Machine& nominal, const std::vector<BoundFactor>& factors,
                         const std::vector<double>& values) {
  sim::Machine m = nominal;
  for (auto& [name, axis] : m.axes) {
    // The data on the name plates stay the same, whatever the machine is like.
    const sim::NamePlate plate = axis.name_plate();
    axis.limits.force = plate.force;
    axis.commissioning.encoder_resolution = plate.encoder_resolution;
  }
  deviate_models(m, factors, values);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    if (factors[i].deviation) continue;
    for (const std::size_t axis : factors[i].axes) {
      AxisParams& plant = m.axes[axis].second.plant;
      if (scale_part(plant, factors[i].below, values[i])) continue;
      const Place place = *find(plant, factors[i].below).place;
      place.target.set(factors[i].is_scale ? values[i] * Value(place.target).number() : values[i]);
    }
  }
  return m;
}

namespace {

void check_below(const Value& value, const std::string& path, std::string& wrong) {
  if (!wrong.empty()) return;
  switch (value.kind()) {
    case Kind::kOptional:
    case Kind::kList:
      for (std::size_t i = 0; i < value.size(); ++i) check_below(value[i], path, wrong);
      return;
    case Kind::kVariant:
      return check_below(value.chosen(), path, wrong);
    case Kind::kGroup:
      for_each_member(value, [&](const Member& m) {
        check_below(m.value, io::detail::dotted(path, m.info.name), wrong);
      });
      validate(value, [&](std::string_view key, std::string_view message) {
        if (wrong.empty()) wrong = io::detail::dotted(path, key) + ": " + std::string(message);
      });
      return;
    default:
      return;
  }
}

}  // namespace

std::string why_impossible(const sim::Machine& machine, const std::vector<std::size_t>& axes) {
  std::string wrong;
  for (const std::size_t i : axes)
    check_below(value_of(machine.axes[i].second.plant), machine.axes[i].first, wrong);
  return wrong;
}

}  // namespace stribeck::workflow
