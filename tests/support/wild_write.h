/* A plugin that writes over the memory which it shares with the loop. */
#pragma once

#include <stdio.h>
#include <string.h>

/* Over all that is shared, or over each word there that is an index. */
static void write_wildly(int indices) {
  char line[512];
  FILE* maps = fopen("/proc/self/maps", "r");
  while (maps != NULL && fgets(line, sizeof line, maps) != NULL) {
    unsigned long begin, end;
    if (strstr(line, "forcelayer-plugin") == NULL || sscanf(line, "%lx-%lx", &begin, &end) != 2) {
      continue;
    }
    if (!indices) memset((void*)begin, 0xff, end - begin);
    for (unsigned* word = (unsigned*)begin; indices && word < (unsigned*)end; ++word) {
      if (*word > 0 && *word < 8 && word > (unsigned*)begin + 4) *word = 0x7fffffff;
    }
  }
  if (maps != NULL) fclose(maps);
}
