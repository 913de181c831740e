#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/core/fixed_vector.hpp>
#include <stribeck/core/walk_fields.hpp>
#include <string>
#include <vector>

namespace stribeck::walk_fields_test {

enum class Colour { kRed, kBlue };

}  // namespace stribeck::walk_fields_test

template <>
struct stribeck::EnumNames<stribeck::walk_fields_test::Colour> {
  static constexpr std::array names{
      std::pair{stribeck::walk_fields_test::Colour::kRed, std::string_view{"red"}},
      std::pair{stribeck::walk_fields_test::Colour::kBlue, std::string_view{"blue"}}};
};

namespace stribeck::walk_fields_test {
namespace {

struct Observer {
  bool on = false;
  double pole = 20.0;

  static constexpr auto fields() {
    return std::tuple{field("on", &Observer::on, "whether it runs").or_default(),
                      field("pole", &Observer::pole, quantity("1/s", "1/s").positive(), "its pole")
                          .or_default()
                          .when([](const Observer& o) { return o.on; }, "goes with on = true")};
  }
  template <class R>
  void validate(R&& report) const {
    if (pole > 1e3) report("pole", "too fast");
  }
};

/// A group that a word may stand for.
struct Cooling {
  static constexpr std::string_view kShortForm = "on";

  bool on = false;
  double flow = 3.0;
  double pressure = 2.0;

  static constexpr auto fields() {
    return std::tuple{field("on", &Cooling::on, "whether it runs").or_default(),
                      field("flow", &Cooling::flow, pure_number(), "").or_default(),
                      field("pressure", &Cooling::pressure, pure_number(), "").or_default()};
  }
};

struct Off {
  static constexpr std::string_view kKind = "off";
  static constexpr auto fields() { return std::tuple{}; }
};
struct Spring {
  static constexpr std::string_view kKind = "spring";
  double stiffness = 1.0;
  static constexpr auto fields() {
    return std::tuple{field("stiffness", &Spring::stiffness, quantity("N/m", "N/mm"), "stiffness")};
  }
};

struct Axis {
  std::string name = "x";
  Observer observer;
  Colour colour = Colour::kBlue;
  int bits = 16;
  std::optional<double> limit;
  FixedVector<double, 3> gains{1.0, 2.0};
  std::array<double, 2> window{3.0, 4.0};
  std::variant<Off, Spring> law;
  std::vector<std::pair<std::string, Spring>> springs;

