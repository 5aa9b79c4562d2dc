/* In place of the C library's: METIS divides graphs by them. */
#pragma once
#include <stdlib.h>
#undef RAND_MAX
#define RAND_MAX 2147483647
#define rand lobe_glibc_rand
#define srand lobe_glibc_srand
int lobe_glibc_rand(void);
void lobe_glibc_srand(unsigned seed);
