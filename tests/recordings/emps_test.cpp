#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tests/cli/command.hpp>
#include <tests/recordings/recording.hpp>

namespace stribeck::test::emps_test {
namespace {

TEST(Identify, PrintsTheEmpsBenchmarkToItsLastDigit) {
  STRIBECK_RECORDING(log, "emps/emps.csv");
  const auto run = [&](const std::string& model) {
    return command(
               {"identify", log, "--method", "idim-ls", "--model", model, "--gain", "35.15065188248547 N/V"})
        .out;
  };
  for (const auto& [model, printed] :
       {std::pair<std::string, std::vector<std::string>>{
            "conventional",
            {"95.1089 (0.1085) kg", "203.5034 (1.1460) N s/m", "20.3935 (0.1012) N", "-3.1648 (0.0444) N",
             "norm 108.7569 N", "relative 4.0834 %", "deviation 2.1843 N", "condition 25.9883"}},
        {"asymmetric",
         {"95.1540 (0.0827) kg", "166.7061 (1.2326) N s/m", "20.1440 (0.1088) N", "240.4236 (1.2346) N s/m",
          "20.6277 (0.1091) N", "norm 82.8778 N", "relative 3.1117 %", "deviation 1.6646 N",
          "condition 26.0197"}}}) {
    const std::string out = run(model);
    for (const auto& figure : printed)
      EXPECT_NE(out.find(figure), std::string::npos) << figure << " in\n" << out;
  }
}

}  // namespace
}  // namespace stribeck::test::emps_test
