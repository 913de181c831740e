// What a virtual axis is identified as, before controllers are compared on it.
#include <gtest/gtest.h>

#include <stribeck/friction/model.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/commission.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>
#include <string>

namespace stribeck::workflow::commission_test {
namespace {

/// Two alike axes of 120 kg; `more` belongs to the friction of x.
sim::Machine machine(const std::string& sample_time, const std::string& more = "") {
  std::string text = "name = \"table\"\nsample_time = \"" + sample_time + "\"\n";
  for (const std::string axis : {"x", "y"}) {
    const std::string plant = "[axes." + axis + ".plant";
    text +=
        plant + "]\nmass = \"120 kg\"\n" + plant + ".drive]\nkind = \"current\"\ngain = \"300 N/V\"\n" +
        plant + ".converter]\nbits = 16\nrange = \"10 V\"\n" + plant + ".encoder]\nresolution = \"30 nm\"\n" +
        plant +
        ".friction]\nsteady = { kind = \"conventional\", alpha0 = \"90 N\", alpha2 = \"0.9 N s/mm\", stribeck = { alpha1 = \"126 N\", "
        "v0 = \"1.1 mm/s\", delta = 2 } }\n"
        "dynamics = { kind = \"lugre\", sigma0 = \"45000 N/mm\", sigma1 = \"73 N s/mm\", damping_velocity = \"0.05 mm/s\" }\n" +
        (axis == "x" ? more : "") + plant + ".noise]\nrms = \"3 N\"\ncorrelation_time = \"6 ms\"\n[axes." +
        axis +
        ".limits]\ntravel_min = \"-150 mm\"\ntravel_max = \"150 mm\"\nspeed = \"200 mm/s\"\nacceleration = \"2000 mm/s2\"\n[axes." +
        axis +
        ".commissioning]\nmass = \"108 kg\"\nfriction = \"117 N\"\nomega = \"80 rad/s\"\nobserver_pole = \"30 1/s\"\n";
  }
  const test::Folder f;
  return read_virtual_machine(f.write("machine.toml", text));
}

// 12 kHz, whose multiple of half a millisecond rounding leaves a hair below it.
TEST(Commission, APeriodThatIsNoRoundNumberEnds) {
  const CommissionedAxis axis = commission_axis(machine("83.3333333333333 us"), 0, {.conventional = true}, 1);
  ASSERT_TRUE(axis.knowledge.whole);
  EXPECT_NEAR(axis.knowledge.whole->mass, 120.0, 6.0);
}

// Second differences of positions 31 us apart are noise of the encoder: three quarters of the mass were missing.
TEST(Commission, AShortPeriodHidesNoMass) {
  for (const char* sample_time : {"31.25 us", "1 ms"}) {
    const CommissionedAxis axis = commission_axis(machine(sample_time), 0, {.conventional = true}, 1);
    ASSERT_TRUE(axis.knowledge.conventional) << sample_time;
    EXPECT_NEAR(axis.knowledge.conventional->mass, 120.0, 12.0) << sample_time;
  }
}

// 2 N/mm about 30 mm: every model has it, and neither mass nor friction holds a part of it.
TEST(Commission, ASpringIsInEveryModel) {
  const std::string spring = "[axes.x.plant.friction.spring]\nstiffness = \"2 N/mm\"\nzero_at = \"30 mm\"\n";
  const CommissionedAxis axis =
      commission_axis(machine("1 ms", spring), 0,
                      {.conventional = true, .gaussian = true, .eccentric = true, .whole = true}, 1);
  // The files of a report are made of the results.
  ASSERT_EQ(axis.models.size(), 1U);
  for (const CommissionedModel& m : axis.models) EXPECT_TRUE(m.result.friction.spring) << m.kind;
  const sim::AxisKnowledge& k = axis.knowledge;
  for (const auto* model : {&k.conventional, &k.gaussian, &k.eccentric, &k.whole}) {
    ASSERT_TRUE(*model);
    const auto& found = (*model)->friction.spring;
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->stiffness, 2000.0, 100.0);
    // Load and spring together.
    for (const double x : {-0.02, 0.0, 0.03})
      EXPECT_NEAR((*model)->load + found->at(x), 2000.0 * (x - 0.03), 6.0) << x;
    EXPECT_NEAR((*model)->mass, 120.0, 4.0);
    const auto parts = (*model)->friction.parts(0.05, found->zero_at);
    EXPECT_NEAR(parts.level + parts.viscous, 90.0 + 45.0, 7.0);
  }
}

}  // namespace
}  // namespace stribeck::workflow::commission_test
