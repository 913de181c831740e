#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <set>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/axis_file.hpp>
#include <stribeck/sim/in_order.hpp>
#include <stribeck/workflow/built_in.hpp>
#include <stribeck/workflow/study/study.hpp>
#include <thread>
#include <vector>

namespace stribeck::workflow::study_test {
namespace {

using test::Folder;
using test::text_of;
using testing::HasSubstr;

const std::string kMachines = std::string(STRIBECK_SOURCE_DIR) + "/machines/";

std::string with_machine(const std::string& more) {
  return "machine = \"" + kMachines +
         "uniaxial-drive.toml\"\ncontrollers = [\"a\", \"pid\"]\nparameters = \"thesis\"\n" +
         "figures = [\"rms_um\", \"input_variation_V\"]\n" + more;
}
constexpr const char* kFriction =
    "[[factors]]\nkey = \"x.friction\"\nscale = { kind = \"uniform\", low = 0.7, high = 1.3 }\n";
constexpr const char* kMass =
    "[[factors]]\nkey = \"x.mass\"\nscale = { kind = \"normal\", mean = 1.0, sd = 0.05 }\n";

report::StudyResult run(const Folder& f, const std::string& text, const std::string& folder,
                        unsigned threads = 2) {
  const std::string file = f.write("study.toml", text);
  std::filesystem::create_directories(f / folder);
  return run_study(read_study(file), {f / folder, threads, "1"});
}

TEST(Study, SameBytesOnAnyNumberOfThreads) {
  Folder f;
  const std::string text = with_machine("samples = 40\nseed = 7\n") + kFriction + kMass;
  const auto one = run(f, text, "one", 1);
  const auto three = run(f, text, "three", 3);
  EXPECT_EQ(text_of(f / "one/results.csv"), text_of(f / "three/results.csv"));
  EXPECT_EQ(report::text_table(one), report::text_table(three));
  const std::string rows = text_of(f / "one/results.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1 + 2 * 40);
  EXPECT_THAT(rows,
              testing::StartsWith("run,sample,x.friction (scale),x.mass (scale),controller,motion,state,"
                                  "at_limit_percent,rms_um,input_variation_V\n0,0,"));
}

TEST(Study, SharedByThreeItIsTheSameBytes) {
  Folder f;
  const std::string text = with_machine("samples = 60\nseed = 7\n") + kFriction + kMass;
  const auto alone = run(f, text, "alone");
  std::filesystem::create_directories(f / "shared");
  const Study study = read_study(f / "study.toml");
  std::array<std::optional<report::StudyResult>, 3> results;
  std::array<std::atomic<std::uint64_t>, 3> done{};
  {
    std::vector<std::jthread> processes;
    for (unsigned k = 0; k < 3; ++k) {
      processes.emplace_back([&, k] {
        StudyOptions o{f / "shared", 1, "1", k};
        o.progress = [&, k](std::uint64_t n, std::uint64_t) { done[k] = n; };
        results[k] = run_shared_study(study, o, {});
      });
    }
  }
  EXPECT_EQ(text_of(f / "shared/results.csv"), text_of(f / "alone/results.csv"));
  // One of them led, and tells the result.
  std::vector<std::string> told;
  for (const auto& r : results) {
    if (r) told.push_back(report::text_table(*r));
  }
  ASSERT_FALSE(told.empty());
  for (const std::string& t : told) EXPECT_EQ(t, report::text_table(alone));
  EXPECT_EQ(std::max({done[0].load(), done[1].load(), done[2].load()}), 60U);
  // Nothing is left of the sharing.
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(f / "shared"))
    names.insert(entry.path().filename().string());
  EXPECT_THAT(names, testing::ElementsAre("inputs.txt", "results.csv"));
  // It goes on from any place, here within a block.
  const std::string rows = text_of(f / "alone/results.csv");
  f.write("shared/results.csv", rows.substr(0, rows.size() / 2));
  const auto second = run_shared_study(study, {f / "shared", 2, "1"}, {});
  ASSERT_TRUE(second);
  EXPECT_EQ(text_of(f / "shared/results.csv"), rows);
  // Of a finished study the first process tells the result, and no other.
  EXPECT_FALSE(run_shared_study(study, {f / "shared", 2, "1", 1}, {}));
  EXPECT_TRUE(run_shared_study(study, {f / "shared", 2, "1", 0}, {}));
}

TEST(Study, GoesOnWhereItStopped) {
  Folder f;
  const std::string text = with_machine("samples = 12\n") + kFriction;
  const auto whole = report::text_table(run(f, text, "a"));
  const std::string rows = text_of(f / "a/results.csv");
  for (const std::size_t n : {std::size_t{3}, std::size_t{400}, rows.size() - 1}) {
    std::filesystem::create_directories(f / "b");
    f.write("b/inputs.txt", text_of(f / "a/inputs.txt"));
    f.write("b/results.csv", rows.substr(0, n));
    EXPECT_EQ(report::text_table(run(f, text, "b")), whole) << n;
    EXPECT_EQ(text_of(f / "b/results.csv"), rows) << n;
  }
}

// More samples of random draws and of a Sobol' sequence begin with the earlier ones, so that the study goes on.
TEST(Study, MoreSamplesGoOn) {
  Folder f;
  for (const std::string sampling : {"random", "sobol"}) {
    const std::string more = "sampling = \"" + sampling + "\"\nsamples = ";
    run(f, with_machine(more + "5\n") + kFriction, sampling);
    const std::string first = text_of(f / (sampling + "/results.csv"));
    run(f, with_machine(more + "9\n") + kFriction, sampling);
    EXPECT_THAT(text_of(f / (sampling + "/results.csv")), testing::StartsWith(first));
    run(f, with_machine(more + "9\n") + kFriction, sampling + "-at-once");
    EXPECT_EQ(text_of(f / (sampling + "/results.csv")), text_of(f / (sampling + "-at-once/results.csv")));
  }
  // The parts of a Latin hypercube depend on their number.
  run(f, with_machine("samples = 5\n") + kFriction, "latin");
  EXPECT_THROW(run(f, with_machine("samples = 9\n") + kFriction, "latin"), io::InputError);
}

TEST(Study, AnotherStudyIsRefused) {
  Folder f;
  run(f, with_machine("samples = 4\n") + kFriction, "o");
  const std::string before = text_of(f / "o/results.csv");
  for (const std::string& other :
       {with_machine("samples = 4\nseed = 2\n") + kFriction, with_machine("samples = 4\n") + kMass}) {
    try {
      run(f, other, "o");
      ADD_FAILURE();
    } catch (const io::InputError& e) {
      EXPECT_THAT(e.problems().front().text(), HasSubstr("holds the runs of another study"));
    }
  }
  EXPECT_EQ(text_of(f / "o/results.csv"), before);
}

// Sample 0 of a factor that changes nothing is the nominal machine under its own noise.
TEST(Study, AScaleOfOneIsTheNominalMachine) {
  Folder f;
  const auto r = run(f,
                     with_machine("samples = 1\n") +
                         "[[factors]]\nkey = \"x.friction\"\nscale = { kind = \"list\", values = [1.0] }\n",
                     "o");
  ASSERT_EQ(r.rows.size(), 2U);
  for (const auto& row : r.rows) {
    for (const auto& figure : row.figures) EXPECT_EQ(figure.spread.smallest(), figure.nominal);
  }
  EXPECT_GT(r.rows[0].figures[0].nominal, 1.0);
}

TEST(Study, MoreFrictionIsMoreErrorWithoutCompensation) {
  Folder f;
  const auto r =
      run(f,
          with_machine("sampling = \"grid\"\n") +
              "[[factors]]\nkey = \"x.friction\"\nscale = { kind = \"list\", values = [0.5, 1.0, 2.0] }\n",
          "o");
  const auto& rms = r.rows[0].figures[0];
  EXPECT_EQ(rms.spread.count(), 3U);
  EXPECT_GT(rms.spread.largest(), 1.5 * rms.nominal);
  EXPECT_LT(rms.spread.smallest(), 0.7 * rms.nominal);
}

TEST(Study, AGridHasEveryCombination) {
  Folder f;
  const std::string file = f.write(
      "study.toml",
      with_machine("sampling = \"grid\"\n") +
          "[[factors]]\nkey = \"x.friction\"\nscale = { kind = \"list\", values = [0.8, 1.2] }\n"
          "[[factors]]\nkey = \"x.mass\"\nvalue = { kind = \"steps\", low = \"40 kg\", high = \"60 kg\", points = 3 }\n");
  const Study study = read_study(file);
  ASSERT_EQ(study.runs, 6U);
  const sim::Design design = study.design();
  EXPECT_EQ(study.values(design, 0), (std::vector<double>{0.8, 40.0}));
  EXPECT_EQ(study.values(design, 2), (std::vector<double>{0.8, 60.0}));
  EXPECT_EQ(study.values(design, 3), (std::vector<double>{1.2, 40.0}));
  EXPECT_EQ(study.values(design, 5), (std::vector<double>{1.2, 60.0}));
}

TEST(Study, SamplesOfIndicesShareTheirValues) {
  Folder f;
  const std::string file =
      f.write("study.toml", with_machine("samples = 8\nindices = true\n") + kFriction + kMass);
  const Study study = read_study(file);
  ASSERT_EQ(study.runs, 32U);
  const sim::Design design = study.design();
  for (std::uint64_t n = 0; n < 8; ++n) {
    const auto a = study.values(design, 4 * n);
    const auto b = study.values(design, 4 * n + 1);
    EXPECT_NE(a[0], b[0]);
    EXPECT_EQ(study.values(design, 4 * n + 2), (std::vector<double>{b[0], a[1]}));
    EXPECT_EQ(study.values(design, 4 * n + 3), (std::vector<double>{a[0], b[1]}));
  }
}

// Without compensation the error follows friction; a few per cent of mass matter little.
TEST(Study, IndicesFindTheFactorThatMatters) {
  Folder f;
  const auto r =
      run(f, with_machine("sampling = \"sobol\"\nsamples = 64\nindices = true\n") + kFriction + kMass, "o");
  const auto& rms = r.rows[0].figures[0];
  EXPECT_EQ(rms.index_samples, 64U);
  // Quantiles are those of the independent runs.
  EXPECT_EQ(rms.spread.count(), 128U);
  ASSERT_EQ(rms.indices.size(), 2U);
  EXPECT_NEAR(rms.indices[0].total.value, 1.0, 0.1);
  EXPECT_LT(rms.indices[1].total.value, 0.05);
  EXPECT_LE(rms.indices[0].total.low, rms.indices[0].total.value);
}

// A loop that is lost counts as infinite; here by a delay that the PID does not bear.
TEST(Study, LostRunsAreCounted) {
  Folder f;
  const auto r = run(
      f,
      with_machine("sampling = \"grid\"\n") +
          "[[factors]]\nkey = \"x.delay_periods\"\nvalue = { kind = \"list\", values = [\"0\", \"8\"] }\n",
      "o");
  const auto& pid = r.rows[1];
  EXPECT_EQ(pid.lost, 1U);
  EXPECT_EQ(pid.figures[0].spread.infinite(), 1U);
  EXPECT_THAT(text_of(f / "o/results.csv"), HasSubstr(",lost,"));
  EXPECT_THAT(report::text_table(r), HasSubstr("lost on 1 of 2 machines, 50.0 %"));
}

TEST(Study, AFigureWithoutAnyValueIsSaid) {
  Folder f;
  const auto warnings = [&](const std::string& figures, const std::string& folder) {
    std::string text = with_machine("samples = 3\n") + kMass;
    const std::string usual = "[\"rms_um\", \"input_variation_V\"]";
    text.replace(text.find(usual), usual.size(), figures);
    return run(f, text, folder).warnings;
  };
  EXPECT_THAT(warnings("[\"rms_um\", \"max_orientation_error_urad\"]", "a"),
              testing::ElementsAre(HasSubstr("figure max_orientation_error_urad: no run has a value")));
  EXPECT_THAT(warnings("[\"rms_um\"]", "b"), testing::IsEmpty());
}

TEST(Study, ImpossibleDrawsAreFoundBeforeTheFirstRun) {
  Folder f;
  const std::string text =
      "machine = \"" + kMachines +
      "biaxial-table.toml\"\ncontrollers = [\"f\"]\nparameters = \"thesis\"\nsamples = 50\n" +
      "[[factors]]\nkey = \"x.friction.steady.positive.eta0\"\nvalue = { kind = \"uniform\", low = \"-900 N\", high = \"900 N\" }\n";
  try {
    run(f, text, "o");
    ADD_FAILURE();
  } catch (const io::InputError& e) {
    EXPECT_THAT(e.problems().front().text(), HasSubstr("study.toml: factors: run "));
    EXPECT_THAT(e.problems().front().text(),
                HasSubstr("makes a machine that cannot be: x.friction.steady.positive"));
  }
  const std::string rows = text_of(f / "o/results.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1);
}

std::string identified(const std::string& how, const std::string& factors) {
  return "machine = \"" + kMachines +
         "uniaxial-drive.toml\"\ncontrollers = [\"reversal\"]\nfigures = [\"rms_um\"]\nseed = 3\n" +
         "identification = \"" + how + "\"\n" + factors;
}

// One machine whose runs have no noise, identified again and again: its error is a band where one identification gives a single number.
TEST(Study, RepeatedIdentificationIsABand) {
  Folder f;
  const std::string quiet =
      "sampling = \"random\"\nsamples = 4\n"
      "[[factors]]\nkey = \"x.noise.rms\"\nvalue = { kind = \"list\", values = [\"0 N\"] }\n";
  EXPECT_EQ(run(f, identified("once", quiet), "once").rows[0].figures[0].spread.deviation(), 0.0);
  const auto r = run(f, identified("repeated", quiet), "one", 1);
  static_cast<void>(run(f, identified("repeated", quiet), "two", 2));
  EXPECT_EQ(text_of(f / "one/results.csv"), text_of(f / "two/results.csv"));
  const sim::Spread& rms = r.rows[0].figures[0].spread;
  EXPECT_GT(rms.deviation(), 0.0);
  EXPECT_LT(rms.deviation(), rms.mean());
  EXPECT_THAT(r.parameters, HasSubstr("identified again in every sample under other noise"));
  // Without any factor.
  const auto alone = run(f, identified("repeated", "sampling = \"random\"\nsamples = 2\n"), "alone");
  EXPECT_THAT(report::text_table(alone),
              testing::StartsWith("2 runs of \"uniaxial drive\": random draws, seed 3."));
}

// Half the friction: a model from the machine's own logs is better than one from the nominal machine.
TEST(Study, AMachineOfItsOwnLogs) {
  Folder f;
  const std::string half =
      "samples = 1\n[[factors]]\nkey = \"x.friction\"\nscale = { kind = \"list\", values = [0.5] }\n";
  std::string pid = identified("once", half);
  pid.replace(pid.find("\"reversal\""), 10, "\"a\", \"reversal\"");
  const double once = run(f, pid, "once").rows[1].figures[0].spread.mean();
  pid.replace(pid.find("once"), 4, "of-each-machine");
  const auto own = run(f, pid, "own");
  EXPECT_LT(own.rows[1].figures[0].spread.mean(), 0.7 * once);
  EXPECT_THAT(own.parameters, HasSubstr("each machine from its own logs"));
}

TEST(Study, SettingsOfIdentificationAreChecked) {
  const auto refused = [](const std::string& text) {
    Folder f;
    try {
      static_cast<void>(read_study(f.write("study.toml", text)));
    } catch (const io::InputError& e) {
      return e.problems().front().text();
    }
    return std::string("nothing");
  };
  EXPECT_EQ(refused(identified("repeated", "")), "nothing");
  EXPECT_THAT(refused(identified("once", "")), HasSubstr("factors: got none, expected one or more"));
  EXPECT_THAT(refused(identified("repeated", "indices = true\n")), HasSubstr("indices: there is no factor"));
  EXPECT_THAT(refused(identified("repeated", "sampling = \"grid\"\n")),
              HasSubstr("sampling: a grid needs factors"));
  EXPECT_THAT(refused(identified("repeated", "parameters = \"thesis\"\n")),
              HasSubstr("identification: goes with parameters = \"identified\" only"));
}

TEST(InOrder, HandsOverInOrderAndStopsAtTheFirstError) {
  for (const unsigned threads : {1U, 2U, 5U}) {
    std::vector<std::uint64_t> seen;
    sim::in_order(
        3, 500, threads, [](std::uint64_t i) { return i * i; },
        [&](std::uint64_t i, std::uint64_t square) {
          EXPECT_EQ(square, i * i);
          seen.push_back(i);
        });
    ASSERT_EQ(seen.size(), 497U);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    seen.clear();
    EXPECT_THROW(sim::in_order(
                     0, 500, threads,
                     [](std::uint64_t i) {
                       if (i == 40) throw std::runtime_error("40");
                       return i;
                     },
                     [&](std::uint64_t i, std::uint64_t) { seen.push_back(i); }),
                 std::runtime_error);
    EXPECT_EQ(seen.size(), 40U);
    EXPECT_THROW(sim::in_order(
                     0, 500, threads, [](std::uint64_t i) { return i; },
                     [](std::uint64_t i, std::uint64_t) {
                       if (i == 7) throw std::runtime_error("7");
                     }),
                 std::runtime_error);
  }
}

// ---- what the logs leave open

/// An axis file of the uniaxial drive with 2 % of mass and 5 % of friction open.
std::string axis_file(const Folder& f, bool open) {
  sim::AxisFile file;
  const sim::Machine machine = built_in_machine("uniaxial-drive");
  const plant::AxisParams& plant = machine.axes[0].second.plant;
  file.model = {plant.mass, plant.load, plant.friction};
  if (open) {
    friction::ModelDeviation mass, friction;
    mass.mass = 0.02 * plant.mass;
    const double level = friction::steady_force(plant.friction, 1e-3);
    friction.level = {0.05 * level, 0.05 * level};
    file.uncertainty = friction::ModelUncertainty{5e-3, 0.0, {mass, friction}};
  }
  return f.write(open ? "open.toml" : "closed.toml", io::write_toml(file));
}
std::string with_axis_file(const Folder& f, bool open, const std::string& more) {
  std::string text =
      with_machine("samples = 60\nseed = 3\naxis_files = [\"x=" +
                   std::filesystem::path(axis_file(f, open)).filename().string() + "\"]\n" + more);
  text.erase(text.find("parameters = \"thesis\"\n"), 22);
  return text;
}
constexpr const char* kUncertainty = "[[factors]]\nkey = \"*.uncertainty\"\n";

TEST(Study, WhatTheLogsLeaveOpenIsABand) {
  Folder f;
  const report::StudyResult r = run(f, with_axis_file(f, true, kUncertainty), "out");
  ASSERT_TRUE(r.has_band);
  ASSERT_EQ(r.factors.size(), 2U);
  EXPECT_EQ(r.factors[1].key, "x.uncertainty.2");
  const std::string rows = text_of(f / "out/results.csv");
  EXPECT_THAT(rows, testing::StartsWith("run,sample,x.uncertainty.1,x.uncertainty.2,controller"));
  EXPECT_THAT(report::text_table(r), HasSubstr("Band of 95 %"));
  const sim::Spread& spread = r.rows[0].figures[0].spread;
  EXPECT_GT(spread.largest(), 1.02 * spread.smallest());
}

TEST(Study, TheModelOfTheAxisFileIsTheMachine) {
  Folder f;
  const std::string file = f.write("study.toml", with_axis_file(f, true, kUncertainty));
  const Study study = read_study(file);
  const sim::Machine drawn = with_values(study.machine, study.factors, {1.0, -2.0});
  const plant::AxisParams& nominal = study.machine.axes[0].second.plant;
  const plant::AxisParams& plant = drawn.axes[0].second.plant;
  EXPECT_NEAR(plant.mass / nominal.mass, 1.02, 1e-9);
  EXPECT_NEAR(friction::steady_force(plant.friction, 1e-3) / friction::steady_force(nominal.friction, 1e-3),
              0.9, 1e-9);
}

TEST(Study, DoesNotGoOnWithAnotherUncertainty) {
  Folder f;
  run(f, with_axis_file(f, true, kUncertainty), "out");
  const std::string study = f / "study.toml";
  std::string axis = text_of(f / "open.toml");
  const std::string level = "level = [\"";
  axis.replace(axis.rfind(level) + level.size(), 1, "9");
  f.write("open.toml", axis);
  EXPECT_THROW(run_study(read_study(study), {f / "out", 2, "1"}), io::InputError);
}

TEST(Study, DoesNotGoOnWithAnotherCompensationOfLostMotion) {
  Folder f;
  std::string study = with_axis_file(f, true, kUncertainty);
  const std::string axis = text_of(f / "open.toml");
  f.write("open.toml", axis + "\n[lost_motion]\nbacklash = \"12 um\"\n");
  run(f, study, "out");
  f.write("open.toml", axis + "\n[lost_motion]\nbacklash = \"2 um\"\n");
  EXPECT_THROW(run(f, study, "out"), io::InputError);
}

TEST(Study, DoesNotGoOnOnAnotherPath) {
  Folder f;
  const std::string study =
      "machine = \"" + kMachines +
      "biaxial-table.toml\"\ncontrollers = [\"a\"]\nparameters = \"thesis\"\nsamples = 2\n"
      "figures = [\"rms_um\"]\nmotion = { path = \"p.csv\", speeds = [\"9.5 mm/s\"] }\n" +
      kFriction;
  f.write("p.csv", "x [mm],y [mm]\n10,0\n12,3\n14,0\n");
  run(f, study, "out");
  run(f, study, "out");
  f.write("p.csv", "x [mm],y [mm]\n11,0\n12,3\n14,0\n");
  EXPECT_THROW(run(f, study, "out"), io::InputError);
}

TEST(Study, WithOtherFactorsThereIsNoBand) {
  Folder f;
  EXPECT_FALSE(run(f, with_axis_file(f, true, kUncertainty + std::string(kMass)), "out").has_band);
}

TEST(Study, SaysWhereTheLogsEnd) {
  Folder f;
  const std::string text = with_axis_file(f, true, kUncertainty);
  std::string axis = text_of(f / "open.toml");
  const std::string key = "told_from = \"0 mm/s\"";
  ASSERT_NE(axis.find(key), std::string::npos);
  axis.replace(axis.find(key), key.size(), "told_from = \"3 mm/s\"");
  f.write("open.toml", axis);
  const report::StudyResult r = run(f, text, "out");
  EXPECT_THAT(r.warnings,
              testing::ElementsAre(HasSubstr("of its motion is slower than 3 mm/s, where the logs behind"),
                                   HasSubstr("the logs of x tell its friction from 3 mm/s on")));
}

TEST(Study, AnUncertaintyNeedsAnAxisFileThatSaysIt) {
  Folder f;
  const auto refused = [&](const std::string& text) {
    try {
      static_cast<void>(read_study(f.write("study.toml", text)));
    } catch (const io::InputError& e) {
      return e.problems().front().text();
    }
    return std::string("nothing");
  };
  EXPECT_THAT(
      refused(with_machine(kUncertainty)),
      HasSubstr("axis x has no axis file, expected one that identify wrote (add \"x=FILE\" to axis_files)"));
  EXPECT_THAT(refused(with_machine("[[factors]]\nkey = \"x.uncertanty\"\n")),
              HasSubstr("expected AXIS.uncertainty"));
  EXPECT_THAT(refused(with_axis_file(f, false, kUncertainty)),
              HasSubstr("does not say what its logs leave open (identify the axis again"));
  std::string grid = with_axis_file(f, true, "sampling = \"grid\"\n" + std::string(kUncertainty));
  grid.erase(grid.find("samples = 60\n"), 13);
  EXPECT_THAT(refused(grid), HasSubstr("a grid has no place for an uncertainty"));
  EXPECT_THAT(
      refused(with_axis_file(f, true, std::string(kUncertainty) + "[[factors]]\nkey = \"x.uncertainty\"\n")),
      HasSubstr("the uncertainty of axis x is a factor already"));
  EXPECT_THAT(
      refused(with_axis_file(
          f, true,
          "[[factors]]\nkey = \"x.uncertainty\"\nscale = { kind = \"uniform\", low = 1, high = 2 }\n")),
      HasSubstr("takes neither scale nor value"));
}

}  // namespace
}  // namespace stribeck::workflow::study_test
