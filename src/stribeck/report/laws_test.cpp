#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <stribeck/report/laws.hpp>
#include <stribeck/report/text.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace stribeck::report::laws_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The cell of a controller in a column; "no column" without it.
std::string cell(const Table& t, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < t.columns.size(); ++i) {
    if (t.columns[i].head == column) return t.rows.at(row).at(i).text;
  }
  return "no column";
}

std::vector<sim::ControllerSpec> three() {
  sim::ControllerSpec f;
  f.id = "f";
  f.friction = sim::FrictionUse::kGaussian;
  f.observer = control::Observer::kDisturbance;
  sim::ControllerSpec i = f;
  i.id = "i";
  i.friction = sim::FrictionUse::kWhole;
  i.feedforward = control::Feedforward::kReversal;
  i.adaptation.enabled = true;
  i.observer = control::Observer::kKalman;
  i.disturbance_density = 4e4;
  i.reversal.distance = 4e-6;
  i.reversal.build_up.push_back({2e-6, 0.5});
  sim::ControllerSpec a = f;
  a.id = "a";
  a.observer = control::Observer::kAdaptive;
  a.adaptive_gain = {20.0, 30.0};
  return {f, i, a};
}

TEST(Laws, SayWhatEachControllerUsesAndNothingElse) {
  const Table t = controllers_in_words(three());
  EXPECT_EQ(cell(t, 0, "friction"), "gaussian");
  EXPECT_EQ(cell(t, 0, "feedforward"), "steady");
  EXPECT_EQ(cell(t, 0, "observer"), "disturbance");
  EXPECT_EQ(cell(t, 0, "observer_pole"), "20 1/s");
  EXPECT_EQ(cell(t, 0, "adaptation"), "off");
  EXPECT_EQ(cell(t, 0, "reversal"), "–");
  EXPECT_EQ(cell(t, 1, "observer_pole"), "–");  // the density stands for it
  EXPECT_EQ(cell(t, 1, "disturbance_density"), "40000 N²/s");
  EXPECT_EQ(cell(t, 1, "adaptation"), "on");
  EXPECT_EQ(cell(t, 1, "reversal"), "distance 4 µm, build_up distance 2 µm, share 0.5, lead 0 ms");
  EXPECT_EQ(cell(t, 2, "adaptive_gain"), "(20; 30) 1/s");
  sim::ControllerSpec none;
  EXPECT_EQ(cell(controllers_in_words({none}), 0, "feedforward"), "no column");
}

// A new parameter of a controller must not be forgotten: each has a column, the law its table.
TEST(Laws, EveryParameterHasItsPlace) {
  const Table t = controllers_in_words(three());
  for_each_field<sim::ControllerSpec>([&](const auto& f) {
    if (f.name == "id" || f.name == "label" || f.name == "law") return;
    EXPECT_NE(cell(t, 0, std::string(f.name)), "no column") << f.name;
  });
  for (const auto& row : t.rows) EXPECT_EQ(row.size(), t.columns.size());
}

template <std::size_t... K>
std::vector<control::LawParams> all_laws(std::index_sequence<K...>) {
  return {control::LawParams(std::in_place_index<K>)...};
}

TEST(Laws, WhatIsLeftOutIsNotNamed) {
  for (const auto& law : all_laws(std::make_index_sequence<std::variant_size_v<control::LawParams>>())) {
    const std::string words = law_in_words(law);
    EXPECT_THAT(words, Not(HasSubstr("()")));
    EXPECT_THAT(words, Not(HasSubstr("1/s2")));
    EXPECT_THAT(words, Not(HasSubstr("none")));
    EXPECT_THAT(words, HasSubstr(": "));
  }
  control::PredictiveParams predictive;
  EXPECT_THAT(law_in_words(predictive), Not(HasSubstr("speed_limit")));
  predictive.speed_limit = {0.01, 0.02};
  EXPECT_THAT(law_in_words(predictive), HasSubstr("speed_limit (10; 20) mm/s"));
}

TEST(Laws, StandOnce) {
  auto all = three();
  all[1].law = control::PredictiveParams{};
  const auto laws = laws_in_words(all);
  ASSERT_EQ(laws.size(), 2u);
  EXPECT_EQ(laws[0].second, "(f), (a)");
  EXPECT_EQ(laws[1].second, "(i)");
}

TEST(Laws, UnitsAreWrittenAsPeopleDo) {
  EXPECT_EQ(printed_unit("um"), "µm");
  EXPECT_EQ(printed_unit("N s2/mm"), "N s²/mm");
  EXPECT_EQ(printed_unit("1/s2"), "1/s²");
  EXPECT_EQ(printed_unit("sum"), "sum");
  EXPECT_EQ(printed_unit("umbra"), "umbra");
  EXPECT_EQ(printed_unit("2 mm"), "2 mm");
  EXPECT_EQ(printed_unit(""), "");
}

}  // namespace
}  // namespace stribeck::report::laws_test
