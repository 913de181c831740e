#include "breaks.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <random>

namespace stribeck::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMicro = 1e-6;
constexpr double kMilli = 1e-3;
constexpr unsigned kSeed = 900001;

using Apply = std::function<void(Broken&, const Sound&, std::size_t)>;

/// One sample of the first axis is off by x.
Apply one_sample(double x) {
  return [x](Broken& b, const Sound& s, std::size_t) {
    const double when = s.when;
    const double half = 0.5 * s.period;
    b.encoder = [=](double t, std::size_t axis, double reading) {
      return axis == 0 && std::abs(t - when) < half ? reading + x : reading;
    };
  };
}

/// No sample of any axis is a number for so long.
Apply missing(double duration) {
  return [duration](Broken& b, const Sound& s, std::size_t) {
    const double from = s.when - 0.5 * s.period;
    b.encoder = [=](double t, std::size_t, double reading) {
      return t > from && t < from + duration ? kNan : reading;
    };
  };
}

/// All encoders stand for so long.
Apply frozen(double duration) {
  return [duration](Broken& b, const Sound& s, std::size_t) {
    const auto held = std::make_shared<std::map<std::size_t, double>>();
    const double from = s.when - 0.5 * s.period;
    b.encoder = [=](double t, std::size_t axis, double reading) {
      if (t < from || t > from + duration) return reading;
      return held->emplace(axis, reading).first->second;
    };
  };
}

/// Every sample from then on is so many periods old; with `at_random` up to so many.
Apply late(std::size_t samples, bool at_random = false) {
  return [=](Broken& b, const Sound& s, std::size_t) {
    const auto past = std::make_shared<std::map<std::size_t, std::deque<double>>>();
    const auto random = std::make_shared<std::mt19937>(kSeed);
    const double from = s.when - 0.5 * s.period;
    b.encoder = [=](double t, std::size_t axis, double reading) {
      std::deque<double>& last = (*past)[axis];
      last.push_front(reading);
      if (last.size() > samples + 1) last.pop_back();
      if (t < from) return reading;
      const std::size_t by = at_random ? (*random)() % (samples + 1) : samples;
      return last[std::min(by, last.size() - 1)];
    };
  };
}

void dropped(Broken& b, const Sound& s, std::size_t) {
  struct Held {
    std::map<std::size_t, double> last;
    std::map<std::size_t, int> in_a_row;
    std::mt19937 random{kSeed};
  };
  const auto held = std::make_shared<Held>();
  const double from = s.when - 0.5 * s.period;
  b.encoder = [=](double t, std::size_t axis, double reading) {
    // Four in a row are a frozen encoder at 5 ms.
    const bool drop = t > from && held->random() % 10 == 0 && held->in_a_row[axis] < 3;
    held->in_a_row[axis] = drop ? held->in_a_row[axis] + 1 : 0;
    if (!drop) held->last[axis] = reading;
    return drop ? held->last[axis] : reading;
  };
}

/// The noise that rounding makes, times this.
Apply noise(double times) {
  return [times](Broken& b, const Sound& s, std::size_t) {
    const auto random = std::make_shared<std::mt19937>(kSeed);
    const Sound sound = s;
    b.encoder = [=](double t, std::size_t axis, double reading) {
      if (t < sound.when) return reading;
      const double half = 0.5 * times * sound.resolution[axis];
      return reading + std::uniform_real_distribution(-half, half)(*random);
    };
  };
}

Apply force_limit(double share) {
  return [share](Broken& b, const Sound& s, std::size_t) {
    b.force_limit = s.limit;
    for (std::size_t i = 0; i < s.axes; ++i) (*b.force_limit)[i] = share * s.peak[i];
  };
}

void ripple(Broken& b, const Sound& s, std::size_t) {
  struct Place {
    std::map<std::size_t, double> of;
  };
  const auto place = std::make_shared<Place>();
  const Sound sound = s;
  b.encoder = [=](double, std::size_t axis, double reading) { return place->of[axis] = reading; };
  b.force = [=](double t, std::size_t axis, double force) {
    if (t < sound.when) return force;
    return force + 0.1 * sound.peak[axis] * std::sin(2.0 * M_PI * place->of[axis] / kMilli);
  };
}

