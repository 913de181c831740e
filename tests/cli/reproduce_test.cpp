/// `reproduce`, and controllers of one's own in `compare`.

#include <map>
#include <nlohmann/json.hpp>
#include <stribeck/workflow/built_in.hpp>

#include "command.hpp"

namespace stribeck::test::reproduce_test {
namespace {

const std::string kSource = STRIBECK_SOURCE_DIR;

TEST(Reproduce, IsTheSameOnAnyNumberOfThreads) {
  Folder f;
  for (const char* threads : {"1", "3"}) {
    const std::string out = f / threads;
    const Said said =
        command({"reproduce", "uni-sim", "smc-circle", "--trials", "2", "--threads", threads, "--json",
                 out + ".json", "--markdown", out + ".md", "--report", out, "--quiet"});
    ASSERT_EQ(said.code, 0) << said.err;
  }
  for (const char* end : {".json", ".md", "/index.html"}) {
    const std::string one = text_of(f / (std::string("1") + end));
    EXPECT_FALSE(one.empty());
    EXPECT_EQ(one, text_of(f / (std::string("3") + end))) << end;
  }
  const auto json = nlohmann::json::parse(text_of(f / "1.json"));
  EXPECT_EQ(json["schema"], "stribeck.reproduce/1");
  EXPECT_EQ(json["sections"][0]["id"], "uni-sim");
  EXPECT_TRUE(json["sections"][0]["figures"].empty());
  const auto& mean = json["sections"][1]["figures"][0];
  EXPECT_EQ(mean["against"], "(a)");
  EXPECT_NEAR(mean["printed"].get<double>(), -28.6, 1e-9);
}

TEST(Reproduce, ChecksATableAndSaysWhereItDiffers) {
  Folder f;
  ASSERT_EQ(command({"reproduce", "uni-sim", "--trials", "2", "--markdown", f / "a.md", "--quiet"}).code, 0);
  EXPECT_EQ(command({"reproduce", "uni-sim", "--trials", "2", "--check", f / "a.md"}).code, 0);
  std::string text = text_of(f / "a.md");
  const auto at = text.find("(a) PD");
  ASSERT_NE(at, std::string::npos);
  const auto number = text.find_first_of("0123456789", text.find('|', at));
  text.insert(number, "9");
  f.write("b.md", text);
  const Said said = command({"reproduce", "uni-sim", "--trials", "2", "--check", f / "b.md"});
  EXPECT_EQ(said.code, 1);
  EXPECT_NE(said.err.find("b.md:"), std::string::npos) << said.err;
  // A sign that is lost, and a file that is not there.
  std::string signs = text_of(f / "a.md");
  const auto words = signs.find("one standard deviation");
  ASSERT_NE(words, std::string::npos);
  signs.replace(words, 3, "two");
  EXPECT_EQ(
      command({"reproduce", "uni-sim", "--trials", "2", "--check", f.write("c.md", signs), "--quiet"}).code,
      1);
  EXPECT_EQ(command({"reproduce", "uni-sim", "--trials", "2", "--check", f / "none.md"}).code, 2);
}

TEST(Reproduce, RefusesAnUnknownExperiment) {
  const Said said = command({"reproduce", "tri-square"});
  EXPECT_EQ(said.code, 2);
  EXPECT_NE(said.err.find("tri-square"), std::string::npos);
}

TEST(Compare, RunsEveryBuiltInLawBesideTheThesisOnes) {
  Folder f;
  std::vector<std::string> words{"compare",  kMachine,   "--parameters", "thesis", "--trials",
                                 "1",        "--speed",  "9.5 mm/s",     "--json", f / "o.json",
                                 "--report", f / "page", "--quiet"};
  const std::vector<std::string> laws{"pid",           "cascade",    "zpetc",
                                      "cross-coupled", "repetitive", "sliding-mode",
                                      "contouring",    "predictive", "learning"};
  for (const auto& law : laws) {
    words.emplace_back("--controller");
    words.push_back(law);
  }
  const Said said = command(words);
  ASSERT_EQ(said.code, 0) << said.err;
  const auto json = nlohmann::json::parse(text_of(f / "o.json"));
  ASSERT_EQ(json["rows"].size(), 6 + laws.size());
  // Each follows the circle about as well as (b), which has the same friction model: none is broken, none is magic.
  const double b = json["rows"][1]["rms_um"];
  for (std::size_t i = 6; i < json["rows"].size(); ++i) {
    EXPECT_GT(json["rows"][i]["rms_um"].get<double>(), 0.1 * b) << json["rows"][i]["label"];
    EXPECT_LT(json["rows"][i]["rms_um"].get<double>(), 2.0 * b) << json["rows"][i]["label"];
  }
}

TEST(Compare, RunsTheBuiltInControllersThatNeedBristles) {
  Folder f;
  const Said said =
      command({"compare", kMachine, "--trials", "1", "--speed", "9.5 mm/s", "--controller", "dynamic",
               "--controller", "kalman", "--controller", "reversal", "--json", f / "o.json", "--quiet"});
  ASSERT_EQ(said.code, 0) << said.err;
  const auto json = nlohmann::json::parse(text_of(f / "o.json"));
  std::map<std::string, double> max;
  for (const auto& row : json["rows"]) max[row["controller"]] = row["max_contour_error_um"];
  // The files are the controllers of the same kind among (g) and on, to the last bit of the trace's figures.
  EXPECT_EQ(max.at("dynamic"), max.at("h"));
  EXPECT_EQ(max.at("kalman"), max.at("i"));
  // A distance of 4 um in place of the bristles: worse than (j), far better than (f).
  EXPECT_GT(max.at("reversal"), max.at("j"));
  EXPECT_LT(max.at("reversal"), 0.5 * max.at("f"));
}

TEST(Compare, RefusesWhatWouldHaveNoEffect) {
  Folder f;
  std::string text = text_of(kSource + "/controllers/dynamic.toml");
  const auto set = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  set("observer = \"kalman\"\nobserver_pole = \"60 1/s\"",
      "observer = \"disturbance\"\nobserver_pole = \"20 1/s\"");
  set("\nerror_rate = \"observed\"", "");
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& key) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    const Said said = command({"compare", kMachine, "--controller", f.write("mine.toml", changed)});
    EXPECT_EQ(said.code, 2) << to;
    EXPECT_NE(said.err.find(key), std::string::npos) << said.err;
  };
  refused("feedforward = \"dynamic\"", "feedforward = \"steady\"", "adaptation");
  refused("friction = \"whole\"", "friction = \"none\"", "feedforward");
  refused("kv = [\"80 1/s\"]", "kv = [\"80 1/s\"]\nerror_rate = \"observed\"", "error_rate");
  refused("\"20 1/s\"", "\"1e60 1/s\"", "observer_pole");
  refused("observer_pole = \"20 1/s\"", "disturbance_density = \"1 N2/s\"",
          "disturbance_density: goes with observer = \"kalman\" only: set that, or leave this out");
  refused("observer_pole = \"20 1/s\"", "adaptive_gain = [\"5 1/s\"]", "adaptive_gain: goes with observer");
  refused("observer_pole = \"20 1/s\"", "reversal = {lead = \"1 ms\"}", "reversal: goes with feedforward");
  refused("adaptation = \"on\"", "adaptation = {memory = \"5 s\"}",
          "adaptation.memory: goes with enabled = true");
}

