#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report::json_test {
namespace {

// Written by hand from the description of the format; the text is compared, so that the order of the keys
// counts.
// Longer than 80 lines: the whole document as it must be written.
TEST(CompareJson, IsAsDescribed) {
  sim::CompareResult result = test::two_controllers();
  result.rows[1].speed = 0.0;
  result.rows[1].mean = test::nothing();
  result.rows[1].spread = test::nothing();
  result.rows[0].mean.mean_abs_ui = 57650.123;
  const std::string expected = R"({
  "schema": "stribeck.compare/1",
  "machine": "table",
  "experiment": "bi-table",
  "seed": 7,
  "trials": 4,
  "rows": [
    {
      "controller": "a",
      "label": "no friction compensation",
      "speed_mm_per_s": 9.5,
      "refused": null,
      "max_contour_error_um": 8.0,
      "quadrant_glitch_um": 4.0,
      "rms_um": 4.0,
      "sd_um": 4.0,
      "mean_abs_um": 2.0,
      "power_W": null,
      "mean_abs_ui_W": 57650.123,
      "mechanical_power_W": null,
      "input_variation_V": 0.125,
      "mean_abs_tracking_um": [
        4.0,
        8.0
      ],
      "max_orientation_error_urad": null,
      "mean_orientation_error_urad": null,
      "quadrant_ratio": null,
      "spread": {
        "max_contour_error_um": 0.25,
        "quadrant_glitch_um": 0.125,
        "rms_um": 0.125,
        "sd_um": 0.125,
        "mean_abs_um": 0.0625,
        "power_W": null,
        "mean_abs_ui_W": null,
        "mechanical_power_W": null,
        "input_variation_V": 0.0,
        "mean_abs_tracking_um": [
          0.125,
          0.25
        ],
        "max_orientation_error_urad": null,
        "mean_orientation_error_urad": null,
        "quadrant_ratio": null
      },
      "solver": {
        "substeps": 4,
        "accuracy_nm": 1.0
      }
    },
    {
      "controller": "b",
      "label": "conventional friction model",
      "speed_mm_per_s": null,
      "refused": null,
      "max_contour_error_um": null,
      "quadrant_glitch_um": null,
      "rms_um": null,
      "sd_um": null,
      "mean_abs_um": null,
      "power_W": null,
      "mean_abs_ui_W": null,
      "mechanical_power_W": null,
      "input_variation_V": null,
      "mean_abs_tracking_um": [
        null,
        null
      ],
      "max_orientation_error_urad": null,
      "mean_orientation_error_urad": null,
      "quadrant_ratio": null,
      "spread": {
        "max_contour_error_um": null,
        "quadrant_glitch_um": null,
        "rms_um": null,
        "sd_um": null,
        "mean_abs_um": null,
        "power_W": null,
        "mean_abs_ui_W": null,
        "mechanical_power_W": null,
        "input_variation_V": null,
        "mean_abs_tracking_um": [
          null,
          null
        ],
        "max_orientation_error_urad": null,
        "mean_orientation_error_urad": null,
        "quadrant_ratio": null
      },
      "solver": {
        "substeps": 4,
        "accuracy_nm": 1.0
      }
    }
  ],
  "warnings": []
}
)";
  EXPECT_EQ(io::dump(to_json(result, "bi-table")), expected);
}

TEST(CompareJson, WhatIsNotKnownIsNull) {
  sim::CompareResult result = test::two_controllers();
  result.machine = test::kHostile;
  result.rows[0].substeps = 0;
  result.rows[0].refused = "too stiff";
  const auto json = to_json(result);
  EXPECT_EQ(json["rows"][0]["refused"], "too stiff");
  EXPECT_TRUE(json["experiment"].is_null());
  EXPECT_TRUE(json["rows"][0]["solver"]["substeps"].is_null());
  EXPECT_NO_THROW(io::dump(json));
}

