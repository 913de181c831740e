// What runs in threads, for the thread sanitizer (preset tsan): batches of simulations share nothing but what is locked, and
// controllers of the C interface share nothing.
#include <gtest/gtest.h>
#include <stribeck/stribeck.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <stribeck/sim/parallel.hpp>
#include <thread>
#include <vector>

namespace stribeck::test::threads_test {
namespace {

TEST(Threads, JobsWriteToPlacesOfTheirOwn) {
  constexpr std::size_t kJobs = 500;
  std::vector<double> results(kJobs);
  std::size_t told = 0;
  sim::parallel_for(
      kJobs, 8, [] { return std::vector<double>(16); },
      [&](std::vector<double>& own, std::size_t i) {
        for (double& x : own) x += static_cast<double>(i);
        results[i] = std::sqrt(static_cast<double>(i));
      },
      [&](std::size_t done, std::size_t all) { told = all - done; });
  EXPECT_EQ(told, 0U);
  for (std::size_t i = 0; i < kJobs; ++i) EXPECT_EQ(results[i], std::sqrt(static_cast<double>(i)));
}

TEST(Threads, TheFirstProblemIsTold) {
  EXPECT_THROW(sim::parallel_for(
                   100, 8, [] { return 0; },
                   [](int&, std::size_t i) {
                     if (i % 7 == 3) throw std::runtime_error("job");
                   }),
               std::runtime_error);
}

/// Sum of the forces over some laps; the same in every thread.
double run(const char* law) {
  const std::size_t alignment = stribeck_alignment();
  const std::size_t size = stribeck_controller_size_for(1, law);
  const std::unique_ptr<void, decltype(&std::free)> memory(
      std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment), &std::free);
  stribeck_controller* const c = stribeck_controller_init(memory.get(), size, 1);
  stribeck_controller_choose(c, 0, "law", law);
  stribeck_controller_set(c, 0, "mass", 800.0);
  stribeck_controller_set(c, 0, "force_limit", 250.0);
  stribeck_controller_set(c, 0, "friction.conventional.alpha0", 10.0);
  stribeck_controller_set(c, 0, "learning.lap", 1.0);  // refused under other laws
  if (stribeck_controller_configure(c, 1e-3) != STRIBECK_OK) return std::nan("");
  double sum = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double t = 6.283185307179586e-3 * k;
    const stribeck_axis_input in = {10e-3 * std::sin(t), 62.8e-3 * std::cos(t), -0.395 * std::sin(t),
                                    10e-3 * std::sin(t - 0.01)};
    double force = 0.0;
    stribeck_controller_set_phase(c, 1e-3 * k);
    stribeck_controller_step(c, &in, &force);
    sum += force;
  }
  return sum;
}

TEST(Threads, ControllersShareNothing) {
  std::vector<const char*> laws;
  for (std::uint32_t i = 0; const char* law = stribeck_controller_parameter_word("law", i); ++i)
    laws.push_back(law);
  std::vector<double> alone;
  for (const char* law : laws) alone.push_back(run(law));
  std::vector<double> together(4 * laws.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < together.size(); ++i)
      threads.emplace_back([&, i] { together[i] = run(laws[i % laws.size()]); });
  }
  for (std::size_t i = 0; i < together.size(); ++i) {
    EXPECT_TRUE(std::isfinite(together[i]));
    EXPECT_EQ(together[i], alone[i % laws.size()]) << laws[i % laws.size()];
  }
}

}  // namespace
}  // namespace stribeck::test::threads_test
