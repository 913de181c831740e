/// Chapter 4 on the virtual triaxial tool: what the frame does, and the figures that were agreed for contouring and sliding mode.

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <stribeck/io/toml.hpp>
#include <stribeck/sim/experiments.hpp>

#include "../cli/command.hpp"

namespace stribeck::test::triaxial_tool_test {
namespace {

using path::FrameKind;
using sim::FrameDerivatives;

const std::string kMachines = std::string(STRIBECK_SOURCE_DIR) + "/machines/";

sim::Machine machine(const std::string& name) {
  return io::read_toml<sim::Machine>(kMachines + name + ".toml");
}

std::vector<sim::AxisKnowledge> printed(const sim::Machine& m) {
  std::vector<sim::AxisKnowledge> all;
  for (const auto& [name, axis] : m.axes)
    all.push_back({axis.published.conventional, axis.published.gaussian, axis.published.eccentric});
  return all;
}

sim::CompareSpec spec_of(const char* id) {
  const auto all = sim::experiments();
  return sim::find_experiment(all, id)->settings.front().spec;
}

/// One trial of a controller on (4.25) with a frame.
sim::Metrics free_form(const std::string& name, const sim::ControllerSpec& controller, FrameKind kind,
                       FrameDerivatives derivatives) {
  const sim::Machine m = machine(name);
  sim::CompareSpec s = spec_of("smc-free");
  s.controllers = {controller};
  s.trials = 1;
  s.travels[0].frame = kind;
  s.travels[0].frame_derivatives = derivatives;
  return sim::compare(m, printed(m), s).rows[0].mean;
}

TEST(Frames, ABinormalThatIsNotNormalisedLosesThePathTowardsInflections) {
  // (4.25): the gains vanish with the binormal. A hundred micrometres at least; 8 um with a frame that is one.
  const sim::ControllerSpec b = spec_of("smc-free").controllers[1];
  const double literal =
      free_form("triaxial-tool", b, FrameKind::kPrinted, FrameDerivatives::kExact).max_contour_error;
  EXPECT_GE(literal, 100e-6);
  EXPECT_LE(literal, 600e-6);
  EXPECT_LE(
      free_form("triaxial-tool", b, FrameKind::kTransported, FrameDerivatives::kExact).max_contour_error,
      12e-6);
}

TEST(Frames, DerivativesDifferencedAcrossAFlipSpike) {
  // The contouring law with the conventional model: 54 against 14 um. Sliding mode feels it less (13 against 8 um), as its
  // switching part pulls the other way.
  const sim::ControllerSpec b = spec_of("tri-circle").controllers[1];
  const double differenced =
      free_form("triaxial-tool-5ms", b, FrameKind::kFrenet, FrameDerivatives::kDifferenced).max_contour_error;
  const double continuous =
      free_form("triaxial-tool-5ms", b, FrameKind::kTransported, FrameDerivatives::kExact).max_contour_error;
  EXPECT_GE(differenced, 3.0 * continuous);
  EXPECT_LE(differenced, 20.0 * continuous);
}

/// Largest difference of the contour error between Frenet's and the transported frame, both with exact derivatives, without
/// noise and quantisers.
double between_frames(const sim::Travel& path) {
  const sim::Machine m = machine("triaxial-tool");
  sim::ControllerSpec c = spec_of("tri-circle").controllers[1];
  std::vector<sim::ContourSample> seen[2];
  for (const int which : {0, 1}) {
    sim::Travel travel = path;
    travel.frame = which == 0 ? FrameKind::kTransported : FrameKind::kFrenet;
    const auto route = sim::sample<3>(travel, m.sample_time);
    sim::Drives drives(m, {0, 1, 2}, 0.05);
    const auto setup = sim::make_setup<3>(m, printed(m), {0, 1, 2}, c);
    drives.run<3>(sim::make_controller<3>(c.law, setup), route, {8, false, false}, 1, 0, &seen[which]);
  }
  double worst = 0.0;
  for (std::size_t k = 0; k < seen[0].size(); ++k)
    worst = std::max(worst, std::abs(seen[0][k].contour_error - seen[1][k].contour_error));
  return worst;
}

TEST(Frames, OnAPlanePathEitherFrameGivesTheSameLoop) {
  // n and b of Frenet flip, the law does not notice: what is left is rounding, amplified by friction at reversals.
  EXPECT_LE(between_frames(spec_of("smc-free").travels[0]), 1e-9);
  EXPECT_LE(between_frames(spec_of("tri-free").travels[0]), 1e-9);
}

TEST(Frames, OnAPathWithTorsionTheyDiffer) {
  // Gains across the path differ (60 and 40 rad/s), and Frenet's normals turn about the tangent with the torsion.
  path::Fourier<3> p;
  p.axis[0].terms = {path::Harmonic{10e-3, 1.0, 0.0}};
  p.axis[1].terms = {path::Harmonic{10e-3, 1.0, -0.5 * kPi}};
  p.axis[2].terms = {path::Harmonic{6e-3, 2.0, -0.5 * kPi}};
  sim::Travel t = spec_of("tri-circle").travels[0];
  t.path = p;
  EXPECT_GE(between_frames(t), 0.5e-6);
}

/// Figures of `reproduce`, by setting and row of the table of claims.
class Reproduced : public testing::Test {
 protected:
  using Figures = std::map<std::string, nlohmann::json>;

