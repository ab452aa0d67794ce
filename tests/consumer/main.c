/* The same from C: opens both files and steps the part where the hand is. */
#include <forcelayer/forcelayer.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char** argv) {
  forcelayer_options options;
  char error[256] = "";
  if (argc != 3) return 2;
  forcelayer_default_options(&options);
  options.without_guarantee = 1;
  forcelayer_runtime* runtime = forcelayer_open(argv[1], argv[2], &options, error, sizeof error);
  if (runtime == NULL) {
    fprintf(stderr, "consumer_c: %s\n", error);
    return 1;
  }
  forcelayer_reading reading;
  memset(&reading, 0, sizeof reading);
  reading.device_from_handle[3] = 1;
  reading.fresh = reading.present = reading.calibrated = 1;
  forcelayer_result result;
  const int failed = forcelayer_start(runtime, NULL, NULL, &reading, error, sizeof error) ||
                     forcelayer_step(runtime, &reading, &result);
  if (failed) fprintf(stderr, "consumer_c: %s\n", error);
  forcelayer_close(runtime);
  return failed;
}
