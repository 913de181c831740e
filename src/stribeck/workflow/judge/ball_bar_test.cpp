// Tables of a ball-bar: the same circle as a log and as tables of every kind; what is refused.
#include <stribeck/workflow/judge/ball_bar.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stribeck/ident/circle/test_virtual_circle.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/circle_logs.hpp>

namespace stribeck::workflow::ball_bar_test {
namespace {

namespace circle = ident::circle;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kR = 0.1;
constexpr double kFeed = 1000.0 / 6e4;
constexpr double kDegree = kPi / 180.0;

/// Backlash, squareness, scale mismatch, a spike and an instrument off the centre.
circle::VirtualRecord record(double feed = kFeed, double spike = 3e-6) {
  circle::VirtualMachine m;
  m.radius = kR;
  m.backlash[0] = 4e-6;
  m.tilt = 30e-6;
  m.scale[0] = 60e-6;
  m.spike[1] = spike;
  m.offset[0] = 8e-6;
  std::mt19937_64 random(7);
  return circle::travel(m, feed, 1.3, random);
}

/// One row of a ball-bar: the angle is that of the command.
struct Row {
  double angle;
  double radius;
  bool counter_clockwise;
};

std::vector<Row> rows_of(const circle::VirtualRecord& r) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < r.t.size(); ++i) {
    const bool gap = i > 0 && r.t[i] - r.t[i - 1] > 0.5;
    const bool forward = rows.empty() || (rows.back().counter_clockwise && !gap);
    rows.push_back({std::atan2(r.cy[i], r.cx[i]), std::hypot(r.x[i], r.y[i]), forward});
  }
  return rows;
}

std::string log_text(const circle::VirtualRecord& r) {
  std::string text = "t [s],x [mm],y [mm],rx [mm],ry [mm]\n";
  for (std::size_t i = 0; i < r.t.size(); ++i)
    text += fmt::format("{:.4f},{:.7f},{:.7f},{:.7f},{:.7f}\n", r.t[i], r.x[i] * 1e3, r.y[i] * 1e3,
                        r.cx[i] * 1e3, r.cy[i] * 1e3);
  return text;
}

class BallBar : public ::testing::Test {
 protected:
  [[nodiscard]] report::CircleReportInput judged(const std::vector<std::string>& texts,
                                                 CircleOptions o = {}) const {
    for (const std::string& text : texts)
      o.logs.push_back(folder_.write(fmt::format("bar{}.csv", o.logs.size()), text));
    return judge_circles(o);
  }
  [[nodiscard]] std::string refused(const std::string& text, const CircleOptions& o = {}) const {
    try {
      static_cast<void>(judged({text}, o));
    } catch (const io::InputError& e) {
      return e.what();
    }
    return "not refused";
  }

  test::Folder folder_;
};

CircleOptions sized(bool together = false) {
  CircleOptions o;
  o.size = "100 mm";
  o.together = together;
  return o;
}

const circle::Cause* found(const circle::Diagnosis& d, circle::CauseKind kind, std::optional<int> axis) {
  for (const circle::Cause& c : d.causes) {
    if (c.found && c.kind == kind && c.axis == axis) return &c;
  }
  return nullptr;
}

/// The same causes are found, each with its size within `tolerance` [m].
void expect_same(const circle::Diagnosis& got, const circle::Diagnosis& wanted, double tolerance) {
  std::size_t count = 0;
  for (const circle::Cause& c : wanted.causes) {
    if (!c.found) continue;
    ++count;
    const circle::Cause* other = found(got, c.kind, c.axis);
    ASSERT_NE(other, nullptr) << enum_name(c.kind);
    EXPECT_NEAR(other->size, c.size, tolerance) << enum_name(c.kind);
  }
  EXPECT_EQ(std::count_if(got.causes.begin(), got.causes.end(), [](const auto& c) { return c.found; }),
            count);
}

