#include <array>
#include <limits>

#include <stribeck/workflow/reproduce/numbers.hpp>
#include <stribeck/workflow/reproduce/printed_tables.hpp>

namespace stribeck::workflow::reproduction {

namespace {

/// A row of a table of the thesis, in its units (N, mm, rad). Never used as an input of an identification.
struct Printed {
  std::string_view table;
  std::string_view of;  ///< axis; with + or − for one direction
  std::array<double, 11> value;
};

constexpr std::array kPrinted{
    // m [N s2/mm, printed as "Kg"], α0, α1, α2; v0 = δ = 0: no Stribeck part
    Printed{"2.1", "x", {57.65, 1255.38, 1255.38, 105.54}},
    Printed{"2.1", "y", {58.93, 1066.05, 1066.05, 138.86}},
    Printed{"2.2", "x", {56.61, 1352.63, 1185.45, 113.54}},
    Printed{"2.2", "y", {59.03, 1162.05, 1066.23, 111.86}},
    // η0, η1, then a, b, c of three Gaussians
    Printed{"2.3", "x+", {768.6, 102.48, 517.4, 1.763, 3.091, 509.3, 5.806, 1.825, 1995.9, 10.668, 1.876}},
    Printed{
        "2.3", "x-", {-768.6, 102.48, -378.2, -2.163, 2.265, -547.5, -5.912, 1.761, -4472.0, -13.99, 3.659}},
    Printed{"2.3", "y+", {640.5, 140.91, 518.0, 1.766, 1.986, 852.0, 5.872, 2.733, 1059.1, 10.27, 1.744}},
    Printed{
        "2.3", "y-", {-640.5, 140.91, -371.34, -1.963, 2.997, -236.1, -5.804, 1.223, -354.97, -9.311, 0.475}},
    // α0, α1, α2, v0, δ
    Printed{"4.2", "x", {20.0, 35.0, 5.0, 0.6, 2.0}},
    Printed{"4.2", "y", {15.0, 30.0, 3.0, 0.9, 2.0}},
    Printed{"4.2", "z", {25.0, 40.0, 5.0, 0.4, 2.0}},
    // η0, η1, η2, η3; Table 2.4 prints the same
    Printed{"4.3", "x", {18.0, 4.5, 4.2, 0.28}},
    Printed{"4.3", "y", {15.0, 3.0, 11.2, -0.27}},
    Printed{"4.3", "z", {24.0, 4.0, 2.5, 0.31}},
    // m [N s2/mm], g [N]
    Printed{"4.4", "x", {1.0, 0.0}},
    Printed{"4.4", "y", {0.8, 0.0}},
    Printed{"4.4", "z", {0.8, 10.0}},
};

}  // namespace

double printed(std::string_view table, std::string_view of, std::size_t column) {
  for (const Printed& p : kPrinted) {
    if (p.table == table && p.of == of) return p.value[column];
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// Table 2.3 as a map.
friction::Gaussian<double> printed_map(const std::string& axis) {
  const auto branch = [&](const char* direction) {
    const auto p = [&](std::size_t i) { return printed("2.3", axis + direction, i); };
    friction::GaussianBranch<double> b;
    b.eta0 = p(0);
    b.eta1 = p(1) * kKilo;
    for (std::size_t i = 2; i < 11; i += 3)
      b.gaussians.push_back({p(i), p(i + 1) * kMilli, p(i + 2) * kMilli});
    return b;
  };
  friction::Gaussian<double> map;
  map.velocity_range = {-9.5e-3, 9.5e-3};
  map.positive = branch("+");
  map.negative = branch("-");
  return map;
}

}  // namespace stribeck::workflow::reproduction
