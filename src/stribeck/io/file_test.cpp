#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/write_at_once.hpp>

namespace stribeck::io::file_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "stribeck-file-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

TEST_F(Files, WhatHappensToAFileAfterItWasOpenedChangesNothing) {
  const std::string text(1 << 20, 'x');
  std::ofstream(path("a")) << text;
  const FileBytes bytes(path("a"));
  // A mapped file would end the program here by SIGBUS.
  std::filesystem::resize_file(path("a"), 0);
  EXPECT_EQ(bytes.view(), text);
}

TEST_F(Files, AnyLengthIsReadWhole) {
  for (const std::size_t n : {0u, 1u, 65535u, 65536u, 131072u, 300001u}) {
    std::string text(n, '\0');
    for (std::size_t i = 0; i < n; ++i) text[i] = static_cast<char>(i * 7 % 251);
    std::ofstream(path("b"), std::ios::binary) << text;
    EXPECT_EQ(FileBytes(path("b")).view(), text) << n;
  }
  // Tells no length.
  EXPECT_FALSE(FileBytes("/proc/self/status").view().empty());
}

/// Of everything in the folder.
std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST_F(Files, WrittenTogetherAppearTogether) {
  write_atomically(path("a"), "old");
  {
    WriteTogether all;
    write_atomically(path("a"), "new");
    write_atomically(path("b"), "new");
    EXPECT_EQ(read_text(path("a")), "old");
    EXPECT_FALSE(std::filesystem::exists(path("b")));
  }
  EXPECT_THAT(names_in(folder_), ElementsAre("a"));
  EXPECT_EQ(read_text(path("a")), "old");
  std::filesystem::create_directory(path("made"));
  std::filesystem::create_directory(path("empty"));
  {
    WriteTogether all;
    write_atomically(path("a"), "new");
    write_atomically(path("made/b"), "new", FileIs::kProgram);
    WriteTogether::remove_at_end_if_empty({path("made"), path("empty")});
    // A part of it does not end it.
    WriteTogether inner;
    write_atomically(path("c"), "new");
    inner.commit();
    EXPECT_FALSE(std::filesystem::exists(path("c")));
    all.commit();
  }
  EXPECT_THAT(names_in(folder_), ElementsAre("a", "c", "made"));
  EXPECT_EQ(read_text(path("a")), "new");
  EXPECT_EQ(::access(path("made/b").c_str(), X_OK), 0);
}

TEST_F(Files, AtOnceIsAtOnceInsideThoseWrittenTogether) {
  WriteTogether all;
  write_atomically(path("a"), "late");
  {
    const WriteAtOnce at_once;
    write_atomically(path("b"), "at once");
    EXPECT_EQ(read_text(path("b")), "at once");
  }
  write_atomically(path("c"), "late");
  EXPECT_THAT(names_in(folder_), ElementsAre("b"));
  all.commit();
  EXPECT_THAT(names_in(folder_), ElementsAre("a", "b", "c"));
}

TEST_F(Files, LinksAreFollowedToWhatIsNotThereYet) {
  std::filesystem::create_directory(path("there"));
  std::filesystem::create_symlink("there/file", path("link"));
  std::filesystem::create_symlink("link", path("link2"));
  check_writable(path("link2"));
  write_atomically(path("link2"), "text");
  EXPECT_EQ(read_text(path("there/file")), "text");
  EXPECT_TRUE(std::filesystem::is_symlink(path("link")) && std::filesystem::is_symlink(path("link2")));
  EXPECT_EQ(link_target(path("link2")), path("there/file"));

  std::filesystem::create_symlink("nowhere/file", path("astray"));
  EXPECT_THAT([&] { check_writable(path("astray")); }, ThrowsMessage<InputError>(HasSubstr("no folder")));
  std::filesystem::create_symlink("loop", path("loop"));
  for (const auto& write : {+[](const std::string& p) { check_writable(p); },
                            +[](const std::string& p) { write_atomically(p, "x"); }}) {
    EXPECT_THAT([&] { write(path("loop")); },
                ThrowsMessage<InputError>(HasSubstr("Too many levels of symbolic links")));
  }
  EXPECT_THAT([&] { read_text(path("loop")); },
              ThrowsMessage<InputError>(HasSubstr("Too many levels of symbolic links")));
}

TEST_F(Files, NamesAreAsLongAsTheFileSystemHasThem) {
  const std::string longest(255, 'n');
  check_writable(path(longest));
  write_atomically(path(longest), "text");
  EXPECT_EQ(read_text(path(longest)), "text");
  EXPECT_THAT([&] { check_writable(path(longest + "n")); },
              ThrowsMessage<InputError>(HasSubstr("File name too long")));
  EXPECT_THAT(names_in(folder_), ElementsAre(longest));
}

TEST_F(Files, WhatAKilledProgramLeftIsCleared) {
  std::ofstream(path(".stribeck-1-0.tmp")) << "left";
  std::ofstream(path(".stribeck-1-1.tmp")) << "of one that still runs";
  const int held = ::open(path(".stribeck-1-1.tmp").c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(::flock(held, LOCK_EX), 0);
  std::ofstream(path(".stribeck-notes")) << "of the user";
  write_atomically(path("a"), "text");
  EXPECT_THAT(names_in(folder_), ElementsAre(".stribeck-1-1.tmp", ".stribeck-notes", "a"));
  ::close(held);
}

}  // namespace
}  // namespace stribeck::io::file_test
