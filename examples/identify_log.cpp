#include <cstdio>
#include <exception>
#include <stribeck/workflow/identify.hpp>

int main(int argc, char** argv) try {
  const auto axis = stribeck::workflow::read_axis({argc > 1 ? argv[1] : "log.csv"}, {});
  const auto found = stribeck::workflow::identify(axis, {});
  const auto [low, high] = found.result.mass_interval;
  std::printf("mass %.0f kg, 95 %%: %.0f to %.0f kg\n", found.result.mass, low, high);
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