std::string plain_table(const std::vector<Row>& rows, const std::string& head = "angle [deg],radius [mm]\n") {
  std::string text = head;
  for (const Row& r : rows) text += fmt::format("{:.6f},{:.7f}\n", r.angle / kDegree, r.radius * 1e3);
  return text;
}

TEST_F(BallBar, CommandedPositionsOfALogAreFoundByTheirNames) {
  const std::string text = log_text(record());
  CircleOptions commanded = sized();
  commanded.maps = {"rx=rx", "ry=ry"};
  const auto wanted = judged({text}, commanded);
  const std::string head = text.substr(text.find('\n'));
  for (const std::string names :
       {"rx [mm],ry [mm]", "x_ref [mm],y_ref [mm]", "X Sollposition [mm],Y Sollposition [mm]"}) {
    const auto got = judged({"t [s],x [mm],y [mm]," + names + head}, sized());
    EXPECT_EQ(got.logs[0].test->directions[0].radial_max, wanted.logs[0].test->directions[0].radial_max)
        << names;
  }
  // One alone, or without a unit, is no commanded circle and no reason to refuse the log.
  const auto without = judged({"t [s],x [mm],y [mm],a [mm],b [mm]" + head}, sized());
  for (const std::string names : {"rx [mm],b [mm]", "rx [A],ry [A]"}) {
    const auto got = judged({"t [s],x [mm],y [mm]," + names + head}, sized());
    EXPECT_EQ(got.logs[0].test->directions[0].radial_max, without.logs[0].test->directions[0].radial_max)
        << names;
  }
}

// Nobody should have to type what the log holds.
TEST_F(BallBar, TheRadiusOfALogIsFound) {
  const circle::VirtualRecord r = record();
  const auto commanded = judged({log_text(r)});
  EXPECT_NEAR(commanded.radius, kR, 1e-9);
  EXPECT_EQ(commanded.logs[0].circles.size(), 2U);
  std::string measured = "t [s],x [mm],y [mm]\n";
  for (std::size_t i = 0; i < r.t.size(); ++i)
    measured += fmt::format("{:.4f},{:.7f},{:.7f}\n", r.t[i], r.x[i] * 1e3, r.y[i] * 1e3);
  const auto found = judged({measured});
  EXPECT_NEAR(found.radius, kR, 1e-9);
  EXPECT_THAT(found.warnings, Contains(HasSubstr("the radius was not given: 100 mm, the measured")));
}

TEST_F(BallBar, ANominalRadiusThatIsASlipIsNamed) {
  CircleOptions o;
  o.size = "101 mm";
  EXPECT_THAT(judged({plain_table(rows_of(record()))}, o).logs[0].notes,
              Contains(HasSubstr("the mean radius of the rows is 100.0")));
}

