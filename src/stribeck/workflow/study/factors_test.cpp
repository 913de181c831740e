#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/study/factors.hpp>

namespace stribeck::workflow::factors_test {
namespace {

using testing::HasSubstr;

sim::Machine table() { return built_in_machine("biaxial-table"); }

/// Bound on both axes of the machine.
std::vector<BoundFactor> bound(const std::string& factors, const sim::Machine& machine = table()) {
  const std::string text = "machine = \"m.toml\"\ncontrollers = [\"f\"]\n" + factors;
  const auto file = io::read_toml_text<StudyFile>(text, "study.toml");
  return bind_factors(file, io::parse_toml(text, "study.toml"), "study.toml", machine, {0, 1});
}
std::string refused(const std::string& factors, const sim::Machine& machine = table()) {
  try {
    bound(factors, machine);
  } catch (const io::InputError& e) {
    return e.problems().front().text();
  }
  return "nothing";
}
std::string factor(const std::string& key, const std::string& how) {
  return "[[factors]]\nkey = \"" + key + "\"\n" + how + '\n';
}
std::string scale(const std::string& key) {
  return factor(key, "scale = { kind = \"uniform\", low = 0.5, high = 3.0 }");
}

const plant::AxisParams& x_of(const sim::Machine& m) { return m.axes[0].second.plant; }
const plant::AxisParams& y_of(const sim::Machine& m) { return m.axes[1].second.plant; }

friction::SteadyParts<double> friction_at(const plant::AxisParams& p, double v) {
  return p.friction.parts(v, 0.0);
}

// The machine file of a trunnion has kg m2 and deg/s; a study of it took kg and mm/s alone.
TEST(StudyFactors, AnAxisThatTurnsHasItsUnits) {
  sim::Machine machine = table();
  machine.axes[0].second.rotary = true;
  const auto list = [](const char* value) {
    return factor("x.mass", std::string("value = { kind = \"list\", values = [\"") + value + "\"] }");
  };
  const BoundFactor mass = bound(list("9 kg m2"), machine).front();
  EXPECT_DOUBLE_EQ(sim::value_number(mass.distribution, 0), 9.0);
  EXPECT_EQ(mass.head(), "x.mass [kg m2]");
  EXPECT_THAT(refused(list("9 kg"), machine), HasSubstr("expected a unit like kg m2"));
  EXPECT_THAT(refused(list("-9 kg m2"), machine),
              HasSubstr("value reaches -9 kg m2 on axis x, expected above 0 kg m2"));
  EXPECT_THAT(refused(factor("*.mass", "value = { kind = \"list\", values = [\"9 kg m2\"] }"), machine),
              HasSubstr("has one unit on the axes that turn and another on the others"));
}

TEST(StudyFactors, FrictionAndItsParts) {
  const sim::Machine nominal = table();
  for (const double v : {2e-3, -7e-3}) {
    const auto was = friction_at(x_of(nominal), v);
    const auto whole = friction_at(x_of(with_values(nominal, bound(scale("x.friction")), {1.5})), v);
    EXPECT_NEAR(whole.level, 1.5 * was.level, 1e-9);
    EXPECT_NEAR(whole.viscous, 1.5 * was.viscous, 1e-9);
    const auto level = friction_at(x_of(with_values(nominal, bound(scale("x.friction.coulomb")), {1.5})), v);
    EXPECT_NEAR(level.level, 1.5 * was.level, 1e-9);
    EXPECT_EQ(level.viscous, was.viscous);
    const auto viscous =
        friction_at(x_of(with_values(nominal, bound(scale("x.friction.viscous")), {1.5})), v);
    EXPECT_NEAR(viscous.level, was.level, 1e-9);
    EXPECT_NEAR(viscous.viscous, 1.5 * was.viscous, 1e-9);
  }
  const sim::Machine stiff = with_values(nominal, bound(scale("x.friction.stiffness")), {2.0});
  const auto& law = std::get<friction::LuGre<double>>(x_of(stiff).friction.dynamics);
  const auto& before = std::get<friction::LuGre<double>>(x_of(nominal).friction.dynamics);
  EXPECT_EQ(law.sigma0, 2.0 * before.sigma0);
  EXPECT_NEAR(law.sigma1, std::sqrt(2.0) * before.sigma1, 1e-6);
  // The other axis, the limits and the name plates stay.
  EXPECT_EQ(friction_at(y_of(stiff), 2e-3).level, friction_at(y_of(nominal), 2e-3).level);
  EXPECT_EQ(stiff.axes[0].second.name_plate().force, nominal.axes[0].second.name_plate().force);
}

TEST(StudyFactors, FrictionOfAConventionalMap) {
  sim::Machine nominal = built_in_machine("uniaxial-drive");
  const std::string text = "machine = \"m.toml\"\ncontrollers = [\"a\"]\n" + scale("x.friction.viscous");
  const auto file = io::read_toml_text<StudyFile>(text, "study.toml");
  const auto factors = bind_factors(file, io::parse_toml(text, "study.toml"), "study.toml", nominal, {0});
  const auto was = friction_at(x_of(nominal), 5e-3);
  const auto now = friction_at(x_of(with_values(nominal, factors, {3.0})), 5e-3);
  EXPECT_EQ(now.level, was.level);
  EXPECT_NEAR(now.viscous, 3.0 * was.viscous, 1e-12);
}

TEST(StudyFactors, KeysOfTheMachineFile) {
  const sim::Machine nominal = table();
  EXPECT_EQ(x_of(with_values(nominal, bound(scale("x.mass")), {2.0})).mass, 2.0 * x_of(nominal).mass);
  const auto both = with_values(nominal, bound(scale("*.mass")), {2.0});
  EXPECT_EQ(y_of(both).mass, 2.0 * y_of(nominal).mass);
  const auto value =
      factor("y.noise.rms", "value = { kind = \"uniform\", low = \"5 N\", high = \"0.04 kN\" }");
  EXPECT_EQ(bound(value).front().head(), "y.noise.rms [N]");
  EXPECT_EQ(y_of(with_values(nominal, bound(value), {7.0})).noise->rms, 7.0);
  EXPECT_EQ(sim::support(bound(value).front().distribution)[1], 40.0);
  const auto peak = with_values(nominal, bound(scale("x.friction.steady.positive.gaussians[2].a")), {2.0});
  const auto& map = std::get<friction::Gaussian<double>>(x_of(peak).friction.steady);
  EXPECT_NEAR(map.positive.gaussians[1].a, 2.0 * 509.3, 1e-9);
  EXPECT_NEAR(map.positive.gaussians[0].a, 517.4, 1e-9);
  const auto periods = factor("x.delay_periods", "value = { kind = \"list\", values = [\"0\", \"2\"] }");
  EXPECT_EQ(x_of(with_values(nominal, bound(periods), {2.0})).delay_periods, 2);
  // Masses in files are N s2/mm, in SI kg.
  const auto mass =
      bound(factor("x.mass", "value = { kind = \"normal\", mean = \"57 N s2/mm\", sd = \"2 N s2/mm\" }"));
  EXPECT_EQ(mass.front().head(), "x.mass [N s2/mm]");
  EXPECT_NEAR(mass.front().shown(57000.0), 57.0, 1e-12);
  const auto light =
      bound(factor("x.mass", "value = { kind = \"uniform\", low = \"40 kg\", high = \"55 kg\" }"));
  EXPECT_EQ(light.front().head(), "x.mass [kg]");
  EXPECT_EQ(light.front().in_words(), "uniform, 40 to 55 kg");
}

TEST(StudyFactors, ActInTheirOrder) {
  const auto value = factor("x.mass", "value = { kind = \"list\", values = [\"10 kg\"] }");
  EXPECT_EQ(x_of(with_values(table(), bound(value + scale("*.mass")), {10.0, 3.0})).mass, 30.0);
  EXPECT_EQ(x_of(with_values(table(), bound(scale("*.mass") + value), {3.0, 10.0})).mass, 10.0);
}

TEST(StudyFactors, RefusalsSayWhatToDo) {
  EXPECT_EQ(refused(scale("x.frction")),
            "study.toml:5: factors[1]: \"x.frction\": \"frction\" is no key there (meant \"friction\"?)");
  EXPECT_THAT(refused(scale("x.friction.steady.alpha0")),
              HasSubstr("\"alpha0\" is no key there (known: velocity_range, positive, negative)"));
  EXPECT_THAT(refused(scale("z.mass")),
              HasSubstr("expected AXIS.KEY with one of the axes that move, x and y, or *"));
  EXPECT_THAT(refused(scale("x.axial_mode.frequency")), HasSubstr("the machine file has no \"axial_mode\""));
  EXPECT_THAT(refused(scale("x.drive.gain")), HasSubstr("a drive cannot be a factor"));
  EXPECT_THAT(refused(scale("x.encoder.side")), HasSubstr("expected the key of a number"));
  EXPECT_THAT(refused(scale("x.mass.kg")),
              HasSubstr("\"mass\" is a value, expected the end of the key there"));
  EXPECT_THAT(refused(scale("x.load")), HasSubstr("is 0 on axis x, which no scale changes (give value)"));
  EXPECT_THAT(refused(scale("x.delay_periods")), HasSubstr("takes whole numbers"));
  EXPECT_THAT(refused(scale("x.friction.steady.positive.gaussians[9].a")), HasSubstr("has 3 items"));
  EXPECT_THAT(refused(scale("x.friction.steady.positive.gaussians.a")), HasSubstr("expected one of them"));
  EXPECT_THAT(refused(scale("x.mass[1]")), HasSubstr("\"mass\" is no list"));
  EXPECT_THAT(refused(factor("x.delay_periods", "value = { kind = \"list\", values = [\"0.5\"] }")),
              HasSubstr("takes whole numbers"));
  EXPECT_THAT(refused(factor("x.delay_periods", "value = { kind = \"list\", values = [\"9\"] }")),
              HasSubstr("value reaches 9 on axis x, expected 0 to 8"));
  EXPECT_THAT(refused(factor("x.friction", "value = { kind = \"list\", values = [\"9\"] }")),
              HasSubstr("expected scale in place of value"));
  EXPECT_THAT(refused(factor("x.mass", "scale = { kind = \"normal\", mean = 1.0, sd = 0.3 }")),
              HasSubstr("expected above 0 N s2/mm (set its low)"));
  EXPECT_THAT(refused(scale("x.mass") + scale("x.mass")), HasSubstr("is a factor already"));
}

TEST(StudyFactors, ImpossibleMachinesAreFound) {
  sim::Machine m = table();
  EXPECT_EQ(why_impossible(m, {0, 1}), "");
  // A level below zero somewhere: a negative peak that grows.
  auto& map = std::get<friction::Gaussian<double>>(m.axes[1].second.plant.friction.steady);
  map.positive.gaussians[0].a = -5000.0;
  EXPECT_THAT(why_impossible(m, {0, 1}),
              HasSubstr("y.friction.steady.positive: friction without its viscous part"));
  EXPECT_EQ(why_impossible(m, {0}), "");
}

}  // namespace
}  // namespace stribeck::workflow::factors_test
