/* Controllers that break, one for each value of BREAK: 1 reads where nothing is, 2 refuses its setup, 3 was compiled for another version. */
#include <stdlib.h>
#include <stribeck/board.h>

uint32_t stribeck_board_abi(void) { return STRIBECK_BOARD_ABI + (BREAK == 3); }
void* stribeck_board_create(const stribeck_board_setup* setup) {
  return BREAK == 2 || setup == NULL ? NULL : malloc(1);
}
void stribeck_board_step(void* c, double time, const stribeck_board_input* in, double* force) {
  volatile double* nowhere = NULL;
  (void)c;
  (void)in;
  force[0] = force[1] = time > 0.5 ? *nowhere : 0.0;
}
void stribeck_board_destroy(void* c) { free(c); }