TEST_F(BallBar, DiagnosisOfTheTableIsThatOfTheLog) {
  const circle::VirtualRecord r = record();
  CircleOptions commanded = sized();
  commanded.maps = {"rx=rx", "ry=ry"};
  const auto log = judged({log_text(r)}, commanded);
  const auto bar = judged({plain_table(rows_of(r))}, sized());
  ASSERT_TRUE(log.logs[0].diagnosis && bar.logs[0].diagnosis);
  const circle::Diagnosis& d = *bar.logs[0].diagnosis;
  using K = circle::CauseKind;
  ASSERT_NE(found(d, K::kBacklash, 0), nullptr);
  EXPECT_NEAR(found(d, K::kBacklash, 0)->size, 4e-6, 0.2e-6);
  ASSERT_NE(found(d, K::kSquareness, std::nullopt), nullptr);
  EXPECT_NEAR(found(d, K::kSquareness, std::nullopt)->size, 1.5e-6, 0.1e-6);
  ASSERT_NE(found(d, K::kScaleMismatch, std::nullopt), nullptr);
  EXPECT_NEAR(found(d, K::kScaleMismatch, std::nullopt)->size, 3e-6, 0.1e-6);
  ASSERT_NE(found(d, K::kReversalSpike, 1), nullptr);
  EXPECT_NEAR(found(d, K::kReversalSpike, 1)->size, 3e-6, 0.4e-6);
  expect_same(d, *log.logs[0].diagnosis, 0.03e-6);
  const auto& test = *bar.logs[0].test;
  const auto& wanted = *log.logs[0].test;
  for (const int k : {0, 1}) {
    EXPECT_NEAR(test.directions[k].circular_deviation, wanted.directions[k].circular_deviation, 0.1e-6);
    EXPECT_NEAR(test.directions[k].radial_max, wanted.directions[k].radial_max, 0.1e-6);
    EXPECT_NEAR(test.directions[k].radial_min, wanted.directions[k].radial_min, 0.1e-6);
  }
  EXPECT_NEAR(test.mean_radial_deviation, wanted.mean_radial_deviation, 0.01e-6);
  EXPECT_NEAR(*test.hysteresis, *wanted.hysteresis, 0.1e-6);
  ASSERT_EQ(d.peaks.size(), log.logs[0].diagnosis->peaks.size());
  for (std::size_t k = 0; k < d.peaks.size(); ++k) {
    EXPECT_NEAR(d.peaks[k].angle, log.logs[0].diagnosis->peaks[k].angle, 1e-9);
    EXPECT_NEAR(d.peaks[k].height, log.logs[0].diagnosis->peaks[k].height, 0.1e-6);
  }
}

TEST_F(BallBar, TablesOfEveryKindGiveTheSame) {
  const std::vector<Row> rows = rows_of(record());
  const auto wanted = judged({plain_table(rows)}, sized());
  const circle::Diagnosis& d = *wanted.logs[0].diagnosis;
  const auto same = [&](const std::string& text, CircleOptions o = sized()) {
    const auto got = judged({text}, std::move(o));
    ASSERT_EQ(got.logs[0].circles.size(), 2U) << text.substr(0, 80);
    expect_same(*got.logs[0].diagnosis, d, 1e-9);
  };
  std::string german = "Winkel (°);Abweichung (µm)\n";
  std::string radians = "theta_rad\tdev [mm]\tnominal radius [mm]\n";
  std::string told = "# Feed rate (mm/min): 1000\nangle [deg],direction,radius [mm]\n";
  std::string signs = "phi [deg],dir,R [mm]\n";
  std::string bare;
  for (const Row& r : rows) {
    std::string cells = fmt::format("{:.6f};{:.5f}\n", r.angle / kDegree, (r.radius - kR) * 1e6);
    std::replace(cells.begin(), cells.end(), '.', ',');
    german += cells;
    radians += fmt::format("{:.9f}\t{:.8f}\t100\n", r.angle, (r.radius - kR) * 1e3);
    told += fmt::format("{:.6f},{},{:.7f}\n", r.angle / kDegree, r.counter_clockwise ? "CCW" : "CW",
                        r.radius * 1e3);
    signs +=
        fmt::format("{:.6f},{},{:.7f}\n", r.angle / kDegree, r.counter_clockwise ? 1 : -1, r.radius * 1e3);
    bare += fmt::format("{:.6f} {:.7f}\n", r.angle / kDegree, r.radius * 1e3);
  }
  same(german);
  same(radians, {});  // the radius stands in the table
  same(told);
  same(signs);
  same("# radius: 0.1 m\n" + plain_table(rows), {});
  CircleOptions mapped = sized();
  mapped.maps = {"angle=W deg", "radius=L mm"};
  same(plain_table(rows, "W,L\n"), mapped);
  CircleOptions no_header = sized();
  no_header.logs = {folder_.write("bare.txt", bare)};
  static_cast<void>(folder_.write("bare.txt.toml", "columns = [\"angle deg\", \"radius mm\"]\n"));
  expect_same(*judge_circles(no_header).logs[0].diagnosis, d, 1e-9);
}

