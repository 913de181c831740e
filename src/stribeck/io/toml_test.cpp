#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <stribeck/io/keys.hpp>
#include <stribeck/io/toml.hpp>

namespace stribeck::io::toml_test {

enum class Side { kDrive, kTable };

struct Screw {
  double lead = 0.005;
  std::optional<double> inertia;
  Side side = Side::kDrive;

  static constexpr auto fields() {
    return std::tuple{field("lead", &Screw::lead, quantity("m", "mm").positive(), "travel per turn"),
                      field("inertia", &Screw::inertia, quantity("kg m2", "kg m2"), "inertia of the screw"),
                      field("side", &Screw::side, "drive or table").or_default()};
  }
  bool operator==(const Screw&) const = default;
};

struct Element {
  double stiffness = 0.0;
  double share = 0.0;

  static constexpr auto fields() {
    return std::tuple{
        field("stiffness", &Element::stiffness, quantity("N/m", "N/mm").positive(), "stiffness"),
        field("share", &Element::share, pure_number().positive().at_most(1), "share of the level")};
  }
  bool operator==(const Element&) const = default;
};

struct None {
  static constexpr std::string_view kKind = "none";
  static constexpr auto fields() { return std::tuple{}; }
  bool operator==(const None&) const = default;
};

struct Slip {
  static constexpr std::string_view kKind = "slip";
  FixedVector<Element, 3> elements;
  double attraction = 1.0;

  static constexpr auto fields() {
    return std::tuple{
        field("elements", &Slip::elements, "elements"),
        field("attraction", &Slip::attraction, quantity("N/s", "N/s"), "attraction").or_default()};
  }
  template <class Report>
  void validate(Report&& report) const {
    double sum = 0.0;
    for (const auto& e : elements) sum += e.share;
    if (!(std::abs(sum - 1.0) < 1e-9)) report("elements", "the shares must add up to 1");
  }
  bool operator==(const Slip&) const = default;
};

struct Axis {
  double mass = 0.0;
  std::optional<Screw> screw;
  std::variant<None, Slip> dynamics;

  static constexpr auto fields() {
    return std::tuple{field("mass", &Axis::mass, quantity("kg", "N s2/mm").positive(), "moving mass"),
                      field("screw", &Axis::screw, "the screw"),
                      field("dynamics", &Axis::dynamics, "behaviour; left out: none").or_default()};
  }
  bool operator==(const Axis&) const = default;
};

struct Machine {
  std::string name;
  int bits = 16;
  std::size_t delay = 0;
  bool simulated = false;
  double gain = 1.0;
  std::vector<double> speeds;
  std::array<double, 2> window{};
  std::vector<std::string> notes;
  std::vector<std::pair<std::string, Axis>> axes;

  static constexpr auto fields() {
    return std::tuple{
        field("name", &Machine::name, "name of the machine"),
        field("bits", &Machine::bits, pure_number().at_least(4).at_most(32), "resolution").or_default(),
        field("delay", &Machine::delay, "whole periods").or_default(),
        field("simulated", &Machine::simulated, "a virtual machine").or_default(),
        field("gain", &Machine::gain, pure_number(), "a ratio").or_default(),
        field("speeds", &Machine::speeds, quantity("m/s", "mm/s").positive(), "speeds to run").or_default(),
        field("window", &Machine::window, quantity("s", "ms"), "from, to").or_default(),
        field("notes", &Machine::notes, "free text").or_default(),
        field("axes", &Machine::axes, "one table per axis")};
  }
  bool operator==(const Machine&) const = default;
};

}  // namespace stribeck::io::toml_test

template <>
struct stribeck::EnumNames<stribeck::io::toml_test::Side> {
  static constexpr std::array names{
      std::pair{stribeck::io::toml_test::Side::kDrive, std::string_view{"drive"}},
      std::pair{stribeck::io::toml_test::Side::kTable, std::string_view{"table"}}};
};

namespace stribeck::io::toml_test {
namespace {

constexpr std::string_view kGood = R"(# a machine
name = "biaxial table"
bits = 14
simulated = true
gain = "16 %"
speeds = ["10 mm/s", "1 m/min"]
window = ["5 ms", "1 s"]

[axes.y]
mass = "60 N s2/mm"
dynamics = {kind = "none"}

[axes.x]
mass = "57.65 N s2/mm"
[axes.x.screw]
lead = "10 mm"
side = "table"
[axes.x.dynamics]
kind = "slip"
elements = [
  {stiffness = "100 N/mm", share = 0.25},
  {stiffness = "10 N/mm", share = 0.75},
]
)";

std::vector<std::string> problems_of(std::string_view text) {
  std::vector<std::string> lines;
  try {
    read_toml_text<Machine>(text, "m.toml");
  } catch (const InputError& e) {
    for (const auto& p : e.problems()) lines.push_back(p.text());
  }
  return lines;
}

/// The good text with one piece replaced.
std::string with(std::string_view what, std::string_view by) {
  std::string text(kGood);
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, what.size(), by);
}

