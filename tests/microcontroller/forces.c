/*
 * Every law of the C interface in closed loop with a plant made of additions, multiplications and divisions alone, so that two
 * processors with IEEE double precision have to give the same bits. The program prints one line per combination and tenth of the steps:
 *
 *   name, step, checksum of all forces so far
 *
 * sin, cos and tanh of two C libraries differ in the last bit. A combination that calls them prints the mean size of the force
 * with nine digits in place of the checksum. On a microcontroller, where ticks() counts, one more line per combination gives the
 * mean and the largest number of instructions of a step. tests/microcontroller/run compares the host with the Cortex-M7.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <stribeck/stribeck.h>

#ifdef STRIBECK_MICROCONTROLLER
uint32_t ticks(void);                        /* startup.c: counts down, 24 bits */
extern const uint32_t instructions_per_tick; /* startup.c */
#define MEMORY_BYTES (512u * 1024u)
#else
static uint32_t ticks(void) { return 0; }
static const uint32_t instructions_per_tick = 0;
#define MEMORY_BYTES (1024u * 1024u)
#endif

static double memory[MEMORY_BYTES / sizeof(double)] __attribute__((aligned(64)));

static const double kPeriod = 1e-3;
static const double kRadius = 10e-3; /* [m] */
static const double kTurn = 0.95;    /* angular speed on the circle [rad/s] */

struct choice {
  const char* parameter;
  const char* word;
};
struct number {
  const char* parameter;
  double value;
};
struct combination {
  const char* name;
  uint32_t axes;
  int library; /* calls sin, cos or tanh of the C library */
  struct choice choices[8];
  struct number numbers[12];
};

/* Each law, each feed-forward, each observer, each model of friction, one to three axes. */
static const struct combination kCombinations[] = {
    {"pd", 1, 0, {{0}}, {{0}}},
    {"contouring, steady, disturbance observer",
     2,
     0,
     {{"feedforward", "steady"}, {"observer", "disturbance"}},
     {{0}}},
    {"contouring, LuGre, disturbance observer, adaptation",
     2,
     0,
     {{"feedforward", "dynamic"}, {"friction.dynamics", "lugre"}, {"observer", "disturbance"}},
     {{"friction.lugre.sigma0", 3e6}, {"friction.lugre.sigma1", 900.0}, {"adaptation.enabled", 1.0}}},
    {"contouring, GMS, Kalman observer",
     2,
     0,
     {{"feedforward", "dynamic"}, {"friction.dynamics", "gms"}, {"observer", "kalman"}},
     {{"friction.gms.elements.0.stiffness", 2e6},
      {"friction.gms.elements.0.share", 0.4},
      {"friction.gms.elements.1.stiffness", 8e5},
      {"friction.gms.elements.1.share", 0.6},
      {"friction.gms.attraction", 2e3},
      {"friction.gms.damping", 300.0},
      {"disturbance_density", 1e4}}},
    {"contouring, reversal, adaptive friction",
     3,
     0,
     {{"feedforward", "reversal"}, {"observer", "adaptive"}},
     {{"reversal.distance", 60e-6}}},
    {"contouring, steady, periodic term",
     1,
     1,
     {{"feedforward", "steady"}, {"friction.eccentric.0.form", "additive"}},
     {{"friction.eccentric.0.amplitude", 12.0},
      {"friction.eccentric.0.period", 5e-3},
      {"friction.eccentric.0.phase", 0.3}}},
    {"sliding mode, boundary layer",
     2,
     0,
     {{"law", "sliding-mode"}, {"feedforward", "steady"}, {"sliding-mode.switching", "boundary-layer"}},
     {{0}}},
    {"sliding mode, tanh",
     2,
     1,
     {{"law", "sliding-mode"}, {"feedforward", "steady"}, {"sliding-mode.switching", "tanh"}},
     {{0}}},
    {"sliding mode, super-twisting, observed rate",
     1,
     0,
     {{"law", "sliding-mode"},
      {"sliding-mode.switching", "super-twisting"},
      {"observer", "kalman"},
      {"error_rate", "observed"}},
     {{0}}},
    {"predictive",
     2,
     0,
     {{"law", "predictive"}, {"feedforward", "steady"}, {"observer", "disturbance"}},
     {{0}}},
    {"learning",
     1,
     0,
     {{"law", "learning"}, {"feedforward", "steady"}},
     {{"learning.lap", 6.613879270715354}}},
};
enum { kCount = sizeof kCombinations / sizeof kCombinations[0] };

static void fail(const char* name, const char* why) {
  printf("%s: %s\n", name, why);
  exit(1);
}

