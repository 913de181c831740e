#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include <apps/web/identify_view.hpp>
#include <stribeck/core/scalar.hpp>

namespace stribeck::web::identify_view_test {
namespace {

using nlohmann::ordered_json;

/// Strokes of a sine: 4 kg m2, 20 N m of friction, 0.1 N m s/deg.
std::string turning_log() {
  std::string text = "t [s],c [deg],c_ref [deg],M [N m]\n";
  for (int k = 0; k < 16000; ++k) {
    const double t = 1e-3 * k;
    const double w = 2.0 * kPi * 0.5;
    const double v = 10.0 * w * std::cos(w * t);  // [deg/s]
    const double a = -10.0 * w * w * std::sin(w * t) * kPi / 180.0;
    const double friction = 20.0 * std::tanh(v / 0.2) + 0.1 * v + 0.2 * std::sin(37.0 * k);
    text += fmt::format("{:.3f},{:.6f},{:.6f},{:.6f}\n", t, 10.0 * std::sin(w * t), 10.0 * std::sin(w * t),
                        4.0 * a + friction);
  }
  return text;
}

class IdentifyViewTest : public testing::Test {
 protected:
  IdentifyRequest asked() {
    IdentifyRequest r;
    r.logs = {uploads_.add("log.csv", turning_log()).id};
    return r;
  }
  Uploads uploads_;
  IdentifyView view_{uploads_, "0"};
};

TEST_F(IdentifyViewTest, ShowsAnAxisThatTurnsInItsUnits) {
  IdentifyRequest r = asked();
  r.lead = "360 deg";
  const ordered_json shown = view_.identify(r)["shown"];
  EXPECT_EQ(shown["rotary"], true);
  EXPECT_EQ(shown["force"], "N m");
  EXPECT_EQ(shown["velocity"], "deg/s");
  EXPECT_NEAR(shown["per_velocity"].get<double>(), 0.0573, 1e-4);  // of mrad/s
  bool viscous = false;
  for (const ordered_json& p : shown["parameters"]) {
    if (p["name"] == "mass") {
      EXPECT_EQ(p["unit"], "kg m2");
    }
    if (p["name"] != "viscous_positive") continue;
    viscous = true;
    EXPECT_EQ(p["unit"], "N m s/deg");
    EXPECT_NEAR(p["value"].get<double>(), 0.1, 0.01);
  }
  EXPECT_TRUE(viscous);
}

TEST_F(IdentifyViewTest, AColumnThatIsNotUsedCanBeChosenAgain) {
  IdentifyRequest r = asked();
  ordered_json log = view_.inspect(r)["logs"][0];
  EXPECT_TRUE(log["axis"].contains("r")) << log["axis"];
  const std::size_t columns = log["columns"].size();
  r.maps = {"none=c_ref"};
  log = view_.inspect(r)["logs"][0];
  EXPECT_FALSE(log["axis"].contains("r")) << log["axis"];
  EXPECT_EQ(log["columns"].size(), columns);
  EXPECT_THAT(view_.identify(r)["command"].get<std::string>(), testing::HasSubstr("--map none=c_ref"));
}

}  // namespace
}  // namespace stribeck::web::identify_view_test
