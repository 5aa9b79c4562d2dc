/* The numbers of rand() of glibc: x[i] = x[i - 3] + x[i - 31], half of it, started by a linear congruence. */
#include "glibc_rand.h"

#include <stdint.h>

enum { order = 31, lag = 28, unused = 310 };
static uint32_t x[order];
static int at;

int lobe_glibc_rand(void) {
  x[at] += x[(at + lag) % order];
  const uint32_t value = x[at] >> 1;
  at = (at + 1) % order;
  return (int)value;
}

void lobe_glibc_srand(unsigned seed) {
  int64_t word = seed == 0 ? 1 : (int32_t)seed;
  for (int i = 0; i < order; ++i) {
    x[i] = (uint32_t)word;
    word = 16807 * word % 2147483647;
    if (word < 0) word += 2147483647;
  }
  at = 3; /* x[31] to x[33] are x[0] to x[2] */
  for (int i = 0; i < unused; ++i) lobe_glibc_rand();
}