TEST(Toml, ReadsEveryKindOfMember) {
  const auto m = read_toml_text<Machine>(kGood, "m.toml");
  EXPECT_EQ(m.name, "biaxial table");
  EXPECT_EQ(m.bits, 14);
  EXPECT_TRUE(m.simulated);
  EXPECT_EQ(m.gain, 0.16);
  ASSERT_EQ(m.speeds.size(), 2u);
  EXPECT_EQ(m.speeds[0], 0.01);
  EXPECT_EQ(m.window, (std::array{0.005, 1.0}));
  ASSERT_EQ(m.axes.size(), 2u);
  EXPECT_EQ(m.axes[0].first, "y");  // order of the file, not of the alphabet
  EXPECT_EQ(m.axes[1].first, "x");
  EXPECT_EQ(m.axes[0].second, (Axis{60000.0, std::nullopt, None{}}));
  const Axis& x = m.axes[1].second;
  EXPECT_EQ(x.mass, 57650.0);
  EXPECT_EQ(x.screw, (Screw{0.01, std::nullopt, Side::kTable}));
  const auto& slip = std::get<Slip>(x.dynamics);
  ASSERT_EQ(slip.elements.size(), 2u);
  EXPECT_EQ(slip.elements[1], (Element{1e4, 0.75}));
  EXPECT_EQ(slip.attraction, 1.0);
}

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Toml, NamesFileLineKeyAndWayOut) {
  EXPECT_THAT(problems_of(with("lead = ", "laed = ")),
              ElementsAre(AllOf(StartsWith("m.toml:15: axes.x.screw.lead: missing key"), HasSubstr("5 mm")),
                          "m.toml:16: axes.x.screw.laed: unknown key (meant \"lead\"?)"));
  EXPECT_THAT(problems_of(with("\"10 mm\"\n", "10\n")),
              ElementsAre("m.toml:16: axes.x.screw.lead: got the bare number 10, expected text with a unit "
                          "(missing unit: write \"10 mm\")"));
  EXPECT_THAT(problems_of(with("\"10 mm\"\n", "\"10 N\"\n")),
              ElementsAre(StartsWith("m.toml:16: axes.x.screw.lead: got \"10 N\", expected a unit like mm")));
  EXPECT_THAT(problems_of(with("\"10 mm\"\n", "\"-1 mm\"\n")),
              ElementsAre("m.toml:16: axes.x.screw.lead: got \"-1 mm\", expected above 0 mm"));
  EXPECT_THAT(
      problems_of(with("\"table\"", "\"tabel\"")),
      ElementsAre(
          "m.toml:17: axes.x.screw.side: got \"tabel\", expected one of drive, table (meant \"table\"?)"));
  EXPECT_THAT(problems_of(with("\"slip\"", "\"lugre\"")),
              ElementsAre("m.toml:19: axes.x.dynamics.kind: got \"lugre\", expected one of none, slip"));
  EXPECT_THAT(problems_of(with("kind = \"slip\"\n", "")),
              ElementsAre("m.toml:18: axes.x.dynamics.kind: missing key, expected one of none, slip"));
  EXPECT_THAT(problems_of(with("bits = 14", "bits = 14.0")),
              ElementsAre(HasSubstr("m.toml:3: bits: got 14, expected a whole")));
  EXPECT_THAT(problems_of(with("bits = 14", "bits = 64")),
              ElementsAre("m.toml:3: bits: got 64, expected 4 to 32"));
  EXPECT_THAT(problems_of(with("bits = 14", "delay = -1")),
              ElementsAre(StartsWith("m.toml:3: delay: got -1, expected 0 to")));
  EXPECT_THAT(problems_of(with("= true", "= \"yes\"")), ElementsAre(HasSubstr("expected true or false")));
  EXPECT_THAT(problems_of(with("\"16 %\"", "inf")),
              ElementsAre(HasSubstr("m.toml:5: gain: got inf, expected a finite")));
  EXPECT_THAT(problems_of(with("\"biaxial table\"", "7")),
              ElementsAre(HasSubstr("m.toml:2: name: got 7, expected text")));
  // They reach files that other programs obey line by line.
  for (const char* name :
       {"\"a\\nb\"", "\"a\\u0001b\"", "\"a\\u0085b\"", "\"a\\u202Eb\"", "\"\"\"a\nb\"\"\""}) {
    EXPECT_THAT(
        problems_of(with("\"biaxial table\"", name)),
        ElementsAre(
            "m.toml:2: name: got \"a b\" with line breaks or control characters in it, expected plain "
            "text on one line"))
        << name;
  }
  EXPECT_THAT(problems_of(with("\"1 m/min\"", "3")),
              ElementsAre(StartsWith("m.toml:6: speeds[2]: got the bare number 3")));
  EXPECT_THAT(problems_of(with(", \"1 s\"", "")),
              ElementsAre("m.toml:7: window: got a list of 1, expected exactly 2 items"));
  EXPECT_THAT(problems_of(with("share = 0.75", "share = 0.70")),
              ElementsAre("m.toml:20: axes.x.dynamics.elements: the shares must add up to 1"));
  EXPECT_THAT(problems_of(with(
                  "0.25},", "0.25}, {stiffness=\"1 N/mm\", share=0.1}, {stiffness=\"1 N/mm\", share=0.1},")),
              ElementsAre("m.toml:20: axes.x.dynamics.elements: got a list of 4, expected at most 3 items"));
  EXPECT_THAT(problems_of(with("mass = \"60 N s2/mm\"", "mass = 1979-05-27")),
              ElementsAre(HasSubstr("got a date or time")));
  EXPECT_THAT(problems_of(with("[axes.y]", "[axes.y")), ElementsAre(StartsWith("m.toml:9: not valid TOML")));
  EXPECT_THAT(problems_of(with("[axes.y]", "[=axes.y]")),
              ElementsAre(StartsWith("m.toml:9: not valid TOML")));
  EXPECT_THAT(problems_of(with("bits = 14", "name = \"twice\"")),
              ElementsAre(StartsWith("m.toml:3: not valid TOML")));
}

