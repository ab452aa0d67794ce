/* A plugin that writes over the memory which it shares with the loop. */
#pragma once

#include <math.h>
#include <stdio.h>
#include <string.h>

enum wild { WILD_ALL, WILD_INDICES, WILD_FORCES };

/* Over all that is shared, over each word there that is an index, or over each number that is a
 * force of 0.2 to 7.9 N: no other there is, but for 1 and 2. */
static void write_wildly(enum wild what) {
  char line[512];
  FILE* maps = fopen("/proc/self/maps", "r");
  while (maps != NULL && fgets(line, sizeof line, maps) != NULL) {
    unsigned long begin, end;
    if (strstr(line, "forcelayer-plugin") == NULL || sscanf(line, "%lx-%lx", &begin, &end) != 2) {
      continue;
    }
    if (what == WILD_ALL) memset((void*)begin, 0xff, end - begin);
    for (unsigned* word = (unsigned*)begin; what == WILD_INDICES && word < (unsigned*)end; ++word) {
      if (*word > 0 && *word < 8 && word > (unsigned*)begin + 4) *word = 0x7fffffff;
    }
    for (double* n = (double*)begin; what == WILD_FORCES && n < (double*)end; ++n) {
      if (fabs(*n) > 0.2 && fabs(*n) < 7.9 && *n != 1 && *n != 2) *n = 1e6;
    }
  }
  if (maps != NULL) fclose(maps);
}
