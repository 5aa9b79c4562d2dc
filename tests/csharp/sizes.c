// Prints the size of each struct of lobe_c.h, for callers in other languages.
#include <lobe_c.h>
#include <stdio.h>

#define PRINT(type) printf(#type " %zu\n", sizeof(type))

int main(void) {
  PRINT(lobe_options);
  PRINT(lobe_state);
  PRINT(lobe_tool);
  PRINT(lobe_haptic_device);
  PRINT(lobe_surface);
  return 0;
}