TEST(Toml, ReportsAllProblemsInTheOrderOfTheFile) {
  const auto lines = problems_of("bitz = 3\nsimulated = 1\nspeeds = 5\n[axes.x]\nmass = \"0 kg\"\n");
  EXPECT_THAT(
      lines,
      ElementsAre(StartsWith("m.toml:1: bitz"), StartsWith("m.toml:1: name: missing"),
                  StartsWith("m.toml:2: simulated"), StartsWith("m.toml:3: speeds: got 5, expected a list"),
                  StartsWith("m.toml:5: axes.x.mass: got \"0 kg\", expected above 0 N s2/mm")));
  try {
    read_toml_text<Machine>("bitz = 3\n", "m.toml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(StartsWith("m.toml:1: bitz: unknown key (meant \"bits\"?)"),
                                HasSubstr("(and 2 more)")));
  }
}

TEST(Toml, RoundTripsBitForBit) {
  const unsigned seed = 7;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> exponent(-6.0, 6.0);
  const auto number = [&] { return std::pow(10.0, exponent(random)); };
  for (int k = 0; k < 200; ++k) {
    Machine m{"a \"quoted\" \\ name with µ, # and 'single' quotes",
              k % 29 + 4,
              3,
              k % 2 == 0,
              number(),
              {number(), number()},
              {number(), -number()},
              {"", "#"},
              {}};
    Slip slip;
    slip.elements.push_back({number(), 0.3});
    slip.elements.push_back({number(), 0.7});
    slip.attraction = -number();
    m.axes.emplace_back("y 2.0", Axis{number(), Screw{number(), number(), Side::kTable}, slip});
    m.axes.emplace_back("a", Axis{number(), Screw{number(), std::nullopt, Side::kDrive}, None{}});
    m.axes.emplace_back("empty",
                        Axis{number(), std::nullopt, Slip{FixedVector<Element, 3>{Element{1, 1}}, 2.0}});
    for (const Docs docs : {Docs::kNo, Docs::kYes}) {
      const std::string text = write_toml(m, "two\nlines", docs);
      ASSERT_EQ(read_toml_text<Machine>(text, "m.toml"), m) << text << "seed " << seed << " case " << k;
    }
  }
}

struct Noise {
  double rms = 0.0;
  double time = 0.0;  ///< 0: none

  static constexpr auto fields() {
    return std::tuple{
        field("rms", &Noise::rms, quantity("N", "N").not_negative(), "standard deviation"),
        field("time", &Noise::time, quantity("s", "ms").positive(), "correlation time").or_default()};
  }
  bool operator==(const Noise&) const = default;
};

TEST(Toml, ADefaultThatNoFileMaySetIsLeftOut) {
  const Noise white{0.5, 0.0};
  EXPECT_EQ(read_toml_text<Noise>(write_toml(white), "noise.toml"), white);
  const Noise coloured{0.5, 0.01};
  EXPECT_EQ(read_toml_text<Noise>(write_toml(coloured), "noise.toml"), coloured);
}

