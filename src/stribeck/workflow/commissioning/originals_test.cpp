#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <stribeck/io/error.hpp>
#include <stribeck/io/test_folder.hpp>
#include <stribeck/workflow/commissioning/originals.hpp>

namespace stribeck::workflow::commissioning::originals_test {
namespace {

using test::Folder;
using test::text_of;

TEST(Originals, ComeBackByteForByte) {
  const Folder folder;
  const std::string bytes("[HAL]\r\nHALFILE = a\0b.hal\r\n\xff", 27);
  const std::string ini = folder.write("mill.ini", bytes);
  ASSERT_EQ(::chmod(ini.c_str(), 0640), 0);
  const std::string hal = folder / "new.hal";
  const std::string state = folder / "state";
  std::filesystem::create_directory(state);
  replace_files(state, {{ini, "first"}, {hal, "setp a 1\n"}});
  EXPECT_EQ(text_of(ini), "first");
  replace_files(state, {{ini, "second"}});
  EXPECT_EQ(restore_files(state).size(), 2U);
  EXPECT_EQ(text_of(ini), bytes);
  EXPECT_FALSE(std::filesystem::exists(hal));
  struct stat now {};
  ASSERT_EQ(::stat(ini.c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 0777U, 0640U);
  EXPECT_TRUE(restore_files(state).empty()) << "a second time there is nothing to do";
}

// A file that the first call did not name was written over, and did not come back.
TEST(Originals, OfFilesThatASecondCallAddsComeBackToo) {
  const Folder folder;
  const std::string first = folder.write("mill.ini", "first");
  const std::string second = folder.write("lathe.ini", "second");
  const std::string state = folder / "state";
  std::filesystem::create_directory(state);
  replace_files(state, {{first, "new"}});
  replace_files(state, {{second, "new"}, {folder / "more.hal", "new"}});
  restore_files(state);
  EXPECT_EQ(text_of(first), "first");
  EXPECT_EQ(text_of(second), "second");
  EXPECT_FALSE(std::filesystem::exists(folder / "more.hal"));
}

TEST(Originals, ComeBackFromAChangeThatWasInterrupted) {
  const Folder folder;
  const std::string ini = folder.write("mill.ini", "old");
  const std::string hal = folder.write("mill.hal", "old");
  const std::string state = folder / "state";
  std::filesystem::create_directory(state);
  replace_files(state, {{ini, "new"}, {hal, "new"}});
  // As if it had been killed between the two.
  folder.write("mill.hal", "old");
  restore_files(state);
  EXPECT_EQ(text_of(ini), "old");
  EXPECT_EQ(text_of(hal), "old");
}

TEST(Originals, DoNotTouchWhatSomebodyElseChanged) {
  const Folder folder;
  const std::string ini = folder.write("mill.ini", "old");
  const std::string state = folder / "state";
  std::filesystem::create_directory(state);
  replace_files(state, {{ini, "new"}});
  folder.write("mill.ini", "mine");
  EXPECT_THROW(restore_files(state), io::InputError);
  EXPECT_THROW(replace_files(state, {{ini, "newer"}}), io::InputError);
  EXPECT_EQ(text_of(ini), "mine");
}

TEST(Originals, LineOfTheModelsComesLast) {
  EXPECT_EQ(with_halfile("[HAL]\nHALFILE = a.hal\n  HALFILE = b.hal\n# end\n[TRAJ]\nHALFILE = no\n", "m.hal"),
            "[HAL]\nHALFILE = a.hal\n  HALFILE = b.hal\nHALFILE = m.hal\n# end\n[TRAJ]\nHALFILE = no\n");
  EXPECT_EQ(with_halfile("[HAL]\r\nHALFILE=a.hal\r\n", "m.hal"),
            "[HAL]\r\nHALFILE=a.hal\r\nHALFILE = m.hal\r\n");
  EXPECT_EQ(with_halfile("[HAL]\nHALFILE = a.hal", "m.hal"), "[HAL]\nHALFILE = a.hal\nHALFILE = m.hal\n");
  const std::string there = "[HAL]\nHALFILE = m.hal\nHALFILE = a.hal\n";
  EXPECT_EQ(with_halfile(there, "m.hal"), there);
  EXPECT_EQ(with_halfile("[TRAJ]\n", "m.hal"), "");
}

}  // namespace
}  // namespace stribeck::workflow::commissioning::originals_test