TEST(Compare, TakesTheSettingsOfAdaptationFromAFile) {
  Folder f;
  std::string text = text_of(kSource + "/controllers/dynamic.toml");
  const std::string word = "adaptation = \"on\"";
  text.replace(text.find(word), word.size(),
               "adaptation = {enabled = true, memory = \"5 s\", mass_spread = 0.3}");
  const sim::ControllerSpec c = workflow::read_controller(f.write("mine.toml", text));
  EXPECT_TRUE(c.adaptation.enabled);
  EXPECT_EQ(c.adaptation.memory, 5.0);
  EXPECT_EQ(c.adaptation.mass_spread, 0.3);
  EXPECT_EQ(c.adaptation.level_spread, control::AdaptationParams{}.level_spread);
}

TEST(Compare, BristlesAreNotPrinted) {
  const Said said = command({"compare", kMachine, "--parameters", "thesis", "--controller", "dynamic"});
  EXPECT_EQ(said.code, 2);
  EXPECT_NE(said.err.find("the thesis prints no pre-sliding parameters"), std::string::npos) << said.err;
}

TEST(Compare, TakesAControllerFromAFile) {
  Folder f;
  const std::string text = text_of(kSource + "/controllers/pid.toml");
  ASSERT_FALSE(text.empty());
  const std::string good = f.write("mine.toml", text);
  const auto with = [&](const std::string& file) {
    return command({"compare", kMachine, "--parameters", "thesis", "--trials", "1", "--speed", "9.5 mm/s",
                    "--controller", file, "--quiet"});
  };
  EXPECT_EQ(with(good).code, 0);
  // Unstable gains, an unknown law, a controller that is there already, no file.
  std::string bad = text;
  bad.replace(bad.find("27000 1/s3"), 10, "900000 1/s3");
  const Said unstable = with(f.write("bad.toml", bad));
  EXPECT_EQ(unstable.code, 2);
  EXPECT_NE(unstable.err.find("unstable"), std::string::npos) << unstable.err;
  std::string unknown = text;
  unknown.replace(unknown.find("kind = \"pid\""), 12, "kind = \"pdi\"");
  EXPECT_EQ(with(f.write("unknown.toml", unknown)).code, 2);
  std::string twice = text;
  twice.replace(twice.find("id = \"pid\""), 10, "id = \"a\"");
  EXPECT_EQ(with(f.write("twice.toml", twice)).code, 2);
  EXPECT_EQ(with(f / "none.toml").code, 2);
}

TEST(Compare, RunsTheExperimentsOfThreeAxes) {
  Folder f;
  const std::string tool = kSource + "/machines/triaxial-tool-5ms.toml";
  ASSERT_EQ(command({"compare", tool, "--parameters", "thesis", "--trials", "1", "--json", f / "o.json",
                     "--report", f / "page", "--quiet"})
                .code,
            0);
  const auto json = nlohmann::json::parse(text_of(f / "o.json"));
  EXPECT_EQ(json["experiment"], "tri-circle");
  EXPECT_EQ(json["rows"].size(), 3U);
  EXPECT_EQ(json["rows"][0]["mean_abs_tracking_um"].size(), 3U);
  EXPECT_TRUE(json["rows"][0]["speed_mm_per_s"].is_null());
  EXPECT_GT(json["rows"][0]["mean_abs_ui_W"].get<double>(), 0.0);
  // A path of three axes on two, and options of a path that the experiment has not.
  EXPECT_EQ(command({"compare", kMachine, "--experiment", "tri-circle"}).code, 2);
  EXPECT_EQ(command({"compare", tool, "--size", "20 mm"}).code, 2);
  EXPECT_EQ(
      command({"simulate", tool, "--experiment", "smc-free", "--controller", "f", "-o", f / "t.csv"}).code,
      2);
  EXPECT_EQ(command({"simulate", tool, "--experiment", "smc-free", "--controller", "b", "--parameters",
                     "thesis", "-o", f / "t.csv", "--quiet"})
                .code,
            0);
}

}  // namespace
}  // namespace stribeck::test::reproduce_test