TEST(Toml, WritesWhatAPersonWouldWrite) {
  Machine m;
  m.name = "m";
  m.axes.emplace_back("x", Axis{57650.0, Screw{}, Slip{FixedVector<Element, 3>{Element{1e5, 1.0}}, 1.0}});
  EXPECT_EQ(write_toml(m, "by hand"), R"(# by hand
name = "m"
bits = 16
delay = 0
simulated = false
gain = 1
speeds = []
window = ["0 ms", "0 ms"]
notes = []

[axes.x]
mass = "57.65 N s2/mm"

[axes.x.screw]
lead = "5 mm"
side = "drive"

[axes.x.dynamics]
kind = "slip"
elements = [
  {stiffness = "100 N/mm", share = 1},
]
attraction = "1 N/s"
)");
  EXPECT_THAT(write_toml(Screw{}, "", Docs::kYes), HasSubstr("lead = \"5 mm\"  # travel per turn\n"));
  EXPECT_THROW(write_toml(Screw{std::nan(""), std::nullopt, Side::kDrive}), InputError);
}

TEST(Toml, KeysOfFarTooManyPartsAreRefusedBeforeTheyAreBuilt) {
  const auto repeated = [](int n) {
    std::string key;
    for (int i = 0; i < n; ++i) key += "a.";
    return key + "b";
  };
  for (const std::string& text :
       {"\n" + repeated(100000) + " = 1", "\n[" + repeated(100000) + "]",
        "\nx = {" + repeated(100000) + " = 1}", "x = '''\n'''\n" + repeated(64) + " = 1"}) {
    try {
      parse_toml(text, "k.toml");
      FAIL();
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("a key of 64 parts or more"));
      EXPECT_EQ(e.problems().front().line, text[0] == 'x' ? 3u : 2u);
    }
  }
  // Dots of values, comments and texts are none of a key.
  const std::string dots(200, '.');
  EXPECT_NO_THROW(parse_toml(repeated(60) + " = 1\nx = \"\\\"" + dots + "\"\ny = '''\n" + dots + "'''\n# " +
                                 dots + "\nz = [1.5, 2.5]",
                             "k.toml"));
}

TEST(Toml, DescribesEveryKey) {
  const std::string page = describe<Machine>();
  EXPECT_THAT(page, HasSubstr("| `bits` | count | 4 to 32 | 16 | resolution |"));
  EXPECT_THAT(page, HasSubstr("| `axes.<name>.mass` | N s2/mm | above 0 N s2/mm | required | moving mass |"));
  EXPECT_THAT(page, HasSubstr("| `axes.<name>.dynamics` | table | kind = none \\| slip | see below |"));
  EXPECT_THAT(
      page,
      HasSubstr("| `axes.<name>.dynamics.elements[].share` | number | above 0, at most 1 | required |"));
  EXPECT_THAT(page,
              HasSubstr("| `axes.<name>.dynamics.attraction` | N/s |  | 1 N/s | kind slip: attraction |"));
  EXPECT_THAT(page, HasSubstr("| `axes.<name>.screw.inertia` | kg m2 |  | none | inertia of the screw |"));
}

}  // namespace
/// A file of one axis.
struct Turns {
  bool rotary = false;
  double mass = 0.0;
  Element element;

  static constexpr auto fields() {
    return std::tuple{field("rotary", &Turns::rotary, "turns").or_default(),
                      field("mass", &Turns::mass, quantity("kg", "N s2/mm").positive(), "mass"),
                      field("element", &Turns::element, "element")};
  }
};

TEST(Toml, AFileOfAnAxisThatTurnsMaySayAnglesAndTorques) {
  const auto read = [](const std::string& head, const std::string& mass, const std::string& stiffness) {
    return read_toml_text<Turns>(
        head + "mass = \"" + mass + "\"\n[element]\nstiffness = \"" + stiffness + "\"\nshare = 1\n",
        "c.toml");
  };
  const std::string turns = "rotary = true\n";
  const Turns angles = read(turns, "1.2 kg m^2", "300 N m/rad");
  EXPECT_EQ(angles.mass, 1.2);
  EXPECT_EQ(angles.element.stiffness, 300.0);
  // What the program writes, and both beside each other.
  const Turns lengths = read(turns, "1.2 kg", "0.3 N/mm");
  EXPECT_EQ(lengths.mass, 1.2);
  EXPECT_EQ(lengths.element.stiffness, 300.0);
  for (const std::string head : {"", "rotary = false\n"})
    EXPECT_THROW(read(head, "1.2 kg m^2", "0.3 N/mm"), InputError) << head;
  EXPECT_THROW(read(turns, "1.2 s", "0.3 N/mm"), InputError);
}

}  // namespace stribeck::io::toml_test
