#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>

namespace stribeck::io {
namespace {

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

}  // namespace
}  // namespace stribeck::io
