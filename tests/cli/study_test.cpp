#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.hpp"

namespace stribeck::test::study_test {
namespace {

using ::testing::HasSubstr;

const std::string kSource = STRIBECK_SOURCE_DIR;

class StudyVerb : public testing::Test {
 protected:
  /// A study of 20 machines with one text replaced, once.
  std::string study(const std::string& from = {}, const std::string& to = {}) const {
    std::string text = "machine = \"" + kSource +
                       "/machines/uniaxial-drive.toml\"\n"
                       "controllers = [\"a\", \"pid\"]\n"
                       "parameters = \"thesis\"\n"
                       "sampling = \"random\"\n"
                       "samples = 20\n"
                       "[[factors]]\n"
                       "key = \"x.friction\"\n"
                       "scale = { kind = \"uniform\", low = 0.7, high = 1.3 }\n";
    if (!from.empty()) {
      const auto at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    }
    return f.write("study.toml", text);
  }
  /// One clear line, exit code 2, and no folder left behind.
  void expect_refused(const std::string& from, const std::string& to, const std::string& part) const {
    const Said said = command({"study", study(from, to), "-o", f / "bad"});
    EXPECT_EQ(said.code, 2) << to << said.out;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
    EXPECT_THAT(said.err, testing::StartsWith("stribeck: "));
    EXPECT_THAT(said.err, HasSubstr(part));
    EXPECT_FALSE(std::filesystem::exists(f / "bad")) << to;
  }
  Folder f;
};

TEST_F(StudyVerb, WritesRowsSummaryAndPage) {
  const std::vector<std::string> words{"study",      study(),    "-o",       f / "o",     "--json",
                                       f / "s.json", "--report", f / "page", "--threads", "2"};
  const Said said = command(words);
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("20 machines that differ from \"uniaxial drive\": random draws, seed 1."));
  EXPECT_THAT(said.out, HasSubstr("Compensators: printed parameters of the thesis."));
  const auto json = nlohmann::json::parse(text_of(f / "s.json"));
  EXPECT_EQ(json["rows"].size(), 2U);
  EXPECT_EQ(json["rows"][0]["lost"], 0);
  EXPECT_THAT(text_of(f / "page/index.html"), HasSubstr("Study: uniaxial drive"));
  // Again: nothing is left to run, and the same comes out.
  const std::string rows = text_of(f / "o/results.csv");
  const std::string summary = text_of(f / "s.json");
  EXPECT_EQ(command(words).out, said.out);
  EXPECT_EQ(text_of(f / "o/results.csv"), rows);
  EXPECT_EQ(text_of(f / "s.json"), summary);
}

/// What a program of the netCDF project reads; empty where it is not installed.
std::string dump_of(const std::string& file) {
  std::string text;
  FILE* const pipe = ::popen(("ncdump '" + file + "' 2>/dev/null").c_str(), "r");
  char buffer[4096];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
  ::pclose(pipe);
  return text;
}

// More runs than are written at once, so that blocks meet.
TEST_F(StudyVerb, RowsAsNetcdfHaveTheValuesOfTheTable) {
  const std::string file = study("samples = 20", "samples = 600");
  const Said said = command({"study", file, "-o", f / "o", "--netcdf", f / "o/rows.nc"});
  if (said.err.find("libnetcdf") != std::string::npos) GTEST_SKIP() << said.err;
  ASSERT_EQ(said.code, 0) << said.err;
  const std::string dump = dump_of(f / "o/rows.nc");
  if (dump.empty()) GTEST_SKIP() << "ncdump is not installed";
  for (const char* part :
       {"run = 600 ;", "case = 2 ;", "double x_friction(run) ;", "x_friction:units = \"1\" ;",
        "x_friction:long_name = \"x.friction (scale)\" ;", "double max_contour_error_um(run, case) ;",
        "max_contour_error_um:units = \"um\" ;", "input_variation_V:units = \"V\" ;",
        "double mean_abs_tracking_um_x(run, case) ;", "state:flag_meanings = \"ok lost refused\" ;",
        ":title = \"Study of the machine uniaxial drive\" ;", "controller = \"a\", \"pid\" ;"})
    EXPECT_THAT(dump, HasSubstr(part));
  // Each number of the table, in its order; ncdump prints 15 digits.
  const std::size_t data = dump.find("\n x_friction =");
  ASSERT_NE(data, std::string::npos);
  std::istringstream rows(text_of(f / "o/results.csv"));
  std::istringstream numbers(dump.substr(data + 14));
  std::string line;
  std::getline(rows, line);
  for (int run = 0; run < 600; ++run) {
    std::getline(rows, line);
    const double in_table = std::stod(line.substr(line.find(',', line.find(',') + 1) + 1));
    std::getline(rows, line);
    double in_file = 0.0;
    char comma = 0;
    numbers >> in_file >> comma;
    ASSERT_NEAR(in_file, in_table, 1e-13) << run;
  }
}

TEST_F(StudyVerb, PathsCountFromTheFileOfTheStudy) {
  std::filesystem::create_directories(f / "below");
  f.write("below/m.toml", text_of(kSource + "/machines/uniaxial-drive.toml"));
  f.write("below/c.toml", text_of(kSource + "/controllers/pid.toml"));
  f.write("below/s.toml",
          "machine = \"m.toml\"\ncontrollers = [\"c.toml\"]\nparameters = \"thesis\"\nsamples = 2\n"
          "[[factors]]\nkey = \"x.mass\"\nscale = { kind = \"uniform\", low = 0.9, high = 1.1 }\n");
  const Said said = command({"study", f / "below/s.toml", "-o", f / "o"});
  EXPECT_EQ(said.code, 0) << said.err;
}

TEST_F(StudyVerb, BadFilesAreRefused) {
  expect_refused("x.friction", "x.frction",
                 "study.toml:8: factors[1]: \"x.frction\": \"frction\" is no key there");
  expect_refused("x.friction", "q.friction", "expected AXIS.KEY with one of the axes that move, x, or *");
  expect_refused("low = 0.7, high = 1.3", "low = 1.3, high = 1.3", "scale.high: expected a value above low");
  expect_refused("\"uniform\", low = 0.7, high = 1.3", "\"list\", values = []", "got an empty list");
  expect_refused("\"uniform\", low = 0.7, high = 1.3", "\"normal\", mean = 1.0, sd = -0.1",
                 "scale.sd: got -0.1, expected a standard deviation above 0");
  expect_refused("\"uniform\", low = 0.7, high = 1.3", "\"log-normal\", median = 0.0, sigma = 0.1",
                 "scale.median: got 0, expected a median above 0");
  expect_refused("low = 0.7", "low = nan", "factors[1].scale.low: got nan, expected a finite number");
  expect_refused("low = 0.7", "low = -0.7", "scale reaches -0.7, expected above 0 (set its low)");
  expect_refused("uniaxial-drive", "no-such-machine", "no-such-machine.toml: no such file");
  expect_refused("samples = 20", "samples = 0", "samples: got 0, expected 1 to 5000000");
  expect_refused("samples = 20", "samplse = 20", "unknown key (meant \"samples\"?)");
  expect_refused("\"pid\"", "\"pdi\"", "study.toml:2: controllers: got \"pdi\"");
  expect_refused("[[factors]]", "figures = [\"rms\"]\n[[factors]]", "study.toml:6: figures: got \"rms\"");
  expect_refused("[[factors]]", "[motion]\nexperiment = \"none\"\n[[factors]]",
                 "motion.experiment: got \"none\"");
  expect_refused("[[factors]]", "[motion]\nspeeds = [\"9 kg\"]\n[[factors]]", "study.toml:");
  expect_refused("sampling = \"random\"\nsamples = 20", "sampling = \"grid\"",
                 "a grid needs kind = \"list\" or \"steps\"");
}

TEST_F(StudyVerb, TenMillionPointsAreRefusedAtOnce) {
  f.write(
      "grid.toml",
      "machine = \"" + kSource +
          "/machines/uniaxial-drive.toml\"\ncontrollers = [\"a\"]\nsampling = \"grid\"\n"
          "[[factors]]\nkey = \"x.friction\"\nscale = { kind = \"steps\", low = 0.7, high = 1.3, points = 10000 }\n"
          "[[factors]]\nkey = \"x.mass\"\nscale = { kind = \"steps\", low = 0.7, high = 1.3, points = 1000 }\n");
  const Said said = command({"study", f / "grid.toml", "-o", f / "o"});
  EXPECT_EQ(said.code, 2);
  EXPECT_THAT(said.err, HasSubstr("factors: the grid has too many runs, expected at most 5000000"));
}

TEST_F(StudyVerb, ChangedResultsAreRefused) {
  const std::vector<std::string> words{"study", study(), "-o", f / "o"};
  ASSERT_EQ(command(words).code, 0);
  const std::string rows = text_of(f / "o/results.csv");
  std::vector<std::string> lines;
  std::istringstream in(rows);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  const auto with_cell = [&](std::size_t cell, const std::string& value) {
    std::vector<std::string> cells;
    std::istringstream row(lines[3]);
    for (std::string one; std::getline(row, one, ',');) cells.push_back(one);
    cells.at(cell) = value;
    std::string text;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (i != 3) {
        text += lines[i] + "\n";
        continue;
      }
      for (std::size_t c = 0; c < cells.size(); ++c) text += (c > 0 ? "," : "") + cells[c];
      text += "\n";
    }
    return text;
  };
  const auto count = static_cast<std::size_t>(std::count(lines[0].begin(), lines[0].end(), ','));
  // Sample, a drawn value, the controller, the state, a figure.
  const std::size_t state = static_cast<std::size_t>(std::count(
      lines[0].begin(), lines[0].begin() + static_cast<std::ptrdiff_t>(lines[0].find("state")), ','));
  for (const auto& [cell, value] : std::vector<std::pair<std::size_t, std::string>>{{1, "nan"},
                                                                                    {2, "9.999"},
                                                                                    {state - 2, "z"},
                                                                                    {state, "okay"},
                                                                                    {state, "refused"},
                                                                                    {state + 1, "banana"},
                                                                                    {state + 1, ""},
                                                                                    {count, "nan"},
                                                                                    {count, "inf"}}) {
    f.write("o/results.csv", with_cell(cell, value));
    const Said said = command(words);
    EXPECT_EQ(said.code, 2) << cell << " " << value;
    EXPECT_THAT(said.err, HasSubstr("results.csv:4: is no row that this study writes: the file was changed"));
  }
  f.write("o/results.csv", rows);
  EXPECT_EQ(command(words).code, 0);
}

TEST_F(StudyVerb, ResultsDoNotReplaceAnInput) {
  std::filesystem::create_directories(f / "o");
  f.write("o/results.csv", "t [s],x [mm]\n0,1\n");
  const Said said = command({"study", study(), "-o", f / "o"});
  EXPECT_EQ(said.code, 2);
  EXPECT_EQ(text_of(f / "o/results.csv"), "t [s],x [mm]\n0,1\n");
}

}  // namespace
}  // namespace stribeck::test::study_test
