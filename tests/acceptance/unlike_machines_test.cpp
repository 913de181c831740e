// Machines whose friction no model of Stribeck matches, identified through files only, as a user would; then once more with logs of the
// circles that they travelled.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tests/cli/command.hpp>
#include <vector>

namespace stribeck::test::unlike_machines_test {
namespace {

using Words = std::vector<std::string>;

class UnlikeMachine : public testing::TestWithParam<const char*> {
 protected:
  void run(const Words& words) {
    Words quiet = words;
    quiet.emplace_back("--quiet");
    const Said said = command(quiet);
    ASSERT_EQ(said.code, 0) << words.front() << ": " << said.err;
  }
  /// Logs of pulses and of a sine on each axis.
  void record() {
    for (const char* axis : {"x", "y"}) {
      for (const char* method : {"pulses", "sine"}) {
        const std::string reference = folder_ / (std::string(axis) + method + ".csv");
        run({"excite", machine_, "--method", method, "--axis", axis, "-o", reference});
        run({"simulate", machine_, "--reference", reference, "--axis", axis, "-o", log(axis, method)});
      }
    }
  }
  std::string log(const std::string& axis, const std::string& method) {
    return folder_ / (axis + method + "-log.csv");
  }
  void identify(const std::string& to, const Words& more) {
    for (const char* axis : {"x", "y"}) {
      Words words{"identify", machine_, "--axis", axis, log(axis, "pulses"), log(axis, "sine")};
      words.insert(words.end(), more.begin(), more.end());
      words.insert(words.end(), {"-o", folder_ / (to + "-" + axis)});
      run(words);
    }
  }
  Words models(const std::string& of) {
    Words words;
    for (const std::string axis : {"x", "y"}) {
      words.insert(
          words.end(),
          {"--axis-file", axis + "=" + std::string(folder_ / (of + "-" + axis + "/" + axis + ".toml"))});
    }
    return words;
  }
  /// Ten laps under the default controller with these models.
  std::string circle(const std::string& of, const std::string& speed) {
    const std::string to = folder_ / (of + "-circle-" + speed.substr(0, 1) + ".csv");
    Words words{"simulate", machine_, "--path", "circle", "--size", "10 mm", "--speed",
                speed,      "--laps", "10",     "--seed", "7",      "-o",    to};
    const Words known = models(of);
    words.insert(words.end(), known.begin(), known.end());
    run(words);
    return to;
  }
  /// Mean over both speeds of the largest contour error [um], by controller.
  std::map<std::string, double> compare(const std::string& of) {
    const std::string json = folder_ / (of + ".json");
    Words words{"compare", machine_, "--experiment", "own",      "--size",   "10 mm",
                "--speed", "3 mm/s", "--speed",      "9.5 mm/s", "--trials", "4",
                "--only",  "f,h,i",  "--accuracy",   "20 nm",    "--json",   json};
    const Words known = models(of);
    words.insert(words.end(), known.begin(), known.end());
    run(words);
    std::map<std::string, double> mean;
    const nlohmann::json result = nlohmann::json::parse(text_of(json));
    for (const auto& row : result.at("rows"))
      mean[row["controller"].get<std::string>()] += 0.5 * row["max_contour_error_um"].get<double>();
    return mean;
  }

  const Folder folder_;
  const std::string machine_ = std::string(STRIBECK_SOURCE_DIR) + "/machines/" + GetParam() + ".toml";
};

// The aim is 0.8 um and a tenth of (f) from pulses and sine alone, which is missed: friction differs along the travel, and these logs
// pass a part of it. With the circles the aim is 0.5 um: 0.49 and 0.53.
TEST_P(UnlikeMachine, CirclesThatWereTravelledTellWhatTheExcitationDidNot) {
  ASSERT_NO_FATAL_FAILURE(record());
  ASSERT_NO_FATAL_FAILURE(identify("first", {}));
  std::map<std::string, double> first = compare("first");
  const std::string slow = circle("first", "3 mm/s");
  const std::string fast = circle("first", "9.5 mm/s");
  ASSERT_NO_FATAL_FAILURE(identify("refined", {slow, fast}));
  std::map<std::string, double> refined = compare("refined");
  for (const auto& [id, error] : first)
    std::printf("%s (%s): %.2f um from pulses and sine, %.2f with ten laps\n", GetParam(), id.c_str(), error,
                refined[id]);
  EXPECT_LT(first["h"], 0.15 * first["f"]);
  EXPECT_LT(first["h"], 1.1 * first["i"]);
  EXPECT_LT(refined["h"], 0.6);
  EXPECT_LT(refined["h"], 0.1 * refined["f"]);
  EXPECT_LT(refined["h"], 1.2 * refined["i"]);
}

INSTANTIATE_TEST_SUITE_P(Files, UnlikeMachine, testing::Values("unlike-table", "unlike-two-mass-table"),
                         [](const auto& machine) {
                           std::string name = machine.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace stribeck::test::unlike_machines_test