// Longer than 80 lines: the whole document as it must be written.
TEST(IdentifyJson, IsAsDescribed) {
  ident::Result result = test::fit();
  result.curve.resize(1);
  result.models.resize(1);
  const std::string expected = R"({
  "schema": "stribeck.identify/1",
  "axis": "x",
  "method": "velocity-map",
  "model": "gaussian",
  "force_unit": "N",
  "position_unit": "m",
  "mass_kg": 57650.123,
  "mass_ci95_kg": [
    57600.0,
    57700.5
  ],
  "load_N": 0.0,
  "velocity_range_mm_per_s": [
    -9.5,
    9.5
  ],
  "curve_from_mm_per_s": [
    -9.5,
    null
  ],
  "rows": 1234,
  "parameters": [
    {
      "name": "mass",
      "value": 57.65,
      "unit": "N s2/mm",
      "ci95": [
        57.6,
        57.7
      ],
      "identifiable": true
    },
    {
      "name": "eta1_positive",
      "value": 102.48,
      "unit": "N s/mm",
      "ci95": [
        101.0,
        104.0
      ],
      "identifiable": true
    },
    {
      "name": "gaussian_1_a_positive",
      "value": 12.5,
      "unit": "N",
      "ci95": [
        null,
        null
      ],
      "identifiable": false
    }
  ],
  "curve": [
    {
      "velocity_mm_per_s": -9.5,
      "friction_N": -2000.0,
      "ci95_N": [
        -2010.0,
        -1990.0
      ]
    }
  ],
  "held_out_rms_N": 20.5,
  "r_squared": null,
  "models": [
    {
      "name": "Gaussian, 1 term, v > 0",
      "terms": 1,
      "parameters": 5,
      "held_out_rms_N": 20.5,
      "standard_error_N": 0.0,
      "chosen": true
    }
  ],
  "friction": {
    "steady": {
      "kind": "conventional",
      "alpha0": {
        "value": 800.0,
        "unit": "N"
      },
      "alpha2": {
        "value": 100.0,
        "unit": "N s/mm"
      },
      "stribeck": null
    },
    "eccentric": [],
    "dynamics": {
      "kind": "static"
    },
    "places": [],
    "spring": null
  },
  "break_away_um": null,
  "cannot_tell": [],
  "warnings": [
    "speeds above 9 mm/s were seen once"
  ]
}
)";
  EXPECT_EQ(io::dump(to_json(result, "x")), expected);
}

TEST(IdentifyJson, CarriesTheWholeModel) {
  const auto json = to_json(test::whole_fit(), "x");
  const auto& friction = json["friction"];
  EXPECT_EQ(friction["eccentric"].dump(),
            R"([{"amplitude":{"value":1.5,"unit":"N"},"period":{"value":2.5,"unit":"mm"},)"
            R"("phase":{"value":0.25,"unit":"rad"},"form":"proportional"}])");
  EXPECT_EQ(
      friction["dynamics"].dump(),
      R"({"kind":"lugre","sigma0":{"value":2000.0,"unit":"N/mm"},"sigma1":{"value":0.0,"unit":"N s/mm"},)"
      R"("damping_velocity":null})");
  EXPECT_EQ(json["break_away_um"], 12.0);
  EXPECT_EQ(json["load_N"], -3.25);
  EXPECT_EQ(json["cannot_tell"][0], "the stiffness of pre-sliding: the encoder is too coarse");
  EXPECT_EQ(json["parameters"][5].dump(),
            R"({"name":"force_shift","value":1.5,"unit":"ms","ci95":[1.25,1.75],"identifiable":true})");
}

// A number never stands under a key with a unit that is not its own.
TEST(IdentifyJson, KeysDoNotLieAboutUnits) {
  auto json = to_json(test::own_units(false), "x");
  EXPECT_EQ(json["force_unit"], "A");
  EXPECT_EQ(json["position_unit"], "m");
  EXPECT_TRUE(json["mass_kg"].is_null());
  EXPECT_EQ(json["mass"], 57650.123);
  EXPECT_TRUE(json["held_out_rms_N"].is_null());
  EXPECT_EQ(json["held_out_rms"], 20.5);
  EXPECT_EQ(json["velocity_range_mm_per_s"][1], 9.5);
  EXPECT_FALSE(json.contains("velocity_range"));
  EXPECT_EQ(
      json["curve"][0].dump(),
      R"({"velocity_mm_per_s":-9.5,"friction_N":null,"friction":-2000.0,"ci95_N":null,"ci95":[-2010.0,-1990.0]})");
  EXPECT_EQ(json["parameters"][1]["unit"], "A s/mm");
  EXPECT_EQ(json["friction"]["steady"]["alpha2"]["unit"], "A s/mm");
  EXPECT_TRUE(json["models"][0]["held_out_rms_N"].is_null());
  EXPECT_EQ(json["models"][0]["held_out_rms"], 20.5);

  json = to_json(test::own_units(true), "x");
  EXPECT_TRUE(json["velocity_range_mm_per_s"].is_null());
  EXPECT_EQ(json["velocity_range"][1], 9.5e-3);
  EXPECT_EQ(json["parameters"][0]["unit"], "A s2/rad");
  EXPECT_EQ(json["parameters"][0]["value"], 57650.0);
  EXPECT_EQ(json["parameters"][4]["unit"], "rad");
  EXPECT_EQ(json["friction"]["eccentric"][0]["period"].dump(), R"({"value":0.0025,"unit":"rad"})");
  EXPECT_EQ(json["break_away"], 12e-6);
}

}  // namespace
}  // namespace stribeck::report::json_test
