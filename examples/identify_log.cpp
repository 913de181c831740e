#include <cstdio>
#include <exception>
#include <stribeck/workflow/identify.hpp>
#include <string>

int main(int argc, char** argv) try {
  const auto axis = stribeck::workflow::read_axis({argc > 1 ? argv[1] : "log.csv"}, {});
  const auto found = stribeck::workflow::identify(axis, {});
  const auto [low, high] = found.result.mass_interval;
  const std::string unit = found.result.force_unit != "N" ? found.result.force_unit + " s2/m"
                           : axis.rotary                  ? "kg m2"
                                                          : "kg";
  std::printf("mass %.5g %s, 95 %%: %.5g to %.5g\n", found.result.mass, unit.c_str(), low, high);
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
