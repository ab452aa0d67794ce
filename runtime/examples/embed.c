/* The same in C: example_embed_c SCENE.vox PART.pshell [OTHER.pshell]
 * With a third file, the part is swapped for it on another thread while the loop runs. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "forcelayer/forcelayer.h"

static const double kStart[7] = {0.1, 0.1, 0.06, 1, 0, 0, 0};

/* The reading that your SDK's callback makes: here a hand that comes down 30 mm. */
static forcelayer_reading reading_at(double time_s) {
  forcelayer_reading reading;
  memset(&reading, 0, sizeof reading);
  reading.device_from_handle[2] = -0.03 * fmin(1, time_s / 0.5);
  reading.device_from_handle[3] = 1;
  reading.fresh = reading.present = reading.calibrated = 1;
  return reading;
}

struct swap {
  forcelayer_runtime* runtime;
  const char *scene, *part;
  int failed;
};

static void* swap_part(void* argument) {
  struct swap* swap = argument;
  char error[256] = "";
  swap->failed =
      forcelayer_swap(swap->runtime, swap->scene, swap->part, kStart, NULL, 5, error, sizeof error);
  if (swap->failed) fprintf(stderr, "example_embed_c: %s\n", error);
  return NULL;
}

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    fprintf(stderr, "usage: example_embed_c SCENE.vox PART.pshell [OTHER.pshell]\n");
    return 2;
  }
  forcelayer_options options;
  forcelayer_default_options(&options);
  memcpy(options.world_from_device, kStart, sizeof kStart);
  options.stale_s = 0.1; /* a shared machine without real-time priority */
  char error[256];
  forcelayer_runtime* runtime = forcelayer_open(argv[1], argv[2], &options, error, sizeof error);
  if (runtime == NULL) {
    fprintf(stderr, "example_embed_c: %s\n", error);
    return 1;
  }
  for (uint32_t n = 0; forcelayer_warning(runtime, n) != NULL; ++n) {
    fprintf(stderr, "example_embed_c: warning: %s\n", forcelayer_warning(runtime, n));
  }
  double tested_m, swept_m;
  forcelayer_guarantee(runtime, &tested_m, &swept_m);
  forcelayer_reading reading = reading_at(0);
  if (forcelayer_start(runtime, kStart, NULL, &reading, error, sizeof error) != 0) {
    fprintf(stderr, "example_embed_c: %s\n", error);
    return 1;
  }

  struct swap swap = {runtime, argv[1], argc == 4 ? argv[3] : NULL, 0};
  pthread_t thread;
  double largest_n = 0;
  int guaranteed_frames = 0;
  struct timespec tick;
  clock_gettime(CLOCK_MONOTONIC, &tick);
  for (int frame = 0; frame < 1500; ++frame) {
    tick.tv_nsec += 1000000;
    if (tick.tv_nsec >= 1000000000) {
      tick.tv_nsec -= 1000000000;
      ++tick.tv_sec;
    }
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &tick, NULL);
    if (frame == 800 && swap.part != NULL) pthread_create(&thread, NULL, swap_part, &swap);
    reading = reading_at(frame / 1000.0);
    forcelayer_result result;
    forcelayer_step(runtime, &reading, &result);
    forcelayer_state state;
    forcelayer_last_state(runtime, &state, sizeof state);
    if (state.guaranteed_m > 0) ++guaranteed_frames;
    const double force_n =
        sqrt(result.force_n[0] * result.force_n[0] + result.force_n[1] * result.force_n[1] +
             result.force_n[2] * result.force_n[2]);
    if (frame < 800) largest_n = fmax(largest_n, force_n);
    if (frame == 799) printf("at 0.8 s: output %u, peak force %.2f N\n", result.output, largest_n);
    if (frame == 1499) {
      printf("at the end: output %u, part at z = %.3f m, last trip %s\n", result.output,
             result.world_from_part[2], forcelayer_last_trip(runtime));
      printf("the surfaces were at least %.2f mm apart in %d frames of %d\n", 1000 * tested_m,
             guaranteed_frames, frame + 1);
    }
  }
  if (swap.part != NULL) pthread_join(thread, NULL);
  forcelayer_close(runtime);
  return swap.failed;
}