// Clockwise rows that stand by increasing angle: the direction that is told counts, and a note says so.
TEST_F(BallBar, ToldDirectionGoesBeforeTheOrderOfTheRows) {
  std::vector<Row> rows = rows_of(record());
  const auto turn = std::find_if(rows.begin(), rows.end(), [](const Row& r) { return !r.counter_clockwise; });
  const auto wanted = judged({plain_table(rows)}, sized());
  std::reverse(turn, rows.end());
  std::string text = "direction,angle [deg],radius [mm]\n";
  for (const Row& r : rows)
    text += fmt::format("{},{:.6f},{:.7f}\n", r.counter_clockwise ? "G3" : "clockwise", r.angle / kDegree,
                        r.radius * 1e3);
  const auto got = judged({text}, sized());
  ASSERT_EQ(got.logs[0].circles.size(), 2U);
  EXPECT_FALSE(got.logs[0].circles[1].counter_clockwise);
  expect_same(*got.logs[0].diagnosis, *wanted.logs[0].diagnosis, 1e-9);
  EXPECT_THAT(got.logs[0].notes, Contains(HasSubstr("are clockwise, but their angle increases")));
  // One column for each direction, at the same angles.
  std::string two = "angle [deg],deviation ccw [um],deviation cw [um]\n";
  for (int i = 0; i <= 1440; ++i)
    two += fmt::format("{},{:.4f},{:.4f}\n", 0.25 * i, 2.0 * std::cos(0.5 * i * kDegree), 3.0);
  const auto both = judged({two}, sized());
  ASSERT_EQ(both.logs[0].circles.size(), 2U);
  EXPECT_TRUE(both.logs[0].circles[0].counter_clockwise);
  EXPECT_NEAR(both.logs[0].test->directions[0].circular_deviation, 4e-6, 0.02e-6);
  EXPECT_NEAR(both.logs[0].test->directions[1].radial_max, 3e-6, 1e-9);
  EXPECT_NEAR(both.logs[0].test->directions[1].circular_deviation, 0.0, 1e-9);
  // --where chooses rows of the file, whatever their order in the motion.
  CircleOptions chosen = sized();
  chosen.where = {"pass=1"};
  std::string passes = "pass,angle [deg],deviation [um],direction\n";
  for (int i = 0; i <= 1440; ++i)
    passes += fmt::format("{},{},{},-\n", i / 721, 0.5 * (i % 721), i / 721 == 1 ? 1 : 9);
  EXPECT_NEAR(judged({passes}, chosen).logs[0].circles[0].max_error, 1e-6, 1e-9);
}

// Some programs count the angle clockwise. Rows against their direction are then no reversed rows, and the causes tell.
TEST_F(BallBar, AnAngleThatIsCountedTheOtherWayIsNamed) {
  const auto notes = [&](double sign, bool reversed) {
    const std::vector<Row> rows = rows_of(record(kFeed, 16e-6)), back(rows.rbegin(), rows.rend());
    std::string text = "direction,angle [deg],radius [mm]\n";
    for (const Row& r : reversed ? back : rows)
      text += fmt::format("{},{:.6f},{:.7f}\n", r.counter_clockwise ? "ccw" : "cw", sign * r.angle / kDegree,
                          1e3 * r.radius);
    return judged({text}, sized()).logs[0].notes;
  };
  const auto named = Contains(HasSubstr("most likely the angle is counted that way"));
  EXPECT_THAT(notes(-1.0, false), named);
  for (const bool reversed : {false, true}) EXPECT_THAT(notes(1.0, reversed), testing::Not(named));
}

