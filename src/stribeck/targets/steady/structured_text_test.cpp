#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <stribeck/core/scalar.hpp>
#include <stribeck/friction/gms.hpp>
#include <stribeck/friction/lugre.hpp>
#include <stribeck/targets/pulse/test_export.hpp>
#include <stribeck/targets/steady/test_export.hpp>
#include <string>
#include <utility>
#include <vector>

namespace stribeck::test::structured_text_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string replaced(const std::string& text, const char* pattern, const char* by) {
  return std::regex_replace(text, std::regex(pattern), by);
}

/// The function block x_force as C, by the grammar of IEC 61131-3 as far as the targets use it. Its variables become static ones, and its
/// inputs arguments: every call is a cycle.
std::string as_c(std::string st) {
  st = replaced(st, "\\(\\*[^\\n]*?\\*\\)", "");
  const auto variables = [&](const std::string& section) {
    const std::size_t at = st.find(section), end = st.find("END_VAR", at);
    std::string lines = st.substr(at + section.size(), end - at - section.size());
    lines = replaced(lines, "(\\w+) : ARRAY\\[0\\.\\.(\\d+)\\] OF LREAL := \\[([^\\]]*)\\];",
                     "static double $1[$2 + 1] = {$3};");
    lines = replaced(lines, "(\\w+) : ARRAY\\[0\\.\\.(\\d+)\\] OF LREAL;", "static double $1[$2 + 1];");
    lines = replaced(lines, "([\\w, ]+) : LREAL := ([^;]*);", "static double $1 = $2;");
    lines = replaced(lines, "([\\w, ]+) : LREAL;", "static double $1;");
    return replaced(lines, "([\\w, ]+) : (INT|BOOL);", "static int $1;");
  };
  const std::string all = variables("\nVAR_OUTPUT\n") + variables("\nVAR\n") + variables("\nVAR CONSTANT\n");
  std::string code = st.substr(st.rfind("END_VAR\n") + 8);
  code = code.substr(0, code.find("END_FUNCTION_BLOCK"));
  code = replaced(code, "([^:])=", "$1==");
  code = replaced(code, ":==?", "=");
  code = replaced(code, "([<>])==", "$1=");
  code = replaced(code, "FOR i = 0 TO (\\d+) DO", "for (i = 0; i <= $1; ++i) {");
  code = replaced(code, "WHILE (.*) DO", "while ($1) {");
  code = replaced(code, "ELSIF (.*) THEN", "} else if ($1) {");
  code = replaced(code, "IF (.*) THEN", "if ($1) {");
  code = replaced(code, "ELSE", "} else {");
  code = replaced(code, "END_(IF|FOR|WHILE);", "}");
  for (const auto& [word, by] : {std::pair{"\\bAND\\b", "&&"},
                                 {"\\bOR\\b", "||"},
                                 {"\\bNOT\\b", "!"},
                                 {"\\bTRUE\\b", "1"},
                                 {"\\bFALSE\\b", "0"},
                                 {"\\bABS\\b", "fabs"},
                                 {"\\bSIN\\b", "sin"},
                                 {"\\bEXP\\b", "exp"},
                                 {"\\bLIMIT\\b", "limit"},
                                 {"\\bMIN\\b", "fmin"},
                                 {"\\bMAX\\b", "fmax"},
                                 {"<>", "!="},
                                 {"\\bLREAL_TO_INT\\b", "lround"}})
    code = replaced(code, word, by);
  return "#include <math.h>\n#include <stdio.h>\nstatic double limit(double low, double x, double high) { return fmin(fmax(x, low), high); }\n"
         "static double x_force(double acceleration, double velocity, double position) {\n" +
         all + code +
         "return force;\n}\nint main(void) {\n  double a, v, p;\n  (void)limit(0, 0, 0);\n"
         "  while (scanf(\"%lf %lf %lf\", &a, &v, &p) == 3) printf(\"%.15g\\n\", x_force(a, v, p));\n  return 0;\n}\n";
}

struct Sample {
  double acceleration, velocity, position;
};