  static constexpr auto fields() {
    using A = Axis;
    return std::tuple{field("name", &A::name, "name"),
                      embedded(&A::observer),
                      field("colour", &A::colour, ""),
                      field("bits", &A::bits, ""),
                      field("limit", &A::limit, ""),
                      field("gains", &A::gains, ""),
                      field("window", &A::window, ""),
                      field("law", &A::law, ""),
                      field("springs", &A::springs, "").or_default()};
  }
};

/// Everything that a walk sees, in one line.
std::string seen(const Value& v) {
  std::string out;
  switch (v.kind()) {
    case Kind::kSwitch:
      return v.number() != 0.0 ? "yes" : "no";
    case Kind::kCount:
    case Kind::kNumber:
      return std::to_string(static_cast<int>(v.number()));
    case Kind::kText:
      return std::string(v.text());
    case Kind::kChoice:
      return std::string(v.word());
    case Kind::kOptional:
      return v.size() == 0 ? "absent" : seen(v[0]);
    case Kind::kVariant:
      return std::string(v.word()) + seen(v.chosen());
    case Kind::kList:
      for (std::size_t i = 0; i < v.size(); ++i) out += seen(v[i]) + ' ';
      return '[' + out + ']';
    case Kind::kNamed:
      for (std::size_t i = 0; i < v.size(); ++i) out += std::string(v.name_at(i)) + seen(v[i]);
      return '<' + out + '>';
    case Kind::kGroup:
      for_each_member(v,
                      [&](const Member& m) { out += std::string(m.info.name) + '=' + seen(m.value) + ' '; });
      return '{' + out + '}';
  }
  return out;
}

TEST(WalkFields, SeesEveryKindOfMember) {
  Axis a;
  a.springs.emplace_back("left", Spring{7.0});
  EXPECT_EQ(seen(value_of(a)),
            "{name=x on=no pole=20 colour=blue bits=16 limit=absent gains=[1 2 ] window=[3 4 ] law=off{} "
            "springs=<left{stiffness=7 }> }");
}

TEST(WalkFields, ChangesEveryKindOfMember) {
  Axis a;
  const Target t = target_of(a);
  const auto at = [&](std::string_view name) { return *find_member(t, name); };
  at("name").set("y");
  at("on").set(1.0);
  at("pole").set(30.0);
  at("colour").set(0.0);
  at("bits").set(12.0);
  at("limit").resize(1);
  at("limit")[0].set(5.0);
  at("gains").resize(3);
  at("gains")[2].set(9.0);
  at("window")[0].set(8.0);
  at("law").set(1.0);
  find_member(at("law").chosen(), "stiffness")->set(6.0);
  at("springs").add("right");
  EXPECT_EQ(a.name, "y");
  EXPECT_TRUE(a.observer.on);
  EXPECT_EQ(a.observer.pole, 30.0);
  EXPECT_EQ(a.colour, Colour::kRed);
  EXPECT_EQ(a.bits, 12);
  EXPECT_EQ(a.limit, 5.0);
  EXPECT_EQ(a.gains, (FixedVector<double, 3>{1.0, 2.0, 9.0}));
  EXPECT_EQ(a.window[0], 8.0);
  EXPECT_EQ(std::get<Spring>(a.law).stiffness, 6.0);
  ASSERT_EQ(a.springs.size(), 1U);
  EXPECT_EQ(a.springs[0].first, "right");
  at("limit").resize(0);
  at("gains").resize(7);
  EXPECT_FALSE(a.limit);
  EXPECT_EQ(a.gains.size(), 3U) << "no longer than its storage";
}

TEST(WalkFields, KnowsWhatHasAnEffectAndWhatIsAsItBegan) {
  Axis a;
  const auto of_pole = [&](auto&& ask) {
    bool answer = false;
    for_each_member(value_of(a), [&](const Member& m) {
      if (m.info.name == "pole") answer = ask(m);
    });
    return answer;
  };
  const auto effect = [](const Member& m) { return m.has_effect(); };
  const auto initial = [&](const Member& m) { return is_initial(value_of(a), m); };
  EXPECT_FALSE(of_pole(effect));
  EXPECT_TRUE(of_pole(initial));
  a.observer = {true, 21.0};
  EXPECT_TRUE(of_pole(effect));
  EXPECT_FALSE(of_pole(initial));
}

TEST(WalkFields, AWordStandsForAGroupWhereEverythingElseIsInitial) {
  Cooling c;
  EXPECT_TRUE(is_short(value_of(c)));
  EXPECT_EQ(short_form(value_of(c)), "off");
  c.on = true;
  EXPECT_TRUE(is_short(value_of(c))) << "the switch itself may be either";
  EXPECT_EQ(short_form(value_of(c)), "on");
  c.flow = 4.0;
  EXPECT_FALSE(is_short(value_of(c)));
  c.flow = 3.0;
  c.pressure = 5.0;
  EXPECT_FALSE(is_short(value_of(c)));
  // A group without such a word, and what is no group.
  Spring s;
  EXPECT_FALSE(is_short(value_of(s)));
  Axis a;
  for_each_member(value_of(a), [](const Member& m) {
    EXPECT_FALSE(is_short(m.value)) << m.info.name;
    EXPECT_EQ(m.value.is_scalar(), m.info.name == "bits" || m.info.name == "on" || m.info.name == "pole")
        << m.info.name;
  });
}

TEST(WalkFields, ValidatesEmbeddedStructsToo) {
  Axis a;
  a.observer.pole = 1e4;
  std::string said;
  validate(value_of(a), [&](std::string_view key, std::string_view what) {
    said += std::string(key) + ": " + std::string(what);
  });
  EXPECT_EQ(said, "pole: too fast");
}

TEST(WalkFields, ComparesMemberByMember) {
  Axis a;
  Axis b;
  a.springs.emplace_back("left", Spring{std::nan("")});
  b.springs.emplace_back("left", Spring{std::nan("")});
  EXPECT_TRUE(same(value_of(a), value_of(b))) << "absent is absent";
  b.springs[0].first = "right";
  EXPECT_FALSE(same(value_of(a), value_of(b)));
  b = a;
  b.law = Spring{};
  EXPECT_FALSE(same(value_of(a), value_of(b)));
  b = a;
  b.limit = 0.0;
  EXPECT_FALSE(same(value_of(a), value_of(b)));
}

TEST(WalkFields, FindsNamesOfEnumerationsBothWays) {
  EXPECT_EQ(enum_name(Colour::kRed), "red");
  EXPECT_EQ(enum_name(static_cast<Colour>(7)), "");
  EXPECT_EQ(enum_value<Colour>("blue"), Colour::kBlue);
  EXPECT_FALSE(enum_value<Colour>("green"));
}

TEST(Walk, TwoObjectsAreTheSameOnlyWithEveryNumberTheSame) {
  const double nan = std::nan("");
  const auto equal = [](double a, double b) {
    Observer one, other;
    one.pole = a;
    other.pole = b;
    return same(Value(type_of<Observer>, &one), Value(type_of<Observer>, &other));
  };
  EXPECT_TRUE(equal(1.0, 1.0));
  EXPECT_TRUE(equal(nan, nan));
  EXPECT_FALSE(equal(1.0, nan));
  EXPECT_FALSE(equal(nan, 1.0));
  EXPECT_FALSE(equal(1.0, 2.0));
}

TEST(Walk, EachOfSeveralNamedObjectsHasItsNameAndEveryChoiceItsNumber) {
  Axis axis;
  axis.springs = {{"front", {1.0}}, {"back", {2.0}}};
  const Value springs(type_of<decltype(axis.springs)>, &axis.springs);
  ASSERT_EQ(springs.size(), 2U);
  EXPECT_EQ(springs.name_at(0), "front");
  EXPECT_EQ(springs.name_at(1), "back");
  for (const Colour colour : {Colour::kRed, Colour::kBlue}) {
    const Value choice(type_of<Colour>, &colour);
    EXPECT_EQ(choice.number(), colour == Colour::kRed ? 0.0 : 1.0);
    EXPECT_EQ(choice.word(), colour == Colour::kRed ? "red" : "blue");
  }
}

TEST(Walk, AnOptionalOrAValueWithADefaultNeedNotBeGiven) {
  Axis axis;
  std::string needed;
  for_each_member(Value(type_of<Axis>, &axis), [&](const Member& m) {
    if (m.required()) needed += std::string(m.info.name) + ' ';
  });
  EXPECT_EQ(needed.find("limit"), std::string::npos);
  EXPECT_EQ(needed.find("springs"), std::string::npos);
  EXPECT_NE(needed.find("name "), std::string::npos);
  EXPECT_NE(needed.find("bits "), std::string::npos);
}

TEST(Walk, AnArrayHasAFixedSizeAndAVectorHasNot) {
  Axis axis;
  EXPECT_TRUE(Value(type_of<decltype(axis.window)>, &axis.window).has_fixed_size());
  EXPECT_FALSE(Value(type_of<decltype(axis.gains)>, &axis.gains).has_fixed_size());
  EXPECT_FALSE(Value(type_of<decltype(axis.springs)>, &axis.springs).has_fixed_size());
}

}  // namespace
}  // namespace stribeck::walk_fields_test