// The first row of the way back stands at or beyond the last angle of the way there: with lateral play it is off the other circle.
TEST_F(BallBar, TheFirstRowOfTheWayBackIsItsOwn) {
  for (const double back : {0.0, 45.0}) {
    std::string told = "angle [deg],deviation [um],direction\n", plain = "angle [deg],deviation [um]\n";
    const auto row = [&](double angle, double deviation, const char* direction) {
      told += fmt::format("{:.3f},{:.4f},{}\n", angle, deviation, direction);
      plain += fmt::format("{:.3f},{:.4f}\n", angle, deviation);
    };
    for (int i = 0; i <= 720; ++i) row(-22.5 + 0.5 * i, 2.0, "ccw");
    for (int i = 0; i <= 720; ++i) row(337.5 + back - 0.5 * i, -2.0, "cw");
    for (const std::string& text : {told, plain}) {
      const auto got = judged({text}, sized());
      ASSERT_EQ(got.logs[0].circles.size(), 2U);
      for (const auto& d : got.logs[0].test->directions) {
        EXPECT_NEAR(d.radial_max - d.radial_min, 0.0, 1e-9) << back;
        EXPECT_NEAR(d.circular_deviation, 0.0, 1e-9) << back;
      }
    }
  }
}

TEST_F(BallBar, FilesOfOneDirectionEachAreOneMeasurementTogether) {
  const std::vector<Row> rows = rows_of(record());
  const auto turn = std::find_if(rows.begin(), rows.end(), [](const Row& r) { return !r.counter_clockwise; });
  const std::string ccw = plain_table({rows.begin(), turn});
  const std::string cw = plain_table({turn, rows.end()});
  const auto wanted = judged({plain_table(rows)}, sized());
  const auto got = judged({ccw, cw}, sized(true));
  ASSERT_EQ(got.logs.size(), 1U);
  EXPECT_EQ(got.logs[0].label, "bar0 + bar1");
  ASSERT_EQ(got.logs[0].circles.size(), 2U);
  ASSERT_TRUE(got.together);
  expect_same(*got.together, *wanted.logs[0].diagnosis, 1e-9);
  EXPECT_NEAR(*got.logs[0].test->hysteresis, *wanted.logs[0].test->hysteresis, 1e-9);
  EXPECT_THROW(static_cast<void>(judged({ccw, cw}, sized())), io::InputError);
  EXPECT_EQ(judged({ccw, ccw}, sized()).logs.size(), 2U);  // before and after, side by side
  EXPECT_THAT(judged({ccw}, sized()).logs[0].notes, Contains(HasSubstr("names no direction")));
  EXPECT_THAT(judged({cw}, sized()).logs[0].notes, Not(Contains(HasSubstr("names no direction"))));
}

TEST_F(BallBar, WhatIsNotMeasuredIsSaid) {
  const std::vector<Row> rows = rows_of(record());
  const auto remarks = [](const report::CircleReportInput& input) {
    return input.logs[0].diagnosis->remarks;
  };
  const auto unknown = judged({plain_table(rows)}, sized());
  EXPECT_THAT(remarks(unknown),
              AllOf(Contains(HasSubstr("the feed is not known (--feed")), Contains(HasSubstr("no times")),
                    Contains(HasSubstr("an error along the circle cannot be seen")),
                    Not(Contains(HasSubstr("motor encoder")))));
  EXPECT_TRUE(std::isnan(unknown.logs[0].diagnosis->peaks[0].feed));
  CircleOptions told = sized();
  told.feeds = {"1000 mm/min"};
  const auto known = judged({plain_table(rows)}, told);
  EXPECT_NEAR(known.logs[0].diagnosis->peaks[0].feed, kFeed, 1e-12);
  EXPECT_THAT(remarks(known), Not(Contains(HasSubstr("the feed is not known"))));
  const auto stated = judged({"# feed: 600 mm/min\n" + plain_table(rows)}, told);
  EXPECT_NEAR(stated.logs[0].diagnosis->peaks[0].feed, kFeed, 1e-12);
  EXPECT_THAT(stated.logs[0].notes, Contains("states a feed of 600 mm/min; --feed gives 1000 mm/min"));
  // Two feeds, told for each file: a lag has its columns.
  CircleOptions two = sized(true);
  two.feeds = {"1000 mm/min", "3000 mm/min"};
  const auto both = judged({plain_table(rows), plain_table(rows_of(record(3 * kFeed)))}, two);
  EXPECT_THAT(both.together->remarks, Not(Contains(HasSubstr("one feed"))));
  // A log with times knows its feed.
  const auto log = judged({log_text(record())}, told);
  EXPECT_NEAR(log.logs[0].diagnosis->peaks[0].feed, kFeed, 1e-4);
  EXPECT_THAT(log.logs[0].notes, Contains(HasSubstr("--feed is not used")));
  EXPECT_THAT(remarks(log), Contains(HasSubstr("motor encoder")));
}