std::vector<Break> of_the_encoder() {
  const auto jump = [](Broken& b, const Sound& s, std::size_t) {
    const double from = s.when - 0.5 * s.period;
    b.encoder = [=](double t, std::size_t axis, double x) { return axis == 0 && t > from ? x + kMilli : x; };
  };
  return {
      {"one sample 3 µm off", End::kGoesOnSoon, 20 * kMicro, false, Since::kWhen, one_sample(3 * kMicro)},
      {"one sample 1 mm off", End::kGoesOnSoon, 20 * kMicro, false, Since::kWhen, one_sample(kMilli)},
      {"one sample 1 m off", End::kGoesOnSoon, 20 * kMicro, false, Since::kWhen, one_sample(1.0)},
      {"one sample 1e300 m off", End::kGoesOnSoon, 20 * kMicro, false, Since::kWhen, one_sample(1e300)},
      {"one sample missing", End::kGoesOnSoon, 20 * kMicro, false, Since::kWhen,
       [](Broken& b, const Sound& s, std::size_t axis) { missing(s.period)(b, s, axis); }},
      {"10 ms of samples missing", End::kGoesOnSoon, 20 * kMicro, false, Since::kWhen, missing(10e-3)},
      {"encoder lost", End::kStops, kMilli, true, Since::kWhen, missing(1e9)},
      {"encoder frozen for 0.1 s", End::kEither, 2 * kMilli, false, Since::kWhen, frozen(0.1)},
      {"encoder frozen for 1 s", End::kStops, 2 * kMilli, false, Since::kWhen, frozen(1.0)},
      {"jump of 1 mm that stays", End::kStops, kMilli, true, Since::kWhen, jump},
      {"encoder noise × 100", End::kEither, 2 * kMilli, false, Since::kWhen, noise(100.0)},
      {"samples 1 period late", End::kEither, 2 * kMilli, false, Since::kWhen, late(1)},
      {"samples 2 periods late", End::kEither, 2 * kMilli, false, Since::kWhen, late(2)},
      {"samples 3 periods late", End::kEither, 2 * kMilli, false, Since::kWhen, late(3)},
      {"samples 5 periods late", End::kEither, 2 * kMilli, false, Since::kWhen, late(5)},
      {"samples 0 to 3 periods late, at random", End::kEither, 2 * kMilli, false, Since::kWhen,
       late(3, true)},
      {"a tenth of the samples dropped", End::kGoesOn, 5 * kMicro, false, Since::kWhen, dropped},
      {"encoder with the wrong sign", End::kStops, 0.5 * kMilli, false, Since::kStartEachAxis,
       [](Broken& b, const Sound&, std::size_t wrong) {
         const auto zero = std::make_shared<double>(kNan);
         b.encoder = [=](double, std::size_t axis, double x) {
           if (axis != wrong) return x;
           if (std::isnan(*zero)) *zero = x;
           return 2.0 * *zero - x;
         };
       }},
  };
}

std::vector<Break> of_drive_and_machine() {
  const auto friction = [](double share) -> Apply {
    return [share](Broken& b, const Sound&, std::size_t) { b.friction = share; };
  };
  const auto mass = [](double share) -> Apply {
    return [share](Broken& b, const Sound&, std::size_t) { b.mass = share; };
  };
  const auto load = [](double share) -> Apply {
    return [share](Broken& b, const Sound& s, std::size_t) {
      const Sound sound = s;
      b.force = [=](double t, std::size_t axis, double f) {
        return t < sound.when ? f : f - share * sound.limit[axis];
      };
    };
  };
  return {
      {"force with the wrong sign", End::kStops, 0.5 * kMilli, false, Since::kStartEachAxis,
       [](Broken& b, const Sound&, std::size_t wrong) {
         b.force = [=](double, std::size_t axis, double f) { return axis == wrong ? -f : f; };
       }},
      {"power stage off", End::kStops, 5 * kMilli, false, Since::kWhen,
       [](Broken& b, const Sound& s, std::size_t) {
         const double when = s.when;
         b.force = [=](double t, std::size_t, double f) { return t < when ? f : 0.0; };
       }},
      {"force limit 0.9 of the peak", End::kEither, 5 * kMilli, false, Since::kStart, force_limit(0.9)},
      {"force limit 0.5 of the peak", End::kStops, kMilli, false, Since::kStart, force_limit(0.5)},
      {"load of a tenth of the force limit, at once", End::kGoesOn, 500 * kMicro, false, Since::kWhen,
       load(0.1)},
      {"load of half the force limit, at once", End::kStops, 5 * kMilli, false, Since::kWhen, load(0.5)},
      {"ripple of a tenth of the peak force", End::kGoesOn, 500 * kMicro, false, Since::kWhen, ripple},
      {"friction + 50 %", End::kGoesOn, 500 * kMicro, false, Since::kStart, friction(1.5)},
      {"friction − 50 %", End::kGoesOn, 500 * kMicro, false, Since::kStart, friction(0.5)},
      {"mass + 50 %", End::kGoesOn, 500 * kMicro, false, Since::kStart, mass(1.5)},
      {"mass − 50 %", End::kEither, 2 * kMilli, false, Since::kStart, mass(0.5)},
      {"half of the mass on a spring, 40 Hz", End::kEither, 2 * kMilli, false, Since::kStart,
       [](Broken& b, const Sound&, std::size_t) { b.mode = true; }},
      {"command lost", End::kStops, kMilli, true, Since::kWhen,
       [](Broken& b, const Sound& s, std::size_t) { b.command_lost = s.when - 0.5 * s.period; }},
  };
}

}  // namespace

std::vector<Break> all_breaks() {
  std::vector<Break> all{
      {"none", End::kGoesOn, 1e-9, false, Since::kWhen, [](Broken&, const Sound&, std::size_t) {}}};
  for (auto& b : of_the_encoder()) all.push_back(std::move(b));
  for (auto& b : of_drive_and_machine()) all.push_back(std::move(b));
  return all;
}

}  // namespace stribeck::test