  static nlohmann::json run(const std::vector<std::string>& ids) {
    Folder f;
    std::vector<std::string> words{"reproduce"};
    words.insert(words.end(), ids.begin(), ids.end());
    for (const char* w : {"--json", "", "--quiet"}) words.emplace_back(w);
    words[words.size() - 2] = f / "o.json";
    const Said said = command(words);
    EXPECT_EQ(said.code, 0) << said.err;
    return nlohmann::json::parse(text_of(f / "o.json"));
  }
  /// Change of a figure in per cent, by the beginning of its name.
  static double change(const nlohmann::json& section, const std::string& what) {
    for (const auto& f : section["figures"]) {
      if (f["what"].get<std::string>().rfind(what, 0) == 0 && !f["against"].is_null())
        return f["ours"].get<double>();
    }
    ADD_FAILURE() << "no figure " << what << " in " << section["id"] << " " << section["setting"];
    return std::nan("");
  }
  /// A column of the table of all controllers, as numbers.
  static std::vector<double> column(const nlohmann::json& section, const std::string& head) {
    std::vector<double> values;
    const auto& columns = section["table"]["columns"];
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i].get<std::string>().rfind(head, 0) != 0) continue;
      for (const auto& row : section["table"]["rows"]) values.push_back(std::stod(row[i].get<std::string>()));
    }
    return values;
  }
};

TEST_F(Reproduced, ContouringWithTheEccentricModel) {
  for (const auto& s : run({"tri-circle", "tri-free"})["sections"]) {
    SCOPED_TRACE(s["id"].get<std::string>() + " " + s["setting"].get<std::string>());
    EXPECT_LE(change(s, "mean contour error"), -16.0);
    EXPECT_LE(change(s, "maximum contour error"), 0.0);
    const auto mean = column(s, "mean |ε|");
    ASSERT_EQ(mean.size(), 3U);
    EXPECT_GT(mean[0], mean[1]);
    EXPECT_GT(mean[1], mean[2]);
    EXPECT_GT(mean[2], 0.2);  // the quadrants remain
  }
}

TEST_F(Reproduced, SlidingModeWithAdaptiveFriction) {
  for (const auto& s : run({"smc-circle", "smc-free"})["sections"]) {
    const std::string setting = s["setting"];
    if (setting.find("frame") != std::string::npos) continue;  // the frames that are no frames
    SCOPED_TRACE(s["id"].get<std::string>() + " " + setting);
    const bool circle = s["id"] == "smc-circle";
    const bool printed_parameters = setting.find("printed") != std::string::npos;
    const bool slow = setting.rfind("5 ms", 0) == 0;
    const double bound = printed_parameters ? (slow ? -30.0 : circle ? -20.0 : -12.0) : (slow ? -25.0 : 0.0);
    EXPECT_LE(change(s, "mean contour error"), bound);
    EXPECT_LT(change(s, "power"), 0.0);
    const auto variation = column(s, "mean |Δu|");
    ASSERT_EQ(variation.size(), 2U);
    EXPECT_LE(variation[1], 0.75 * variation[0]);
  }
}

TEST_F(Reproduced, OneAxisAndTwo) {
  const auto json = run({"uni-exp", "bi-circle", "bi-eight", "bi-trifolium"});
  for (const auto& s : json["sections"]) {
    SCOPED_TRACE(s["id"].get<std::string>() + " " + s["setting"].get<std::string>());
    if (s["id"] == "uni-exp") {
      const auto mean = column(s, "mean |e|");
      if (mean.size() < 5) continue;  // fig 3.3 has one controller
      // Each model is better than the one before; the observer has nothing left to find at the higher gain.
      for (std::size_t i = 1; i < 4; ++i) EXPECT_LT(mean[i], mean[i - 1]) << i;
      EXPECT_LE(mean[4], mean[3] + 0.02);
      EXPECT_LE(mean[3] / mean[2], 1.0 - 0.37);
      EXPECT_LE(mean[4], 0.3);
      continue;
    }
    // The order of Tables 3.1 and 3.2 that every speed shares: friction models help, with and without observer. That the observer
    // alone helps (a) holds on the circle; on the eight its late answer to a reversal costs more than friction does.
    const auto rms = column(s, "RMS");
    for (std::size_t i = 0; i + 6 <= rms.size(); i += 6) {
      EXPECT_GT(rms[i], rms[i + 1]);
      EXPECT_GT(rms[i + 1], rms[i + 2]);
      if (s["id"] == "bi-circle") {
        EXPECT_GT(rms[i], rms[i + 3]);
      }
      EXPECT_GT(rms[i + 3], rms[i + 4]);
      EXPECT_GE(rms[i + 4], rms[i + 5]);
    }
  }
}

}  // namespace
}  // namespace stribeck::test::triaxial_tool_test
