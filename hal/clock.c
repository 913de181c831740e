/*
 * A clock that runs faster, for programs that sleep to absolute times of CLOCK_MONOTONIC: LinuxCNC headless, ten times as fast.
 *
 *   LD_PRELOAD=stribeck_clock.so STRIBECK_SPEED=10 halrun -f x.hal
 *
 * Inside a HAL thread nothing changes: functions are given the nominal period. For tests only; a machine has no use for it.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <time.h>

static int (*real_gettime)(clockid_t, struct timespec*);
static int (*real_nanosleep)(clockid_t, int, const struct timespec*, struct timespec*);
static struct timespec begin;
static double speed;

static void start(void) {
  if (speed > 0.0) return;
  real_gettime = (int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime");
  real_nanosleep =
      (int (*)(clockid_t, int, const struct timespec*, struct timespec*))dlsym(RTLD_NEXT, "clock_nanosleep");
  real_gettime(CLOCK_MONOTONIC, &begin);
  const char* text = getenv("STRIBECK_SPEED");
  const double wanted = text != NULL ? atof(text) : 1.0;
  speed = wanted > 0.0 && wanted <= 1000.0 ? wanted : 1.0;
}

/* begin + (t − begin)·factor */
static struct timespec scaled(const struct timespec* t, double factor) {
  const double s =
      factor * ((double)(t->tv_sec - begin.tv_sec) + 1e-9 * (double)(t->tv_nsec - begin.tv_nsec));
  struct timespec r = begin;
  const long whole = (long)s;
  long rest = r.tv_nsec + (long)((s - (double)whole) * 1e9);
  r.tv_sec += whole;
  while (rest >= 1000000000L) {
    rest -= 1000000000L;
    ++r.tv_sec;
  }
  while (rest < 0) {
    rest += 1000000000L;
    --r.tv_sec;
  }
  r.tv_nsec = rest;
  return r;
}

int clock_gettime(clockid_t clock, struct timespec* t) {
  start();
  const int r = real_gettime(clock, t);
  if (r == 0 && clock == CLOCK_MONOTONIC) *t = scaled(t, speed);
  return r;
}

int clock_nanosleep(clockid_t clock, int flags, const struct timespec* until, struct timespec* left) {
  start();
  if (clock != CLOCK_MONOTONIC || (flags & TIMER_ABSTIME) == 0)
    return real_nanosleep(clock, flags, until, left);
  const struct timespec t = scaled(until, 1.0 / speed);
  return real_nanosleep(clock, flags, &t, left);
}
