/* A virtual drive of the installed package: pushed for 0.1 s, it moves. */
#include <stdio.h>
#include <stribeck/plant.h>

int main(void) {
  stribeck_plant* drive = 0;
  if (stribeck_plant_create(&drive) != STRIBECK_OK) return 1;
  stribeck_plant_set(drive, "mass", 800.0);
  stribeck_plant_choose(drive, "friction.steady", "conventional");
  stribeck_plant_set(drive, "friction.conventional.alpha0", 10.0);
  stribeck_plant_choose(drive, "friction.dynamics", "lugre");
  stribeck_plant_set(drive, "friction.lugre.sigma0", 1e7);
  stribeck_plant_set(drive, "friction.lugre.sigma1", 1e4);
  stribeck_plant_choose(drive, "drive", "current");
  stribeck_plant_set(drive, "current.gain", 100.0);
  stribeck_plant_set(drive, "converter.bits", 16.0);
  stribeck_plant_set(drive, "converter.range", 10.0);
  stribeck_plant_set(drive, "encoder.resolution", 1e-7);
  if (stribeck_plant_configure(drive, 1e-3, 0.5) != STRIBECK_OK) {
    puts(stribeck_plant_problem(drive));
    return 2;
  }
  stribeck_plant_start(drive, 0.0, 1, 4);
  for (int i = 0; i < 100; ++i) stribeck_plant_step(drive, 1.0, 0.0);
  const int moved = stribeck_plant_get(drive, STRIBECK_PLANT_POSITION) > 1e-6;
  stribeck_plant_destroy(drive);
  return moved ? 0 : 3;
}
