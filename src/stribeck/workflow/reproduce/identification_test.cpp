#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include <stribeck/friction/steady.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/report/html.hpp>
#include <stribeck/workflow/reproduce/identification.hpp>

namespace stribeck::test::identification_test {
namespace {

using report::ReproducedFigure;
using report::ReproducedSection;
using Sections = std::vector<ReproducedSection>;

constexpr std::uint64_t kSeed = 1;

/// The machine with some of its axes.
sim::Machine machine(const std::string& name, const std::vector<std::string>& axes) {
  auto m = io::read_toml<sim::Machine>(std::string(STRIBECK_SOURCE_DIR) + "/machines/" + name + ".toml");
  std::erase_if(m.axes,
                [&](const auto& a) { return std::find(axes.begin(), axes.end(), a.first) == axes.end(); });
  return m;
}

struct Reproduced {
  sim::Machine v2;
  sim::Machine v3;
  Sections sections;

  explicit Reproduced(const std::string& id, const std::vector<std::string>& axes_v3 = {"y"})
      : v2(machine("biaxial-table", {"x", "y"})),
        v3(machine("triaxial-tool", axes_v3)),
        sections(workflow::reproduce_identification({id}, v2, v3, kSeed, 0)) {
    for (const ReproducedSection& s : sections) complete(s, id);
  }

