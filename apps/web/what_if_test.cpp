#include <gmock/gmock.h>

#include <chrono>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>

#include <apps/web/newest.hpp>
#include <apps/web/uploads.hpp>
#include <apps/web/what_if.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/machine/machine_file.hpp>

namespace stribeck::web::what_if_test {
namespace {

using nlohmann::ordered_json;
using namespace std::chrono_literals;

const auto kNeverOld = [] { return false; };

class WhatIfTest : public testing::Test {
 protected:
  WhatIfRequest asked() {
    WhatIfRequest r;
    r.machine = "built-in/biaxial-table";
    r.controllers = {"a"};
    return r;
  }
  static double peak(const ordered_json& answer) {
    return answer["result"]["rows"][0]["max_contour_error_um"];
  }

  test::Folder folder_;
  Machines machines_{folder_ / ""};
  WhatIf what_if_{machines_};
};

TEST_F(WhatIfTest, FiguresAreThoseOfCompare) {
  const std::string file = std::string(STRIBECK_SOURCE_DIR) + "/machines/biaxial-table.toml";
  workflow::ComparisonOptions o;
  o.machine = file;
  o.trials = 1;
  o.path.laps = 1.0;
  o.speeds = {"9.5 mm/s"};
  o.only = {"a", "c", "h"};
  WhatIfRequest r = asked();
  r.controllers = o.only;
  EXPECT_EQ(what_if_.run(r, kNeverOld)["result"], workflow::to_json(workflow::run_comparison(o)));
}

TEST_F(WhatIfTest, ExperimentsAreThoseOfCompare) {
  workflow::ComparisonOptions o;
  o.machine = std::string(STRIBECK_SOURCE_DIR) + "/machines/uniaxial-drive.toml";
  o.trials = 1;
  WhatIfRequest r = asked();
  r.machine = "built-in/uniaxial-drive";
  EXPECT_EQ(what_if_.run(r, kNeverOld)["result"], workflow::to_json(workflow::run_comparison(o)));
}

/// A machine whose values are changed by a request is the machine whose file has these values.
TEST_F(WhatIfTest, ChangedIsAsWritten) {
  WhatIfRequest r = asked();
  r.identify_changed = true;
  r.changes = {{"*.friction.coulomb", 1.7, {}}, {"x.mass", {}, "70 N s2/mm"}, {"y.delay_periods", {}, "1"}};
  r.sample_time = "4 ms";
  const ordered_json by_request = what_if_.run(r, kNeverOld);
  folder_.write("changed.toml", what_if_.machine_file(r));
  WhatIfRequest plain = asked();
  plain.machine = "folder/changed.toml";
  EXPECT_EQ(by_request["result"]["rows"], what_if_.run(plain, kNeverOld)["result"]["rows"]);
  EXPECT_NE(peak(by_request), peak(what_if_.run(asked(), kNeverOld)));
  EXPECT_TRUE(by_request["command"].is_null());
}

/// Without compensation the peak at a reversal is the step of friction that the loop has to take up.
TEST_F(WhatIfTest, MoreFrictionLargerPeak) {
  WhatIfRequest r = asked();
  r.changes = {{"*.friction.coulomb", 2.0, {}}};
  const double twice = peak(what_if_.run(r, kNeverOld));
  const double once = peak(what_if_.run(asked(), kNeverOld));
  EXPECT_GT(twice, 1.7 * once);
  EXPECT_LT(twice, 2.3 * once);
}

TEST_F(WhatIfTest, PeaksStayInTheCurves) {
  const ordered_json answer = what_if_.run(asked(), kNeverOld);
  double largest = 0.0;
  const ordered_json& c = answer["curves"][0];
  for (std::size_t k = 0; k < c["error_um"].size(); ++k) {
    if (c["scored"][k] == 1) largest = std::max(largest, std::abs(c["error_um"][k].get<double>()));
  }
  EXPECT_NEAR(largest, peak(answer), 1e-3);  // a digit behind what is sent
  EXPECT_LT(c["t_s"].size(), 2000U);
}

TEST_F(WhatIfTest, IdentifiedOnce) {
  WhatIfRequest r = asked();
  r.controllers = {"h"};
  what_if_.run(r, kNeverOld);
  r.changes = {{"*.friction.coulomb", 1.2, {}}};
  // An identification takes seconds, looking one up microseconds.
  EXPECT_LT(what_if_.run(r, kNeverOld)["identified_in_ms"].get<double>(), 100.0);
}

TEST_F(WhatIfTest, GivesUpForANewerOne) {
  int calls = 0;
  WhatIfRequest r = asked();
  r.controllers = {"a", "d"};
  EXPECT_THROW(what_if_.run(r, [&] { return ++calls > 2; }), Outdated);
}

TEST_F(WhatIfTest, EveryBuiltInMachineHasAForm) {
  for (const MachineName& m : machines_.names()) {
    const ordered_json form = what_if_.form(m.id);
    EXPECT_FALSE(form["motions"].empty()) << m.id;
    EXPECT_FALSE(form["motions"][form["motion"].get<std::string>()]["controllers"].empty()) << m.id;
    bool friction = false;
    for (const ordered_json& p : form["parameters"]) friction = friction || p["key"] == "friction.coulomb";
    EXPECT_TRUE(friction) << m.id;
  }
}

// N and mm of an axis that turns would be wrong by three powers of ten to who reads its inertia.
TEST_F(WhatIfTest, AxesThatTurnAreNamed) {
  sim::Machine machine = machines_.read("built-in/biaxial-table").first;
  machine.axes[1].second.rotary = true;
  folder_.write("turning.toml", workflow::machine_text(machine, ""));
  const ordered_json form = what_if_.form("folder/turning.toml");
  EXPECT_EQ(form["rotary"], ordered_json({false, true}));
  bool seen = false;
  for (const ordered_json& p : form["parameters"]) {
    if (p["key"] != "mass") continue;
    seen = true;
    EXPECT_FALSE(p["turning"].contains("x"));
    const ordered_json& t = p["turning"]["y"];
    EXPECT_EQ(t["unit"], "kg m2");
    // 1 N s2/mm of the file is 1000 kg, at a radius of 1 m 1000 kg m2.
    EXPECT_NEAR(t["factor"].get<double>(), 1000.0, 1e-9);
  }
  EXPECT_TRUE(seen);
  EXPECT_EQ(what_if_.form("built-in/biaxial-table")["rotary"], ordered_json({false, false}));
}

TEST_F(WhatIfTest, OnlyMotionsOfTheThesisAreCalledSo) {
  const auto thesis = [&](const std::string& id) {
    return what_if_.form(id)["motions"]["experiment"].value("thesis", false);
  };
  EXPECT_TRUE(thesis("built-in/uniaxial-drive"));
  EXPECT_TRUE(thesis("built-in/triaxial-tool"));
  EXPECT_FALSE(thesis("built-in/five-axis-mill"));
}

TEST_F(WhatIfTest, OneAxisAndThree) {
  WhatIfRequest r = asked();
  r.machine = "built-in/uniaxial-drive";
  EXPECT_GT(peak(what_if_.run(r, kNeverOld)), 1.0);
  r.machine = "built-in/triaxial-tool";
  const ordered_json answer = what_if_.run(r, kNeverOld);
  EXPECT_EQ(answer["axes"].size(), 3U);
  EXPECT_EQ(answer["friction"].size(), 3U);
}

TEST_F(WhatIfTest, FolderOfMachines) {
  folder_.write("good.toml", what_if_.machine_file(asked()));
  folder_.write("wrong.toml", "sample_time = \"5 ms\"\n[axes]\n");
  folder_.write("study.toml", "machine = \"good.toml\"\n");
  const ordered_json list = machines_.list();
  std::vector<std::string> ids;
  for (const ordered_json& m : list) {
    ids.push_back(m["id"]);
    EXPECT_EQ(m["refused"].is_null(), m["id"] != "folder/wrong.toml") << m;
  }
  EXPECT_THAT(ids,
              testing::IsSupersetOf({"built-in/biaxial-table", "folder/good.toml", "folder/wrong.toml"}));
  EXPECT_THAT(ids, testing::Not(testing::Contains("folder/study.toml")));
  for (const char* id :
       {"folder/../good.toml", "folder/./good.toml", "good.toml", "", "built-in/none", "built-in/"})
    EXPECT_THROW(static_cast<void>(machines_.read(id)), io::InputError) << id;
}

TEST(Uploads, NamesAndBounds) {
  std::filesystem::path folder;
  {
    Uploads uploads;
    folder = uploads.folder();
    for (const char* odd : {"../../etc/passwd", "..\\x.csv", "", ".", "a\nb", ".profile"}) {
      const Upload u = uploads.add(odd, "t,x\n");
      EXPECT_EQ(u.file.parent_path().parent_path(), folder) << odd;
      EXPECT_EQ(test::text_of(u.file.string()), "t,x\n") << odd;
    }
    const Upload first = uploads.add("first.csv", "1");
    for (std::size_t i = 0; i < Uploads::kMostFiles; ++i) uploads.add("more.csv", "2");
    EXPECT_THROW(static_cast<void>(uploads.find(first.id)), io::InputError);
    EXPECT_FALSE(std::filesystem::exists(first.file));
    const Upload last = uploads.add("last.csv", "3");
    uploads.remove(last.id);
    uploads.remove("no");
    EXPECT_FALSE(std::filesystem::exists(last.file));
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(Newest, OfEachClientTheNewest) {
  Newest thread(2);
  std::promise<void> go;
  const std::shared_future<void> gone(go.get_future());
  std::promise<void> started;
  std::vector<std::string> done;
  std::promise<void> all;
  const auto job = [&](const std::string& name) {
    return Newest::Job{[&, name](const Newest::IsOld&) {
                         done.push_back(name);
                         if (name == "b1") all.set_value();
                       },
                       [&, name] { done.push_back("no " + name); }};
  };
  bool first_was_old = false;
  ASSERT_TRUE(thread.post("a", {[&](const Newest::IsOld& old) {
                                  started.set_value();
                                  gone.wait();
                                  first_was_old = old();
                                },
                                {}}));
  started.get_future().wait();
  EXPECT_TRUE(thread.post("a", job("a2")));
  EXPECT_TRUE(thread.post("b", job("b1")));
  EXPECT_FALSE(thread.post("c", job("c1")));  // two wait
  EXPECT_TRUE(thread.post("a", job("a3")));
  go.set_value();
  all.get_future().wait();
  EXPECT_TRUE(first_was_old);
  EXPECT_THAT(done, testing::ElementsAre("no a2", "a3", "b1"));
  EXPECT_TRUE(thread.stop(10s));
  EXPECT_FALSE(thread.post("d", job("d1")));
}

TEST(Newest, DoesNotWaitForeverAtTheEnd) {
  auto go = std::make_shared<std::promise<void>>();
  auto ended = std::make_shared<std::promise<void>>();
  std::promise<void> started;
  {
    Newest thread;
    thread.post("a", {[&, go, ended](const Newest::IsOld&) {
                        started.set_value();
                        go->get_future().wait();
                        ended->set_value();
                      },
                      {}});
    started.get_future().wait();
    EXPECT_FALSE(thread.stop(1ms));
  }
  go->set_value();
  ended->get_future().wait();
}

}  // namespace
}  // namespace stribeck::web::what_if_test
