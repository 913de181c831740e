/// The verbs as a user types them.

#include <nlohmann/json.hpp>

#include "command.hpp"

namespace stribeck::test::cli_test {
namespace {

TEST(Command, TellsItsVersionAndHelpsWithAnExample) {
  EXPECT_EQ(command({"--version"}).out, "stribeck 0.1.0\n");
  for (const std::string verb : {"compare", "identify", "excite", "simulate"}) {
    const Said said = command({verb, "--help"});
    EXPECT_EQ(said.code, 0);
    EXPECT_NE(said.out.find("Example"), std::string::npos) << verb;
  }
}

TEST(Command, WalksFromMachineToCompensatedContour) {
  Folder f;
  for (const std::string axis : {"x", "y"}) {
    for (const std::string method : {"pulses", "sine"}) {
      std::vector<std::string> words{"excite", kMachine, "--method", method,
                                     "--axis", axis,     "-o",       f / (axis + method)};
      if (method == "sine") words.insert(words.end(), {"--periods", "3"});
      const Said excite = command(words);
      ASSERT_EQ(excite.code, 0) << excite.err;
      const Said simulate = command({"simulate", kMachine, "--reference", f / (axis + method), "--axis", axis,
                                     "-o", f / (axis + method + "-log.csv")});
      ASSERT_EQ(simulate.code, 0) << simulate.err;
    }
    const Said identify =
        command({"identify", f / (axis + "pulses-log.csv"), f / (axis + "sine-log.csv"), "--axis", axis, "-o",
                 f / (axis + ".toml"), "--json", f / (axis + ".json"), "--quiet"});
    ASSERT_EQ(identify.code, 0) << identify.err;
    EXPECT_EQ(identify.out, "");
    const auto json = nlohmann::json::parse(text_of(f / (axis + ".json")));
    EXPECT_EQ(json["schema"], "stribeck.identify/1");
    EXPECT_NEAR(json["mass_kg"].get<double>(), axis == "x" ? 57650.0 : 58930.0, 600.0);
    EXPECT_GE(json["curve"].size(), 41U);
  }
  // Every verb writes its page where it is asked to.
  ASSERT_EQ(command({"excite", kMachine, "--method", "jog", "--axis", "x", "-o", f / "jog.csv", "--report",
                     f / "jog"})
                .code,
            0);
  EXPECT_NE(text_of(f / "jog/index.html").find("<svg"), std::string::npos);
  // Nothing is retyped: the axis files drive the controller.
  const Said run = command({"simulate", kMachine, "--controller", "f", "--path", "eight", "--laps", "1",
                            "--parameters", "thesis", "--axis-file", "x=" + (f / "x.toml"), "--axis-file",
                            "y=" + (f / "y.toml"), "-o", f / "trace.csv", "--json", f / "run.json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto json = nlohmann::json::parse(text_of(f / "run.json"));
  EXPECT_LT(json["rows"][0]["rms_um"].get<double>(), 1.0);
  EXPECT_GT(json["rows"][0]["rms_um"].get<double>(), 0.3);
  EXPECT_TRUE(json["rows"][0]["spread"]["rms_um"].is_null());
}

// In open loop every error grows with each slip: on this axis no number of sub-steps gives the same millimetre after
// four ramps up and down. It is simulated all the same, and each ramp slips.
TEST(Simulate, TakesABuiltInControllerByItsName) {
  Folder f;
  const auto simulate = [&](const std::string& controller) {
    return command({"simulate", kMachine, "--laps", "0.25", "--controller", controller, "-o", f / "log.csv"});
  };
  EXPECT_EQ(simulate("cascade").code, 0);
  const Said said = simulate("casacde");
  EXPECT_EQ(said.code, 2);
  EXPECT_NE(said.err.find("--controller: got \"casacde\", expected a file, one of the experiment's a, b, "),
            std::string::npos)
      << said.err;
  EXPECT_NE(said.err.find("or one of cascade, "), std::string::npos) << said.err;
}

TEST(Simulate, PlaysRampsOnAnAxisThatMultipliesErrors) {
  Folder f;
  const std::string machine = std::string(STRIBECK_SOURCE_DIR) + "/machines/triaxial-tool-5ms.toml";
  ASSERT_EQ(
      command({"excite", machine, "--method", "ramp", "--axis", "y", "-o", f / "r.csv", "--quiet"}).code, 0);
  const Said simulate =
      command({"simulate", machine, "--reference", f / "r.csv", "--axis", "y", "-o", f / "log.csv"});
  ASSERT_EQ(simulate.code, 0) << simulate.err;
  const Said identify =
      command({"identify", f / "log.csv", "--method", "break-away", "--json", f / "b.json"});
  ASSERT_EQ(identify.code, 0) << identify.err;
  EXPECT_EQ(identify.out.rfind("force and distance of break-away, from slow ramps, 8 slips\n", 0), 0U)
      << identify.out;
  const auto json = nlohmann::json::parse(text_of(f / "b.json"));
  // 30 N of static friction, ±11.2 N with the turn of the screw where the axis happens to rest.
  EXPECT_NEAR(json["parameters"][0]["value"].get<double>(), 30.0, 12.0);
}

TEST(Compare, GivesTheSameBytesOnAnyNumberOfThreads) {
  Folder f;
  for (const std::string threads : {"1", "2", "7"}) {
    const Said said = command({"compare", kMachine, "--trials", "2", "--speed", "9.5 mm/s", "--laps", "1",
                               "--threads", threads, "--json", f / (threads + ".json"), "--quiet"});
    ASSERT_EQ(said.code, 0) << said.err;
  }
  EXPECT_EQ(result_of(f / "1.json"), result_of(f / "2.json"));
  EXPECT_EQ(result_of(f / "1.json"), result_of(f / "7.json"));
  EXPECT_GT(text_of(f / "1.json").size(), 1000U);
}

TEST(Compare, WritesOneRowForEachSpeedAndController) {
  Folder f;
  ASSERT_EQ(command({"compare", kMachine, "--trials", "1", "--laps", "1", "--parameters", "thesis", "--speed",
                     "3 mm/s", "--speed", "9.5 mm/s", "--json", f / "o.json", "--quiet"})
                .code,
            0);
  const auto json = nlohmann::json::parse(text_of(f / "o.json"));
  EXPECT_EQ(json["schema"], "stribeck.compare/1");
  EXPECT_EQ(json["seed"], 1);
  ASSERT_EQ(json["rows"].size(), 12U);
  EXPECT_EQ(json["rows"][0]["controller"], "a");
  EXPECT_EQ(json["rows"][11]["controller"], "f");
  EXPECT_TRUE(json["rows"][0]["power_W"].is_null());
  EXPECT_EQ(json["rows"][0]["mean_abs_tracking_um"].size(), 2U);
}

}  // namespace
}  // namespace stribeck::test::cli_test