/// What the exported block gives along a motion, one cycle after the other.
std::vector<double> run(SteadyExport& x, const char* target, const std::vector<Sample>& motion) {
  const std::string source = x.folder.write("block.c", as_c(x.text(target)).c_str());
  const std::string program = x.folder / "block", out = x.folder / "values.txt";
  EXPECT_EQ(std::system(("cc -std=gnu99 -o '" + program + "' '" + source + "' -lm").c_str()), 0);
  std::string input;
  for (const Sample& s : motion)
    input += fmt::format("{:.17g} {:.17g} {:.17g}\n", s.acceleration, s.velocity, s.position);
  const std::string in = x.folder.write("in.txt", input.c_str());
  EXPECT_EQ(std::system(("'" + program + "' < '" + in + "' > '" + out + "'").c_str()), 0);
  std::istringstream values(text_of(out));
  std::vector<double> forces(motion.size());
  for (double& f : forces) EXPECT_TRUE(values >> f);
  return forces;
}

/// A sine of 2 mm and 0.5 Hz in periods of 1 ms: two reversals in each turn.
std::vector<Sample> sine(int rows) {
  std::vector<Sample> all;
  const double w = 2.0 * kPi * 0.5;
  for (int k = 0; k < rows; ++k) {
    const double t = 1e-3 * k;
    all.push_back(
        {2e-3 * w * w * std::cos(w * t), 2e-3 * w * std::sin(w * t), 2e-3 * (1.0 - std::cos(w * t))});
  }
  return all;
}

constexpr const char* kLevel =
    "mass = \"100 kg\"\nload = \"5 N\"\n[friction]\nsteady = { kind = \"conventional\", alpha0 = \"40 N\", alpha2 = \"0 N s/mm\" }\n";

TEST(StructuredText, WithoutBristlesTheForceTurnsAtOnce) {
  SteadyExport x(kLevel);
  const std::vector<Sample> motion{{0, 0, 0}, {2, 0.01, 1e-6}, {-1, -0.01, 0}, {0, 0, 0}};
  const std::vector<double> force = run(x, "structured-text", motion);
  EXPECT_NEAR(force[0], 5.0, 1e-6);
  EXPECT_NEAR(force[1], 200.0 + 40.0 + 5.0, 1e-6);
  EXPECT_NEAR(force[2], -100.0 - 40.0 + 5.0, 1e-6);
  EXPECT_NEAR(force[3], 5.0, 1e-6);
  EXPECT_THAT(x.text("structured-text"), Not(HasSubstr("travel")));
}

// With a level that does not depend on the speed, the block is the law of friction/gms.hpp and friction/lugre.hpp themselves.
TEST(StructuredText, ElasticStopsAreThoseOfTheModel) {
  SteadyExport x(
      std::string(kLevel) +
      "[friction.dynamics]\nkind = \"gms\"\nattraction = \"1e9 N/s\"\nelements = [{ stiffness = \"3000 N/mm\", share = 0.5 }, { "
      "stiffness = \"600 N/mm\", share = 0.3 }, { stiffness = \"80 N/mm\", share = 0.2 }]\n");
  const std::vector<Sample> motion = sine(4000);
  const std::vector<double> force = run(x, "structured-text", motion);
  const double stiffness[] = {3e6, 6e5, 8e4}, share[] = {0.5, 0.3, 0.2};
  double stop[3] = {};
  for (std::size_t k = 0; k < motion.size(); ++k) {
    double friction = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (k > 0) stop[i] += stiffness[i] * (motion[k].position - motion[k - 1].position);
      stop[i] = std::min(std::max(stop[i], -40.0 * share[i]), 40.0 * share[i]);
      friction += stop[i];
    }
    // In the period of a reversal the block counts no travel: some hundredths of a newton here.
    ASSERT_NEAR(force[k], 100.0 * motion[k].acceleration + friction + 5.0, 0.1) << k;
  }
}

TEST(StructuredText, OneBristleIsThatOfTheModel) {
  SteadyExport x(std::string(kLevel) + "[friction.dynamics]\nkind = \"lugre\"\nsigma0 = \"800 N/mm\"\n");
  const std::vector<Sample> motion = sine(4000);
  const std::vector<double> force = run(x, "structured-text", motion);
  const friction::LuGre<double> law{800e3, 0.0, {}};
  friction::LuGre<double>::State state;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    if (k > 0) law.advance(state, (motion[k].position - motion[k - 1].position) / 1e-3, 40.0, 1e-3);
    ASSERT_NEAR(force[k], 100.0 * motion[k].acceleration + 800e3 * state.z + 5.0, 0.1) << k;
  }
}

