#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/netcdf.hpp>
#include <system_error>

namespace stribeck::io {
namespace {

// As <netcdf.h> of netCDF 4 has them; they have not changed since 2008.
constexpr int kNetcdf4 = 0x1000;
constexpr int kGlobal = -1;
constexpr int kByte = 1;
constexpr int kDouble = 6;
constexpr int kString = 12;
constexpr int kFilled = 0;

constexpr std::array kNames{"libnetcdf.so.19", "libnetcdf.so.22", "libnetcdf.so.18", "libnetcdf.so"};

}  // namespace

struct NetcdfFile::Library {
  const char* (*strerror)(int);
  int (*create)(const char*, int, int*);
  int (*def_dim)(int, const char*, std::size_t, int*);
  int (*def_var)(int, const char*, int, int, const int*, int*);
  int (*def_var_fill)(int, int, int, const void*);
  int (*put_att_text)(int, int, const char*, std::size_t, const char*);
  int (*put_att_schar)(int, int, const char*, int, std::size_t, const signed char*);
  int (*enddef)(int);
  int (*put_vara_double)(int, int, const std::size_t*, const std::size_t*, const double*);
  int (*put_vara_schar)(int, int, const std::size_t*, const std::size_t*, const signed char*);
  int (*put_var1_string)(int, int, const std::size_t*, const char**);
  int (*close)(int);
  int (*abort)(int);
  bool whole = false;

  Library() {
    void* handle = nullptr;
    for (const char* name : kNames) {
      if (handle == nullptr) handle = ::dlopen(name, RTLD_NOW | RTLD_LOCAL);
    }
    if (handle == nullptr) return;
    whole = true;
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(handle, name));
      whole = whole && function != nullptr;
    };
    find(strerror, "nc_strerror");
    find(create, "nc_create");
    find(def_dim, "nc_def_dim");
    find(def_var, "nc_def_var");
    find(def_var_fill, "nc_def_var_fill");
    find(put_att_text, "nc_put_att_text");
    find(put_att_schar, "nc_put_att_schar");
    find(enddef, "nc_enddef");
    find(put_vara_double, "nc_put_vara_double");
    find(put_vara_schar, "nc_put_vara_schar");
    find(put_var1_string, "nc_put_var1_string");
    find(close, "nc_close");
    find(abort, "nc_abort");
  }
};

const NetcdfFile::Library& NetcdfFile::library(const std::string& path) {
  static const Library kLibrary;
  if (kLibrary.whole) return kLibrary;
  throw InputError(Problem{
      path, 0, {}, "netCDF needs the library libnetcdf, which is missing (apt-get install libnetcdf19)"});
}

void NetcdfFile::check(int status) const {
  if (status == 0) return;
  throw InputError(
      Problem{path_, 0, {}, std::string("cannot be written as netCDF: ") + library_->strerror(status)});
}

NetcdfFile::NetcdfFile(const std::string& path) : path_(path), library_(&library(path)) {
  check_writable(path);
  // A name that write_atomically() clears away after a kill.
  const std::filesystem::path target = link_target(path);
  temporary_ = (target.parent_path() / (".stribeck-" + std::to_string(::getpid()) + "-netcdf.tmp")).string();
  check(library_->create(temporary_.c_str(), kNetcdf4, &id_));
}

NetcdfFile::~NetcdfFile() {
  if (id_ >= 0) library_->abort(id_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

int NetcdfFile::dimension(const std::string& name, std::size_t size) {
  int id = 0;
  check(library_->def_dim(id_, name.c_str(), size, &id));
  return id;
}

int NetcdfFile::variable(const std::string& name, Type type, const std::vector<int>& dimensions) {
  int id = 0;
  const int kind = type == Type::kNumber ? kDouble : type == Type::kFlag ? kByte : kString;
  check(library_->def_var(id_, name.c_str(), kind, static_cast<int>(dimensions.size()), dimensions.data(),
                          &id));
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (type == Type::kNumber) check(library_->def_var_fill(id_, id, kFilled, &kNone));
  return id;
}

void NetcdfFile::describe(int variable, const std::string& name, const std::string& text) {
  check(library_->put_att_text(id_, variable, name.c_str(), text.size(), text.c_str()));
}

void NetcdfFile::describe(const std::string& name, const std::string& text) { describe(kGlobal, name, text); }

void NetcdfFile::describe_flag(int variable, const std::vector<signed char>& values,
                               const std::string& names) {
  check(library_->put_att_schar(id_, variable, "flag_values", kByte, values.size(), values.data()));
  describe(variable, "flag_meanings", names);
}

void NetcdfFile::begin() { check(library_->enddef(id_)); }

void NetcdfFile::write(int variable, const Places& from, const Places& count,
                       std::span<const double> values) {
  check(library_->put_vara_double(id_, variable, from.data(), count.data(), values.data()));
}

void NetcdfFile::write(int variable, const Places& from, const Places& count,
                       std::span<const signed char> values) {
  check(library_->put_vara_schar(id_, variable, from.data(), count.data(), values.data()));
}

void NetcdfFile::write(int variable, const Places& from, const std::string& text) {
  const char* one = text.c_str();
  check(library_->put_var1_string(id_, variable, from.data(), &one));
}

void NetcdfFile::finish() {
  const int status = library_->close(id_);
  id_ = -1;
  check(status);
  // Before the name: after a power cut there is the old file or the new one.
  const int fd = ::open(temporary_.c_str(), O_RDWR | O_CLOEXEC);
  const bool kept = fd >= 0 && ::fsync(fd) == 0;
  int error = errno;
  if (fd >= 0) ::close(fd);
  if (!kept || ::rename(temporary_.c_str(), link_target(path_).c_str()) != 0) {
    if (kept) error = errno;
    throw InputError(Problem{path_, 0, {}, "cannot be written: " + std::generic_category().message(error)});
  }
  temporary_.clear();
}

}  // namespace stribeck::io