  /// What every section must have.
  static void complete(const ReproducedSection& s, const std::string& id) {
    EXPECT_EQ(s.id, id);
    EXPECT_FALSE(s.remarks.empty()) << s.id;
    EXPECT_FALSE(s.plots.empty()) << s.id;
    for (const auto& [plots, caption] : s.plots) {
      EXPECT_FALSE(caption.empty()) << s.id;
      for (const report::Plot& p : plots) {
        for (const report::Series& series : p.series) {
          EXPECT_GT(series.x.size(), 3U) << p.title << ": " << series.label;
          EXPECT_TRUE(series.style == report::Style::kBand || series.x.size() == series.y.size()) << p.title;
        }
      }
    }
    for (const ReproducedFigure& f : s.figures)
      EXPECT_TRUE(std::isfinite(f.ours)) << s.id << ": " << f.what << f.of;
  }
};

const sim::MachineAxis& axis(const sim::Machine& m, const std::string& name) {
  for (const auto& [found, a] : m.axes) {
    if (found == name) return a;
  }
  throw std::out_of_range(name);
}

const ReproducedFigure& figure(const ReproducedSection& s, const std::string& what, const std::string& of) {
  for (const ReproducedFigure& f : s.figures) {
    if (f.what == what && f.of == of) return f;
  }
  throw std::out_of_range(what + " of " + of);
}

/// Number in the table, in the row that begins with these texts.
double cell(const ReproducedSection& s, const std::vector<std::string>& row, std::size_t column) {
  for (const auto& r : s.table.rows) {
    bool same = true;
    for (std::size_t i = 0; i < row.size(); ++i) same = same && r[i].text == row[i];
    if (same) return std::strtod(r[column].text.c_str(), nullptr);
  }
  throw std::out_of_range(row.back());
}

// The machine files were transcribed from the thesis by themselves: two transcriptions must agree.
void expect_printed(const ReproducedSection& s, const std::string& what, const std::string& of,
                    double published) {
  EXPECT_NEAR(figure(s, what, of).printed, published, 1e-9) << what << " of " << of;
}

TEST(ReproduceIdentification, PulsesAndJogsTellTheMachine) {
  const Reproduced r("ident-A");
  const ReproducedSection& s = r.sections.at(0);
  for (const std::string name : {"x", "y"}) {
    const friction::AxisModel& published = *axis(r.v2, name).published.conventional;
    const auto& line = std::get<friction::Conventional<double>>(published.friction.steady);
    expect_printed(s, "mass", name, published.mass * 1e-3);
    expect_printed(s, "α0, v > 0", name, line.alpha0);
    expect_printed(s, "α2", name, line.alpha2 * 1e-3);
    const double truth = axis(r.v2, name).plant.mass * 1e-3;
    // Half an interval is 1.1 to 1.8 N s2/mm. The printed method counts rows in the dead band as "no friction", which biases the
    // mass by 10 %.
    EXPECT_NEAR(figure(s, "mass", name).ours, truth, 0.04 * truth) << name;
    EXPECT_LT(figure(s, "mass", name).low, truth) << name;
    EXPECT_GT(figure(s, "mass", name).high, truth) << name;
    // Without Coulomb friction the mass is wrong by far more.
    EXPECT_GT(cell(s, {name, "simple, all pulses"}, 2), 1.3 * truth) << name;
    // Two seconds of noise of 20 N, 47 ms: a mean is good to 20·sqrt(2·0.047/2) = 4 N. The slope over 2·5
    // speeds of a spread of 3.3 mm/s is good to 0.4 N s/mm, the levels to 3 N; four times that.
    for (const std::string observer : {"jogs, observer", "jogs, Kalman"}) {
      EXPECT_NEAR(cell(s, {name, observer}, 3), cell(s, {name, "line through Table 2.3 at the jogs"}, 3), 1.8)
          << name;
      for (const std::size_t level : {4U, 5U}) {
        EXPECT_NEAR(cell(s, {name, observer}, level),
                    cell(s, {name, "line through Table 2.3 at the jogs"}, level), 12.0)
            << name;
      }
    }
  }
}

TEST(ReproduceIdentification, JogsTellTheMachine) {
  const Reproduced r("ident-B");
  const ReproducedSection& table = r.sections.at(0);
  for (const std::string name : {"x", "y"}) {
    const double truth = axis(r.v2, name).plant.mass * 1e-3;
    EXPECT_NEAR(figure(table, "mass", name).ours, truth, 0.02 * truth) << name;  // its interval is ± 0.8 %
    EXPECT_NEAR(cell(table, {name, "jogs"}, 3), cell(table, {name, "line through Table 2.3 at the jogs"}, 3),
                1.2)
        << name;
    for (const std::size_t level : {4U, 5U}) {
      EXPECT_NEAR(cell(table, {name, "jogs"}, level),
                  cell(table, {name, "line through Table 2.3 at the jogs"}, level), 10.0)
          << name;
    }
  }
  // 0.5 N of noise, and up to 11 N of sine that is taken off the means: a tenth of a newton is left.
  const ReproducedSection& tool = r.sections.at(1);
  const auto& print =
      std::get<friction::Conventional<double>>(axis(r.v3, "y").published.conventional->friction.steady);
  expect_printed(tool, "α0", "y", print.alpha0);
  expect_printed(tool, "α1", "y", print.stribeck->alpha1);
  expect_printed(tool, "α2", "y", print.alpha2 * 1e-3);
  expect_printed(tool, "v0", "y", print.stribeck->v0 * 1e3);
  const auto& truth = std::get<friction::Conventional<double>>(axis(r.v3, "y").plant.friction.steady);
  EXPECT_NEAR(figure(tool, "α0", "y").ours, truth.alpha0, 0.3);
  EXPECT_NEAR(figure(tool, "α1", "y").ours, truth.stribeck->alpha1, 0.4);
  EXPECT_NEAR(figure(tool, "α2", "y").ours, truth.alpha2 * 1e-3, 0.04);
  EXPECT_NEAR(figure(tool, "v0", "y").ours, truth.stribeck->v0 * 1e3, 0.05);
}

TEST(ReproduceIdentification, CurvesOfTable23AreReached) {
  const Reproduced r("ident-C");
  const ReproducedSection& s = r.sections.at(0);
  for (const std::string name : {"x", "y"}) {
    const auto& map =
        std::get<friction::Gaussian<double>>(axis(r.v2, name).published.gaussian->friction.steady);
    for (const int v : {-9, -5, -1, 1, 5, 9}) {
      expect_printed(s, "friction at " + std::to_string(v) + " mm/s", name + (v > 0 ? ", v ≥ 0" : ", v < 0"),
                     friction::steady_force(map, 1e-3 * v));
    }
  }
  for (const std::string of : {"x, v ≥ 0", "x, v < 0", "y, v ≥ 0", "y, v < 0"}) {
    const double percent = figure(s, "the same, of the printed curve", of).ours;
    EXPECT_LT(percent, 2.0) << of;  // of the printed curve
    EXPECT_GT(percent, 0.05)
        << of;  // 20 N of noise leave more than that: less would mean that the truth was used
    const double terms = figure(s, "number of Gaussians", of).ours;
    EXPECT_GE(terms, 2.0) << of;  // 3 to 5 for seeds 1 to 7
    EXPECT_LE(terms, 5.0) << of;
    EXPECT_GE(figure(s, "the same, by the peaks of the map", of).ours, 1.0) << of;
  }
}

TEST(ReproduceIdentification, EccentricTermOfTable24IsReached) {
  const Reproduced r("ident-D", {"y", "z"});
  const ReproducedSection& s = r.sections.at(0);
  double off = 0.0;
  for (const std::string name : {"y", "z"}) {
    const friction::AxisModel& published = *axis(r.v3, name).published.eccentric;
    const auto& base = std::get<friction::Conventional<double>>(published.friction.steady);
    expect_printed(s, "η0", name, base.alpha0);
    expect_printed(s, "η1", name, base.alpha2 * 1e-3);
    expect_printed(s, "η2", name, published.friction.eccentric[0].amplitude);
    expect_printed(s, "η3", name, published.friction.eccentric[0].phase);
    expect_printed(s, "mass", name, published.mass * 1e-3);
    expect_printed(s, "load", name, published.load);
    const auto near = [&](const char* what, double bound) {
      const ReproducedFigure& f = figure(s, what, name);
      EXPECT_NEAR(f.ours, f.printed, bound) << what << " of " << name;
      EXPECT_GT(f.high - f.low, 0.0) << what << " of " << name;
      off += std::abs(f.ours - f.printed);
    };
    near("η0", 0.3);  // intervals are ± 0.08 N, ± 0.01 N s/mm
    near("η1", 0.04);
    near("η2", 0.03 * figure(s, "η2", name).printed);  // issue 3
    near("η3", 0.03);                                  // issue 3
    near("period", 0.004);
    near("mass", 0.01);
    near("load", 0.1);
  }
  EXPECT_GT(off, 1e-3);  // nothing of the truth goes in
}

TEST(ReproduceIdentification, BetterModelsPredictBetter) {
  const Reproduced r("verify");
  const ReproducedSection& table = r.sections.at(0);
  const auto error = [](const ReproducedSection& s, const std::string& model) {
    return figure(s, "velocity error, RMS", model).ours;
  };
  EXPECT_LT(error(table, "Model C"), 0.5 * error(table, "Model B"));
  EXPECT_LT(error(table, "Model B"), error(table, "Model A"));
  // The machine's own parameters leave the noise: no model is better by more than chance, and C has the
  // error of its fit besides.
  const double floor = cell(table, {"the machine itself"}, 1);
  EXPECT_GT(error(table, "Model C"), 0.9 * floor);
  EXPECT_LT(error(table, "Model C"), 3.0 * floor);

  // Free from the first row on, a model without bristles may stick at a reversal by chance. Started anew, D is
  // at 0.32 to 0.52 mm/s for seeds 1 to 7, A at 0.73 to 0.88, the machine itself at 0.09 to 0.11.
  const ReproducedSection& tool = r.sections.at(1);
  EXPECT_LT(cell(tool, {"Model D"}, 3), 0.8 * cell(tool, {"Model A"}, 3));
  EXPECT_GT(cell(tool, {"Model D"}, 3), cell(tool, {"the machine itself"}, 3));
  EXPECT_LT(cell(tool, {"whole, with bristles"}, 3), 0.6 * cell(tool, {"Model D"}, 3));
  for (const std::string model : {"Model A", "Model B", "Model D"}) {
    EXPECT_GT(error(tool, model), 0.05) << model;
    EXPECT_LT(error(tool, model), 2.0) << model;  // of 5.7 mm/s
  }
}

TEST(ReproduceIdentification, DependsOnTheSeedAndOnNothingElse) {
  const sim::Machine v2 = machine("biaxial-table", {"x"});
  const sim::Machine v3 = machine("triaxial-tool", {"y"});
  const auto run = [&](const std::vector<std::string>& ids, std::uint64_t seed, unsigned threads = 1) {
    return workflow::reproduce_identification(ids, v2, v3, seed, threads);
  };
  const Sections several = run({"ident-A"}, kSeed, 3);
  const ReproducedSection& s = several.at(0);
  const Sections one = run({"ident-C", "ident-A"}, kSeed);
  ASSERT_EQ(one.size(), 2U);
  EXPECT_EQ(one[0].id, "ident-C");
  ASSERT_EQ(one[1].figures.size(), s.figures.size());
  for (std::size_t i = 0; i < s.figures.size(); ++i) {
    EXPECT_EQ(one[1].figures[i].ours, s.figures[i].ours) << s.figures[i].what;
    EXPECT_EQ(one[1].figures[i].low, s.figures[i].low) << s.figures[i].what;
  }
  EXPECT_EQ(one[1].remarks, s.remarks);

  const Sections other = run({"ident-A"}, kSeed + 1);
  EXPECT_NE(other[0].figures[0].ours, s.figures[0].ours);
  // Off by the scatter that the intervals promise, not more.
  EXPECT_NEAR(other[0].figures[0].ours, s.figures[0].ours, 1.5 * (s.figures[0].high - s.figures[0].low));
}

TEST(ReproduceIdentification, NothingAskedIsNothing) {
  const sim::Machine v2 = machine("biaxial-table", {"x"});
  EXPECT_TRUE(workflow::reproduce_identification({}, v2, machine("triaxial-tool", {"y"}), kSeed, 1).empty());
}

}  // namespace
}  // namespace stribeck::test::identification_test