TEST_F(BallBar, BadTablesAreRefused) {
  const auto circle_of = [](double radius, double turn, int rows, const std::string& head) {
    std::string text = head;
    for (int i = 0; i < rows; ++i) text += fmt::format("{},{}\n", turn * i / (rows - 1), radius);
    return text;
  };
  const std::string head = "angle [deg],radius [mm]\n";
  EXPECT_THAT(refused("", sized()), HasSubstr("empty"));
  EXPECT_THAT(refused(head, sized()), HasSubstr("no data rows"));
  EXPECT_THAT(refused("angle [deg],force [N]\n0,1\n1,1\n", sized()), HasSubstr("an angle but no radius"));
  EXPECT_THAT(refused("force [N],radius [mm]\n0,1\n1,1\n", sized()), HasSubstr("no column for the position"));
  EXPECT_THAT(refused(head + "0,100\n1,nan\n", sized()), HasSubstr("got \"nan\", expected a number"));
  EXPECT_THAT(refused(circle_of(100, 0, 500, head), sized()), HasSubstr("bar0.csv"));
  EXPECT_THAT(refused(circle_of(0, 360, 500, head), sized()),
              HasSubstr("row 1: a radius of 0 mm, expected about 100 mm"));
  EXPECT_THAT(refused(circle_of(0.002, 360, 500, head), sized()), HasSubstr("--map deviation="));
  // A radius that nobody states is the measured one, rounded.
  const auto measured = judged({circle_of(100.004, 360, 500, head)}, {});
  EXPECT_DOUBLE_EQ(measured.radius, 0.1);
  EXPECT_THAT(measured.warnings, Contains(HasSubstr("the radius was not given: 100 mm")));
  EXPECT_THAT(refused(circle_of(100, 360, 20, head), sized()), HasSubstr("too few samples"));
  EXPECT_THAT(refused(circle_of(100, 90, 500, head), sized()),
              HasSubstr("one of 90 deg, expected at least 175 deg"));
  EXPECT_THAT(refused(circle_of(1, 360, 500, "angle [deg],deviation [um]\n"), {}),
              HasSubstr("does not state (give it with --size"));
  EXPECT_THAT(refused(circle_of(1, 360, 500, "angle [deg],deviation\n"), sized()), HasSubstr("unit"));
  EXPECT_THAT(refused(circle_of(1, 360, 500, "angle,deviation [um]\n"), sized()), HasSubstr("has no unit"));
  EXPECT_THAT(refused(circle_of(1, 360, 500, "angle [mm],deviation [um]\n"), sized()), HasSubstr("angle"));
  EXPECT_THAT(refused("angle [deg],radius [mm],R [mm]\n0,1,1\n1,1,1\n", sized()), HasSubstr("could both be"));
  EXPECT_THAT(refused("angle [deg],radius [mm],direction\n0,100,ccw\n1,100,up\n", sized()),
              HasSubstr("row 2: got \"up\", expected ccw or cw"));
  EXPECT_THAT(refused("angle [deg],radius [mm],nominal [mm]\n0,1,1\n1,1,2\n", {}),
              HasSubstr("one radius above 0"));
  EXPECT_THAT(refused("# radius: none\nangle [deg],radius [mm]\n0,1\n1,1\n", {}), HasSubstr("radius"));
  EXPECT_THAT(refused("# radius: 0 mm\nangle [deg],radius [mm]\n0,1\n1,1\n", {}), HasSubstr("radius"));
  EXPECT_THAT(refused("# feed: fast\n" + circle_of(100, 360, 500, head), sized()), HasSubstr("feed"));
  CircleOptions feeds = sized();
  feeds.feeds = {"1 m/min", "2 m/min"};
  EXPECT_THAT(refused(circle_of(100, 360, 500, head), feeds), HasSubstr("--feed: got 2"));
  feeds.feeds = {"0 m/min"};
  EXPECT_THAT(refused(circle_of(100, 360, 500, head), feeds), HasSubstr("--feed"));
}

