#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stribeck/io/json.hpp>
#include <stribeck/report/json.hpp>
#include <stribeck/report/test_result.hpp>

namespace stribeck::report {
namespace {

// Written by hand from the description of the format; the text is compared, so that the order of the keys
// counts.
TEST(CompareJson, IsAsDescribed) {
  sim::CompareResult result = testing::two_controllers();
  result.rows[1].speed = 0.0;
  result.rows[1].mean = testing::nothing();
  result.rows[1].spread = testing::nothing();
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
      "max_contour_error_um": 8.0,
      "quadrant_glitch_um": 4.0,
      "rms_um": 4.0,
      "sd_um": 4.0,
      "mean_abs_um": 2.0,
      "power_W": null,
      "mean_abs_ui_W": 57650.123,
      "input_variation_V": 0.125,
      "mean_abs_tracking_um": [
        4.0,
        8.0
      ],
      "spread": {
        "max_contour_error_um": 0.25,
        "quadrant_glitch_um": 0.125,
        "rms_um": 0.125,
        "sd_um": 0.125,
        "mean_abs_um": 0.0625,
        "power_W": null,
        "mean_abs_ui_W": null,
        "input_variation_V": 0.0,
        "mean_abs_tracking_um": [
          0.125,
          0.25
        ]
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
      "max_contour_error_um": null,
      "quadrant_glitch_um": null,
      "rms_um": null,
      "sd_um": null,
      "mean_abs_um": null,
      "power_W": null,
      "mean_abs_ui_W": null,
      "input_variation_V": null,
      "mean_abs_tracking_um": [
        null,
        null
      ],
      "spread": {
        "max_contour_error_um": null,
        "quadrant_glitch_um": null,
        "rms_um": null,
        "sd_um": null,
        "mean_abs_um": null,
        "power_W": null,
        "mean_abs_ui_W": null,
        "input_variation_V": null,
        "mean_abs_tracking_um": [
          null,
          null
        ]
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
  sim::CompareResult result = testing::two_controllers();
  result.machine = testing::kHostile;
  result.rows[0].substeps = 0;
  const auto json = to_json(result);
  EXPECT_TRUE(json["experiment"].is_null());
  EXPECT_TRUE(json["rows"][0]["solver"]["substeps"].is_null());
  EXPECT_NO_THROW(io::dump(json));
}

TEST(IdentifyJson, IsAsDescribed) {
  ident::Result result = testing::fit();
  result.curve.resize(1);
  result.models.resize(1);
  const std::string expected = R"({
  "schema": "stribeck.identify/1",
  "axis": "x",
  "model": "gaussian",
  "mass_kg": 57650.123,
  "mass_ci95_kg": [
    57600.0,
    57700.5
  ],
  "velocity_range_mm_per_s": [
    -9.5,
    9.5
  ],
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
  "warnings": [
    "speeds above 9 mm/s were seen once"
  ]
}
)";
  EXPECT_EQ(io::dump(to_json(result, "x")), expected);
}

}  // namespace
}  // namespace stribeck::report
