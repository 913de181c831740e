#pragma once
/// What the diagnosis says of a virtual machine (test_virtual_circle.hpp), for tests.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stribeck/ident/circle/causes.hpp>
#include <stribeck/ident/circle/test_virtual_circle.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::circle {

inline Diagnosis diagnosis_of(const VirtualMachine& m, const std::vector<double>& feeds) {
  std::mt19937_64 random(19);
  std::vector<CircleMotion> all;
  for (const double feed : feeds) all.push_back(travel(m, feed, 1.3, random).motion(m.radius));
  const auto d = diagnose(all);
  EXPECT_TRUE(d.has_value());
  return d.value_or(Diagnosis{});
}

inline std::vector<std::string> found_in(const Diagnosis& d) {
  std::vector<std::string> out;
  for (const Cause& c : d.causes) {
    if (c.found) out.push_back(std::string(enum_name(c.kind)) + (c.axis ? (*c.axis == 0 ? " x" : " y") : ""));
  }
  return out;
}

inline const Cause& cause_in(const Diagnosis& d, CauseKind kind, int axis) {
  return *std::find_if(d.causes.begin(), d.causes.end(),
                       [&](const Cause& c) { return c.kind == kind && c.axis.value_or(axis) == axis; });
}

}  // namespace stribeck::ident::circle