/// `columns` gives the cells behind the angle, in degrees.
template <typename Cells>
std::string turn_table(const std::string& head, const Cells& cells) {
  std::string text = head;
  for (int i = 0; i <= 1440; ++i) text += fmt::format("{},{}\n", 0.25 * i, cells(i));
  return text;
}

TEST_F(BallBar, ColumnsOfADirectionGoBeforeThoseWithout) {
  const auto three = [](int i) { return fmt::format("{},3,{}", 2.0 * std::cos(0.5 * i * kDegree), 9); };
  for (const std::string names :
       {"deviation ccw [um],deviation cw [um],deviation mean [um]", "ccw [um],cw [um],radius mean [um]"}) {
    const auto got = judged({turn_table("angle [deg]," + names + "\n", three)}, sized());
    ASSERT_EQ(got.logs[0].circles.size(), 2U) << names;
    EXPECT_NEAR(got.logs[0].test->directions[0].circular_deviation, 4e-6, 0.02e-6);
    EXPECT_NEAR(got.logs[0].test->directions[1].radial_max, 3e-6, 1e-9);
    EXPECT_THAT(got.logs[0].notes, Contains(AllOf(HasSubstr("mean [um]\""), HasSubstr("left out"))));
  }
  const auto two = [](int) { return "100,ccw,ccw"; };
  EXPECT_THAT(refused(turn_table("angle [deg],radius [mm],direction,dir\n", two), sized()),
              AllOf(HasSubstr("could both be the direction"), HasSubstr("--map direction=")));
}

TEST_F(BallBar, ADirectionThatContradictsTheAnglesIsRefused) {
  std::string back = "angle [deg],deviation ccw [um],deviation cw [um]\n";
  for (int i = 0; i <= 2880; ++i) back += fmt::format("{},1,2\n", 0.25 * (i <= 1440 ? i : 2880 - i));
  EXPECT_THAT(refused(back, sized()),
              AllOf(HasSubstr("rows 1 to 2881 are counter-clockwise"), HasSubstr("goes forth and back")));
  const auto alternating = [](int i) { return i % 2 == 0 ? "1,ccw" : "1,cw"; };
  const std::string text = turn_table("angle [deg],deviation [um],direction\n", alternating);
  EXPECT_THAT(refused(text, sized()), HasSubstr("changes 1440 times in 1441 rows"));
  // A few rows between the directions say nothing about the turn, and all that is reversed is one note.
  std::string laps = "angle [deg],deviation [um],direction\n";
  for (int i = 0; i < 2884; ++i)
    laps +=
        fmt::format("{},1,{}\n", 0.25 * (i < 1441 ? i : std::max(i - 1443, 0)), i / 2 == 721 ? "ccw" : "cw");
  const auto got = judged({laps}, sized());
  EXPECT_EQ(std::count_if(got.logs[0].notes.begin(), got.logs[0].notes.end(),
                          [](const std::string& note) { return note.find("reversed order") != note.npos; }),
            1);
}

