#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/sim/in_order.hpp>
#include <stribeck/workflow/study/study.hpp>

namespace stribeck::workflow {
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

}  // namespace
}  // namespace stribeck::workflow
