#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <stribeck/core/numbers.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/netcdf.hpp>
#include <stribeck/io/test_folder.hpp>

namespace stribeck::io::netcdf_test {
namespace {

using stribeck::test::Folder;
using stribeck::test::text_of;
using testing::HasSubstr;

bool has_library() { return ::dlopen("libnetcdf.so.19", RTLD_NOW) != nullptr; }

/// What a program of the netCDF project reads in the file; empty where it is not installed.
std::string dump_of(const std::string& file) {
  std::string text;
  FILE* const pipe = ::popen(("ncdump '" + file + "' 2>/dev/null").c_str(), "r");
  char buffer[4096];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
  ::pclose(pipe);
  return text;
}

void write(const std::string& path) {
  NetcdfFile file(path);
  const int run = file.dimension("run", 3);
  const int part = file.dimension("part", 2);
  const int mass = file.variable("x.mass", NetcdfFile::Type::kNumber, {run});
  const int state = file.variable("state", NetcdfFile::Type::kFlag, {run, part});
  const int name = file.variable("controller", NetcdfFile::Type::kText, {part});
  file.describe(mass, "units", "kg");
  file.describe_flag(state, {0, 1}, "ok lost");
  file.describe("title", "a table");
  file.begin();
  const std::vector<double> masses{55.5, kNaN};
  file.write(mass, {0}, {2}, masses);
  const std::vector<signed char> states{0, 1, 1, 0, 0, 0};
  file.write(state, {0, 0}, {3, 2}, states);
  file.write(name, {0}, "f");
  file.write(name, {1}, "größer");
  file.finish();
}

TEST(Netcdf, OthersReadWhatWasWritten) {
  if (!has_library()) GTEST_SKIP() << "libnetcdf is not installed";
  Folder f;
  write(f / "a.nc");
  EXPECT_EQ(f.files(), 1U);
  EXPECT_THAT(text_of(f / "a.nc"), testing::StartsWith("\x89HDF\r\n"));
  const std::string dump = dump_of(f / "a.nc");
  if (dump.empty()) GTEST_SKIP() << "ncdump is not installed";
  for (const char* part :
       {"run = 3 ;", "double x.mass(run) ;", "x.mass:units = \"kg\" ;", "x.mass:_FillValue = NaN ;",
        "byte state(run, part) ;", "state:flag_meanings = \"ok lost\" ;", ":title = \"a table\" ;",
        "x.mass = 55.5, _, _ ;", "controller = \"f\", \"größer\" ;", "state =\n  0, 1,\n  1, 0,\n  0, 0 ;"})
    EXPECT_THAT(dump, HasSubstr(part));
}

TEST(Netcdf, SameBytesAgain) {
  if (!has_library()) GTEST_SKIP() << "libnetcdf is not installed";
  Folder f;
  write(f / "a.nc");
  const std::string first = text_of(f / "a.nc");
  sleep(1);  // HDF5 can store times in seconds
  write(f / "a.nc");
  EXPECT_EQ(text_of(f / "a.nc"), first);
}

TEST(Netcdf, NothingIsLeftOfAnUnfinishedFile) {
  if (!has_library()) GTEST_SKIP() << "libnetcdf is not installed";
  Folder f;
  f.write("a.nc", "earlier");
  {
    NetcdfFile file(f / "a.nc");
    file.dimension("run", 3);
  }
  EXPECT_EQ(text_of(f / "a.nc"), "earlier");
  EXPECT_EQ(f.files(), 1U);
  EXPECT_THROW(NetcdfFile(f / "no/such/folder.nc"), InputError);
}

}  // namespace
}  // namespace stribeck::io::netcdf_test