static stribeck_controller* made(const struct combination* k) {
  const char* law = "contouring";
  stribeck_controller* c;
  for (int i = 0; i < 8 && k->choices[i].parameter; ++i) {
    if (k->choices[i].parameter[0] == 'l') law = k->choices[i].word;
  }
  if (stribeck_controller_size_for(k->axes, law) > sizeof memory)
    fail(k->name, "more memory than this machine has");
  c = stribeck_controller_init(memory, sizeof memory, k->axes);
  if (c == NULL) fail(k->name, "no controller");
  for (uint32_t axis = 0; axis < k->axes; ++axis) {
    static const struct number kAll[] = {{"mass", 800.0},
                                         {"omega", 60.0},
                                         {"force_limit", 2000.0},
                                         {"friction.conventional.alpha0", 60.0},
                                         {"friction.conventional.alpha2", 3e3},
                                         {"friction.conventional.stribeck.alpha1", 40.0},
                                         {"friction.conventional.stribeck.v0", 5e-3},
                                         {"friction.conventional.stribeck.delta", 1.0},
                                         {"encoder_resolution", 1e-8}};
    stribeck_controller_choose(c, axis, "friction.steady", "conventional");
    for (size_t i = 0; i < sizeof kAll / sizeof kAll[0]; ++i) {
      if (stribeck_controller_set(c, axis, kAll[i].parameter, kAll[i].value) != STRIBECK_OK)
        fail(k->name, kAll[i].parameter);
    }
    for (int i = 0; i < 8 && k->choices[i].parameter; ++i) {
      if (stribeck_controller_choose(c, axis, k->choices[i].parameter, k->choices[i].word) != STRIBECK_OK)
        fail(k->name, k->choices[i].parameter);
    }
    for (int i = 0; i < 12 && k->numbers[i].parameter; ++i) {
      if (stribeck_controller_set(c, axis, k->numbers[i].parameter, k->numbers[i].value) != STRIBECK_OK)
        fail(k->name, k->numbers[i].parameter);
    }
  }
  if (stribeck_controller_configure(c, kPeriod) != STRIBECK_OK) fail(k->name, stribeck_controller_problem(c));
  return c;
}

/* A turning vector, by the same recurrence on every machine: no sine of a library. */
struct turning {
  double c, s;
};
static void turn(struct turning* v, const struct turning* by) {
  const double c = v->c * by->c - v->s * by->s;
  const double s = v->s * by->c + v->c * by->s;
  const double correct = 1.5 - 0.5 * (c * c + s * s); /* keeps the length 1 */
  v->c = c * correct;
  v->s = s * correct;
}

static void add(uint64_t* sum, double force) {
  union {
    double d;
    uint64_t u;
  } bits;
  bits.d = force;
  for (int i = 0; i < 8; ++i) {
    *sum = (*sum ^ ((bits.u >> (8 * i)) & 0xffu)) * 1099511628211ull; /* FNV-1a */
  }
}

static void run(const struct combination* k, uint32_t steps) {
  stribeck_controller* c = made(k);
  double x[3] = {0, 0, 0}, v[3] = {0, 0, 0}, force[3] = {0, 0, 0};
  stribeck_axis_input in[3] = {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}};
  struct turning angle = {1.0, 0.0}, by;
  uint64_t sum = 14695981039346656037ull;
  double sizes = 0.0;
  uint64_t all_ticks = 0;
  uint32_t most_ticks = 0, noise = 12345u;
  const double h = kTurn * kPeriod;
  by.s = h - h * h * h / 6.0;
  by.c = 1.0 - h * h / 2.0 + h * h * h * h / 24.0;
  for (uint32_t n = 0; n < steps; ++n) {
    const double t = n * kPeriod;
    const double ramp = t < 1.0 ? t * t * (3.0 - 2.0 * t) : 1.0;
    const double sines[3] = {angle.s, 1.0 - angle.c, 0.5 * angle.s};
    const double cosines[3] = {angle.c, angle.s, 0.5 * angle.c};
    const double minus_sines[3] = {-angle.s, angle.c, -0.5 * angle.s};
    for (uint32_t i = 0; i < k->axes; ++i) {
      in[i].position = kRadius * ramp * sines[i];
      in[i].velocity = kRadius * kTurn * ramp * cosines[i];
      in[i].acceleration = kRadius * kTurn * kTurn * ramp * minus_sines[i];
      noise = noise * 1664525u + 1013904223u;
      /* Encoder of 10 nm with a little noise. */
      in[i].measured = 1e-8 * (double)(int64_t)(x[i] * 1e8 + (double)(noise >> 16) / 65536.0);
    }
    stribeck_controller_set_phase(c, t);
    {
      const uint32_t before = ticks();
      const stribeck_result r = stribeck_controller_step(c, in, force);
      const uint32_t took = (before - ticks()) & 0xffffffu;
      if (r != STRIBECK_OK) fail(k->name, stribeck_describe(r));
      all_ticks += took;
      if (took > most_ticks) most_ticks = took;
    }
    for (uint32_t i = 0; i < k->axes; ++i) {
      add(&sum, force[i]);
      sizes += force[i] < 0.0 ? -force[i] : force[i];
      for (int s = 0; s < 4; ++s) { /* friction that is not the model's */
        const double w = v[i] / 2e-4;
        const double size = w < 0 ? -w : w;
        const double friction = 95.0 * w / (1.0 + size) + 2.5e3 * v[i];
        v[i] += kPeriod / 4.0 * (force[i] - friction) / 830.0;
        x[i] += kPeriod / 4.0 * v[i];
      }
    }
    turn(&angle, &by);
    if ((n + 1) % (steps / 10) != 0) continue;
    if (k->library)
      printf("%s, %lu, %.9g N\n", k->name, (unsigned long)(n + 1), sizes / (n + 1) / k->axes);
    else
      printf("%s, %lu, %08lx%08lx\n", k->name, (unsigned long)(n + 1), (unsigned long)(sum >> 32),
             (unsigned long)(sum & 0xffffffffu));
  }
  if (instructions_per_tick != 0)
    printf("| %s | %lu | %lu | %lu |\n", k->name, (unsigned long)k->axes,
           (unsigned long)(all_ticks * instructions_per_tick / steps),
           (unsigned long)(most_ticks * instructions_per_tick));
}

int main(int argc, char** argv) {
  const uint32_t steps = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 10000u;
  for (int i = 0; i < kCount; ++i) run(&kCombinations[i], steps < 10 ? 10 : steps);
  return 0;
}