TEST_F(BallBar, OptionsGoBeforeWhatTheFileStates) {
  const std::string table = plain_table(rows_of(record()));
  CircleOptions told = sized();
  told.feeds = {"1000 mm/min"};
  for (const std::string stated : {"100 %", "0 mm/min"}) {
    const auto got = judged({"# feed: " + stated + "\n" + table}, told);
    EXPECT_NEAR(got.logs[0].diagnosis->peaks[0].feed, kFeed, 1e-12);
    EXPECT_THAT(got.logs[0].notes, Contains(HasSubstr("the stated \"feed\" is not used")));
    EXPECT_THAT(refused("# feed: " + stated + "\n" + table, sized()), HasSubstr("--feed"));
  }
  EXPECT_THAT(refused("# radius: 0 mm\n" + table), HasSubstr("--size"));
  // A count of rows is no radius.
  const auto counted = judged({"# size: 1441\n# radius: 100 mm\n" + table});
  EXPECT_NEAR(counted.radius, kR, 1e-12);
  EXPECT_NEAR(judged({"# size: 100 mm\n" + table}).radius, kR, 1e-12);
  CircleOptions mapped = sized();
  mapped.maps = {"angle=angle", "radius=radius mm"};
  const auto renamed = judged({plain_table(rows_of(record()), "angle [deg],radius [m]\n")}, mapped);
  EXPECT_THAT(renamed.logs[0].notes, Contains(AllOf(HasSubstr("--map"), HasSubstr("\"radius [m]\""))));
}

TEST_F(BallBar, NumbersAboveATableOfDecimalCommasHaveThemToo) {
  std::string table = "Winkel [deg];Abweichung [um]\n";
  for (int i = 0; i <= 1440; ++i) table += fmt::format("{},{};1,0\n", i / 4, 25 * (i % 4));
  const auto got = judged({"# Radius: 100,5 mm\n# Vorschub [mm/min]: 1000,0\n" + table});
  EXPECT_NEAR(got.radius, 0.1005, 1e-12);
  EXPECT_THAT(refused("# Radius: 100,0 mm\n# Vorschub: 1.000 mm/min\n" + table),
              AllOf(HasSubstr("\"1.000 mm/min\""), HasSubstr("decimal commas"), HasSubstr("--feed")));
  EXPECT_THAT(refused("# Radius: 100.000 mm\n" + table),
              AllOf(HasSubstr("decimal commas"), HasSubstr("--size")));
}

// --size went before the radius that the file states without a word: angles in um/m depend on it.
TEST_F(BallBar, SizeBesideAStatedRadiusIsNoted) {
  CircleOptions o;
  o.size = "90 mm";
  std::string table = "# radius: 100 mm\nangle [deg],radius [mm]\n";
  for (int k = 0; k < 1441; ++k) table += fmt::format("{},{:.4f}\n", k / 2.0, 100.0 + 0.001 * (k % 3));
  const auto got = judged({table}, o);
  EXPECT_THAT(got.warnings, Contains(AllOf(HasSubstr("states a radius of 100 mm"), HasSubstr("90 mm"))));
}

// A part program goes round without being a circle: its corners were taken for 26 mm of backlash.
TEST_F(BallBar, APathThatIsNoCircleIsRefused) {
  for (const bool commanded : {true, false}) {
    std::string text = commanded ? "t [s],x [mm],y [mm],rx [mm],ry [mm]\n" : "t [s],x [mm],y [mm]\n";
    for (int k = 0; k < 2160; ++k) {
      const double angle = 2.0 * kPi * k / 720.0;
      // A square with rounded corners, from 20 to 24.3 mm.
      const double r = 20e-3 / std::pow(std::pow(std::cos(angle), 8) + std::pow(std::sin(angle), 8), 0.125);
      const double x = 1e3 * r * std::cos(angle), y = 1e3 * r * std::sin(angle);
      text += fmt::format("{:.3f},{:.6f},{:.6f}", 0.01 * k, x, y);
      text += commanded ? fmt::format(",{:.6f},{:.6f}\n", x, y) : "\n";
    }
    EXPECT_THAT(refused(text), AllOf(HasSubstr("are no circle"), HasSubstr("--where"))) << commanded;
  }
}

}  // namespace
}  // namespace stribeck::workflow::ball_bar_test
