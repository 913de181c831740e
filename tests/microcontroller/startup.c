/*
 * Start of a Cortex-M7 (QEMU's board mps2-an500): vector table, floating-point unit, SysTick as a counter. QEMU runs with
 * -icount shift=0: an instruction takes 1 ns of its clock, and SysTick counts down at 25 MHz, one tick in 40 instructions.
 */
#include <stdint.h>
#include <stdio.h>

extern uint32_t stack_top;
extern void _start(void); /* newlib: clears memory, calls main, ends by semihosting */

const uint32_t instructions_per_tick = 40;

#define REGISTER(address) (*(volatile uint32_t*)(address))

uint32_t ticks(void) { return REGISTER(0xE000E018u); }

static void stopped(void) {
  printf("stopped by a fault of the processor, CFSR %08lx\n", (unsigned long)REGISTER(0xE000ED28u));
  for (;;) {
    /* exit(1) by semihosting */
    register uint32_t r0 __asm__("r0") = 0x20;
    static const uint32_t kReason[2] = {0x20026, 1};
    register const uint32_t* r1 __asm__("r1") = kReason;
    __asm__ volatile("bkpt 0xab" : : "r"(r0), "r"(r1) : "memory");
  }
}

static void reset(void) {
  REGISTER(0xE000ED88u) |= 0xfu << 20; /* CPACR: coprocessors 10 and 11 */
  __asm__ volatile("dsb\n isb");
  REGISTER(0xE000E014u) = 0xffffffu; /* SysTick: reload, value, processor clock without an interrupt */
  REGISTER(0xE000E018u) = 0;
  REGISTER(0xE000E010u) = 5;
  _start();
}

__attribute__((section(".vectors"), used)) static const void* const kVectors[] = {
    &stack_top, reset, stopped, stopped, stopped, stopped, stopped, 0,
    0,          0,     0,       stopped, stopped, 0,       stopped, stopped};
