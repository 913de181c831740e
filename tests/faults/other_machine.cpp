#include "other_machine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

namespace stribeck::test {

void MaxwellAxis::move(double force) {
  constexpr int kParts = 50;
  constexpr double kStep = kPeriod / kParts;
  constexpr double kRate = 2.0 * M_PI * 40.0;
  const double table_mass = with_mode_ ? 0.5 * mass_ : 0.0;
  for (int part = 0; part < kParts; ++part) {
    acts_ += kStep / 0.3e-3 * (force - acts_);
    const double stiffness = 1.0 + 0.2 * std::sin(x / 0.3e-3);
    double friction = friction_ * 4000.0 * v;
    for (std::size_t i = 0; i < spring_.size(); ++i) {
      const double k = 7e5 * stiffness;
      const double slip = friction_ * 0.6 * (1.0 + static_cast<double>(i));  // 33 N altogether
      spring_[i] = std::clamp(spring_[i] + k * kStep * v, -slip, slip);
      friction += spring_[i];
    }
    double between = 0.0;
    if (with_mode_) {
      between = table_mass * (kRate * kRate * (table_ - x) + 2.0 * 0.03 * kRate * (table_speed_ - v));
      table_speed_ -= kStep * between / table_mass;
      table_ += kStep * table_speed_;
    }
    v += kStep * (acts_ + between - friction) / (mass_ - table_mass);
    x += kStep * v;
  }
}

double MaxwellAxis::encoder() const { return 1e-7 * std::round(x / 1e-7); }

OtherMachine::OtherMachine(const std::string& law, const Odd& odd)
    : axis{MaxwellAxis(900.0 * odd.mass, odd.friction, odd.mode),
           MaxwellAxis(800.0 * odd.mass, odd.friction, odd.mode)},
      limit_(odd.force_limit),
      size_(stribeck_controller_size_for(2, law.c_str())) {
  memory_ = ::operator new(size_, std::align_val_t(stribeck_alignment()));
  c = stribeck_controller_init(memory_, size_, 2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    choose(i, "law", law.c_str());
    set(i, "mass", 860.0);
    set(i, "omega", 60.0);
    set(i, "friction.conventional.alpha0", 30.0);
    set(i, "friction.conventional.alpha2", 4200.0);
    choose(i, "friction.dynamics", "lugre");
    set(i, "friction.lugre.sigma0", 6.5e6);
    set(i, "friction.lugre.sigma1", 70e3);
    choose(i, "feedforward", "dynamic");
    choose(i, "observer", "disturbance");
    set(i, "guarded", 1.0);
    set(i, "force_limit", limit_);
    choose(i, "supervision.checks", "all");
    set(i, "supervision.speed_limit", 16e-3);
    set(i, "supervision.acceleration_limit", 0.1);
    if (law == "learning") set(i, "learning.lap", 2.0 * M_PI);
  }
  if (stribeck_controller_configure(c, kPeriod) != STRIBECK_OK)
    throw std::runtime_error(stribeck_controller_problem(c));
  axis[0].start(10e-3);
}

OtherMachine::~OtherMachine() { ::operator delete(memory_, std::align_val_t(stribeck_alignment())); }

void OtherMachine::set(std::uint32_t i, const char* name, double x) {
  if (stribeck_controller_set(c, i, name, x) != STRIBECK_OK)
    throw std::runtime_error(stribeck_controller_problem(c));
}

void OtherMachine::choose(std::uint32_t i, const char* name, const char* word) {
  if (stribeck_controller_choose(c, i, name, word) != STRIBECK_OK)
    throw std::runtime_error(stribeck_controller_problem(c));
}

void OtherMachine::period() {
  // The angle accelerates to 1 rad/s within the first second.
  const double t = time();
  const double phi = t < 1.0 ? 0.5 * t * t : t - 0.5;
  const double rate = t < 1.0 ? t : 1.0;
  const double acceleration = t < 1.0 ? 1.0 : 0.0;
  const double angle[2] = {phi, phi - 0.5 * M_PI};
  stribeck_axis_input in[2];
  error = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double cosine = std::cos(angle[i]);
    const double sine = std::sin(angle[i]);
    in[i].position = 10e-3 * cosine;
    in[i].velocity = -10e-3 * sine * rate;
    in[i].acceleration = -10e-3 * (cosine * rate * rate + sine * acceleration);
    in[i].measured = encoder ? encoder(t, i, axis[i].encoder()) : axis[i].encoder();
    error = std::max(error, std::abs(axis[i].table() - in[i].position));
  }
  if (t >= command_lost) in[0].position = std::numeric_limits<double>::quiet_NaN();
  stribeck_controller_set_phase(c, phi);
  result = stribeck_controller_step(c, in, force.data());
  for (std::size_t i = 0; i < 2; ++i) {
    limited = limited || (result == STRIBECK_OK && signals(static_cast<std::uint32_t>(i)).limited != 0);
    good = good && std::abs(force[i]) <= limit_;  // not so for what is no number
    axis[i].move(acts ? acts(t, i, force[i]) : force[i]);
  }
  ++k_;
}

void OtherMachine::run_to(double t) {
  while (time() < t) period();
}

double OtherMachine::worst_to(double t) {
  double most = 0.0;
  while (time() < t) {
    period();
    most = std::max(most, error);
  }
  return most;
}

double OtherMachine::moved_to(double t) {
  const double from[2] = {axis[0].table(), axis[1].table()};
  double most = 0.0;
  while (time() < t) {
    period();
    for (std::size_t i = 0; i < 2; ++i) most = std::max(most, std::abs(axis[i].table() - from[i]));
  }
  return most;
}

stribeck_supervision OtherMachine::why() const {
  stribeck_supervision s{};
  stribeck_controller_supervision(c, &s, sizeof s);
  return s;
}

stribeck_axis_signals OtherMachine::signals(std::uint32_t i) const {
  stribeck_axis_signals now{};
  stribeck_controller_signals(c, i, &now, sizeof now);
  return now;
}

}  // namespace stribeck::test