// Friction of 40 N forward and 120 N backward: the force of a reversal stays, and comes to that of the other direction over the travel.
TEST(StructuredText, TheForceStaysAtAReversalToAnotherLevel) {
  const std::string level =
      "mass = \"100 kg\"\nload = \"5 N\"\n[friction.steady]\nkind = \"gaussian\"\nvelocity_range = [\"-100 mm/s\", \"100 mm/s\"]\n"
      "positive = { eta0 = \"40 N\", eta1 = \"0 N s/mm\" }\nnegative = { eta0 = \"-120 N\", eta1 = \"0 N s/mm\" }\n";
  const std::vector<Sample> motion = sine(4000);
  const auto expect = [&](const std::string& dynamics, const std::function<double(double, double)>& law) {
    SteadyExport x(level + "[friction.dynamics]\n" + dynamics);
    const std::vector<double> force = run(x, "structured-text", motion);
    for (std::size_t k = 0; k < motion.size(); ++k) {
      const double travel = k > 0 ? motion[k].position - motion[k - 1].position : 0.0;
      const double friction = law(travel, travel < 0.0 ? 120.0 : 40.0);
      // In the period of a reversal the block counts no travel, 10 nm here.
      ASSERT_NEAR(force[k], 100.0 * motion[k].acceleration + friction + 5.0, 0.2) << k;
    }
  };
  const friction::LuGre<double> lugre{800e3, 0.0, {}};
  friction::LuGre<double>::State state;
  expect("kind = \"lugre\"\nsigma0 = \"800 N/mm\"\n", [&](double travel, double now) {
    lugre.advance(state, travel / 1e-3, now, 1e-3);
    return 800e3 * state.z;
  });
  const double stiffness[] = {3e6, 8e4}, share[] = {0.6, 0.4};
  double stop[2] = {};
  expect(
      "kind = \"gms\"\nattraction = \"1e9 N/s\"\nelements = [{ stiffness = \"3000 N/mm\", share = 0.6 }, { stiffness = \"80 N/mm\", share = 0.4 }]\n",
      [&](double travel, double now) {
        for (int i = 0; i < 2; ++i) {
          stop[i] += stiffness[i] * travel;
          stop[i] = travel < 0.0 ? std::max(stop[i], -now * share[i]) : std::min(stop[i], now * share[i]);
        }
        return stop[0] + stop[1];
      });
}

// Small motion to and fro on a proportional term, for 20 s: the strain of the bristles does not creep away.
TEST(StructuredText, TheForceDoesNotDriftWhereTheLevelDependsOnThePlace) {
  SteadyExport x(
      "mass = \"100 kg\"\n[friction.steady]\nkind = \"gaussian\"\nvelocity_range = [\"-100 mm/s\", \"100 mm/s\"]\n"
      "positive = { eta0 = \"40 N\", eta1 = \"0 N s/mm\" }\nnegative = { eta0 = \"-120 N\", eta1 = \"0 N s/mm\" }\n"
      "[[friction.eccentric]]\namplitude = \"30 N\"\nperiod = \"10 mm\"\nphase = \"0 rad\"\nform = \"proportional\"\n"
      "[friction.dynamics]\nkind = \"gms\"\nattraction = \"1e9 N/s\"\nelements = [{ stiffness = \"3 N/mm\", share = 1.0 }]\n");
  std::vector<Sample> motion;
  for (int k = 0; k < 20000; ++k) {
    const double w = 2.0 * kPi * 10.0, t = 1e-3 * k;
    motion.push_back({0.0, 5e-6 * w * std::cos(w * t), 1e-3 + 5e-6 * std::sin(w * t)});
  }
  const std::vector<double> force = run(x, "structured-text", motion);
  // 3 N/mm over 10 um: far below every level.
  const auto [low, high] = std::minmax_element(force.begin() + 100, force.end());
  EXPECT_LT(*high - *low, 0.05);
}

// A turntable whose position begins anew in each turn, and an axis whose position is set anew at rest.
TEST(StructuredText, AJumpOfThePositionIsNoTravel) {
  const std::string bristle = "[friction.dynamics]\nkind = \"lugre\"\nsigma0 = \"800 N/mm\"\n";
  SteadyExport x(kLevel + bristle);
  std::vector<Sample> motion;
  for (int k = 0; k < 400; ++k) motion.push_back({0.0, 0.1, 1e-4 * (k < 200 ? k : k - 200)});
  for (int k = 0; k < 20; ++k) motion.push_back({0.0, 0.0, k < 10 ? 0.02 : -1.0});
  const std::vector<double> force = run(x, "structured-text", motion);
  for (std::size_t k = 20; k < motion.size(); ++k) ASSERT_NEAR(force[k], 45.0, 1e-3) << k;
}

TEST(StructuredText, TheTorqueOffsetIsTheSameInPerMille) {
  const std::string gms = "[friction.dynamics]\nkind = \"lugre\"\nsigma0 = \"800 N/mm\"\n";
  SteadyExport force(kLevel + gms), offset(kLevel + gms);
  offset.request.gain = "5 N/%";
  const std::vector<Sample> motion = sine(3000);
  const std::vector<double> newtons = run(force, "structured-text", motion),
                            counts = run(offset, "cia402", motion);
  for (std::size_t k = 0; k < motion.size(); ++k) ASSERT_NEAR(0.5 * counts[k], newtons[k], 0.26) << k;
  EXPECT_THAT(offset.to("cia402").text, Not(HasSubstr("pre-sliding")));
}

TEST(CSource, TheForceWithBristlesIsThatOfStructuredText) {
  for (
      const std::string dynamics :
      {"kind = \"lugre\"\nsigma0 = \"800 N/mm\"\n",
       "kind = \"gms\"\nattraction = \"1e9 N/s\"\nelements = [{ stiffness = \"3000 N/mm\", share = 0.6 }, { stiffness = \"90 N/mm\", share = "
       "0.4 }]\n"}) {
    SteadyExport x(kSteadyAxis + std::string("[friction.dynamics]\n") + dynamics);
    const std::vector<Sample> motion = sine(3000);
    const std::vector<double> expected = run(x, "structured-text", motion);
    x.request.output = x.folder / "x.h";
    EXPECT_THAT(x.to("c").text, Not(HasSubstr("pre-sliding")));
    const std::string main = x.folder.write(
        "main.c",
        "#include <stdio.h>\n#include \"x.h\"\nint main(void) {\n  struct x_memory m = {0};\n  double a, v, p;\n"
        "  while (scanf(\"%lf %lf %lf\", &a, &v, &p) == 3) printf(\"%.15g\\n\", x_force(&m, a, v, p));\n  return 0;\n}\n");
    const std::string program = x.folder / "program", out = x.folder / "c.txt";
    ASSERT_EQ(
        std::system(("cc -std=c99 -Wall -Wextra -Werror -o '" + program + "' '" + main + "' -lm").c_str()),
        0);
    ASSERT_EQ(std::system(("'" + program + "' < '" + (x.folder / "in.txt") + "' > '" + out + "'").c_str()),
              0);
    std::istringstream values(text_of(out));
    for (std::size_t k = 0; k < motion.size(); ++k) {
      double force = 0.0;
      ASSERT_TRUE(values >> force);
      ASSERT_NEAR(force, expected[k], 1e-6) << k;
    }
  }
}

// Friction that builds up over some ten micrometres: an offset that jumps does harm there, one with bristles none.
TEST(StructuredText, TheCircleHasWhatTheBristlesGain) {
  PulseExport x("cia402", kBristles);
  x.request.gain = "12 N/%";
  x.request.controller = "cascade";
  const auto circle = x.write().json["circle"];
  EXPECT_LT(circle["pulse"]["quadrant_um"].get<double>(),
            0.15 * circle["without"]["quadrant_um"].get<double>());
}

// IEC 61131-3 ignores case and has no two underscores in a row; in C x_positive_force would be declared twice.
TEST(StructuredText, NamesThatDoNotCompileAreRefused) {
  SteadyExport x;
  const auto refusal = [&](const char* target, std::vector<std::string> names) {
    x.request.files.resize(names.size(), x.request.files.front());
    x.request.gain = std::string(target) == "cia402" ? "12 N/%" : "";
    x.request.names = std::move(names);
    return x.refusal(target);
  };
  for (const char* target : {"structured-text", "cia402"}) {
    EXPECT_THAT(refusal(target, {"x", "X"}), HasSubstr("axis: a second axis is called X"));
    EXPECT_THAT(refusal(target, {"x_"}), HasSubstr("axis: x__force would have two underscores in a row"));
    EXPECT_THAT(refusal(target, {"y__1"}), HasSubstr("two underscores in a row"));
    EXPECT_EQ(refusal(target, {"x", "x_1"}), "accepted");
  }
  EXPECT_THAT(refusal("c", {"x", "x_positive"}),
              HasSubstr("axis: x_positive_force of axis x_positive would be the name of a table of axis x"));
  EXPECT_EQ(refusal("c", {"x", "X", "x_1"}), "accepted");
}

}  // namespace
}  // namespace stribeck::test::structured_text_test
